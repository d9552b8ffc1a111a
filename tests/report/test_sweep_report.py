"""How a sweep is shown: plot, page, picture and table, all from the one record."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from rendergraph.cli.console import write_table
from rendergraph.document.messages import RenderGraphError
from rendergraph.report.sweep import set_line
from rendergraph.report.sweep_files import write_sweep
from rendergraph.report.sweep_page import sweep_page
from rendergraph.report.sweep_plot import scale, staircase, sweep_plot
from rendergraph.report.sweep_shape import SweepRecord
from rendergraph.report.sweep_table import sparkline, sweep_tables
from tests.report.made_up_sweep import made_up_sweep


def test_the_made_up_record_has_the_records_shape() -> None:
    SweepRecord.model_validate(made_up_sweep())


# ---- the plot


def test_a_narrow_range_is_linear_and_ticks_are_round() -> None:
    found = scale([1.0, 2.0, 5.0], 0.0, 100.0)
    assert not found.logarithmic
    assert [name for _, name in found.ticks] == ["1", "2", "3", "4", "5"]
    # 8 % of the range of 4 on either side: 0.68 to 5.32.
    assert found.at(3.0) == pytest.approx(50.0)
    assert found.at(-9.0) == 0.0
    assert found.at(99.0) == 100.0


def test_a_wide_range_is_logarithmic() -> None:
    found = scale([0.1, 10.0], 100.0, 0.0)
    assert found.logarithmic
    assert found.at(1.0) == pytest.approx(50.0, abs=0.01)
    assert [name for _, name in found.ticks] == ["0.1", "0.2", "0.5", "1", "2", "5", "10"]


@pytest.mark.parametrize("values", [[], [0.0], [0.0, 0.0], [3.0], [1e-9, 1.0]])
def test_any_values_have_a_scale(values: list[float]) -> None:
    found = scale(values, 0.0, 100.0)
    assert found.low < found.high
    assert all(0.0 <= found.at(value) <= 100.0 for value in values)


def test_the_front_is_a_staircase() -> None:
    # y grows downwards, so the second point (lower error) lies at a larger y; the third is behind.
    assert staircase([(10, 5), (20, 9), (30, 7)]) == ((10, 5), (20, 5), (20, 9))
    assert staircase([]) == ()


def test_bubbles_lie_where_time_and_error_are_and_grow_with_bytes() -> None:
    plot = sweep_plot(made_up_sweep())
    assert plot is not None
    by_index = {bubble.index: bubble for bubble in plot.bubbles}
    assert set(by_index) == {-1, 0, 1, 2, 3}, "the refused one has no place; the document's own has"
    assert by_index[0].x < by_index[1].x < by_index[-1].x < by_index[3].x < by_index[2].x
    assert by_index[3].y < by_index[0].y < by_index[1].y < by_index[2].y, "more error is higher up"
    assert by_index[0].radius < by_index[1].radius == by_index[2].radius
    assert by_index[1].left < by_index[1].x < by_index[1].right
    assert plot.bubbles[-1].recommended, "on top of all"
    assert len(plot.steps) == 5


# ---- the page


def test_the_page_asks_for_no_other_and_escapes_what_it_is_given() -> None:
    page = sweep_page(made_up_sweep())
    assert "default-src 'none'" in page
    assert not re.search(r'(?:src|href)\s*=\s*["\']', page)
    assert "<b>& more" not in page
    assert "Occlusion &lt;b&gt;&amp; more" in page
    assert "RG205 &lt;no&gt;" in page
    assert page.count('tabindex="0"') == 5
    assert "--set passes.occlude.set.samples=16" in page
    assert "prefers-color-scheme" in page or "color-scheme: light dark" in page


def test_a_page_without_any_error_says_so() -> None:
    record = made_up_sweep()
    for entry in (*record["points"], record["control"]):
        entry["error"] = None
    record["axes"][0]["errors"] = [None, None, None]
    record["recommended"] = None
    assert "No setting has both a time and an error." in sweep_page(record)
    assert sweep_plot(record) is None


# ---- the picture


def test_the_picture_shows_every_colour_of_the_plot(tmp_path: Path) -> None:
    files = write_sweep(tmp_path, made_up_sweep(), html=True, png=True)
    assert [file.name for file in files] == ["sweep.json", "sweep.html", "sweep.png"]
    pixels = np.asarray(Image.open(files[2]).convert("RGB")).reshape(-1, 3).astype(int)
    assert len(pixels) == 1440 * 690
    for colour in ((255, 255, 255), (75, 134, 221), (176, 186, 200), (163, 58, 18)):
        assert (np.abs(pixels - colour).max(axis=1) <= 2).sum() > 30, colour


def test_nothing_to_draw_is_an_error(tmp_path: Path) -> None:
    record = made_up_sweep()
    for entry in (*record["points"], record["control"]):
        entry["error"] = None
    with pytest.raises(RenderGraphError) as refused:
        write_sweep(tmp_path, record, png=True)
    assert refused.value.diagnostics[0].code == "RG764"
    assert not (tmp_path / "sweep.png").exists()


# ---- the table


def test_sparklines() -> None:
    assert sparkline([0.0, 0.5, 1.0], plain=False) == "▁▅█"
    assert sparkline([0.0, 0.5, 1.0], plain=True) == "_+@"
    assert sparkline([1.0, None, "inf"], plain=False) == "█?█"
    assert sparkline([0.0, 0.0], plain=False) == "▁▁"
    assert sparkline([], plain=False) == ""


def test_no_colour_is_ascii(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    write_table(*sweep_tables(made_up_sweep()))
    assert "█" in capsys.readouterr().out
    monkeypatch.setenv("NO_COLOR", "1")
    write_table(*sweep_tables(made_up_sweep()))
    assert capsys.readouterr().out.isascii()


def test_the_table_runs_from_worst_to_best(capsys: pytest.CaptureFixture[str]) -> None:
    write_table(*sweep_tables(made_up_sweep()))
    out = capsys.readouterr().out
    lines = [line for line in out.splitlines() if "MiB" in line or "0 B" in line]
    errors = [re.search(r"(?:B\s+)(0\.\d+)", line) for line in lines[:4]]
    assert [match[1] for match in errors if match] == ["0.5", "0.4", "0.2", "0.1"]
    assert "--set passes.occlude.set.samples=16 --set passes.occlude.set.radius=1" in out


def test_lines_to_paste_are_quoted() -> None:
    assert set_line(["resources.shadow.fixed=[512, 512]", "a.b=1"]) == (
        "--set 'resources.shadow.fixed=[512, 512]' --set a.b=1"
    )
