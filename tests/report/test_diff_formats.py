"""The formats say what the comparison says: JSON that parses, Markdown rows that hold, annotations under the cap."""

import json
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from rendergraph.document.messages import RenderGraphError
from rendergraph.report.diff import Comparison, diff_records
from rendergraph.report.diff_github import CAP, append_summary, diff_annotations
from rendergraph.report.diff_markdown import diff_markdown
from rendergraph.report.diff_record import diff_record
from rendergraph.report.diff_tables import diff_tables
from tests.report.diff_records import samples, timing, write


@pytest.fixture
def slower(tmp_path: Path) -> Comparison:
    """Two passes, one of them slower and drawing more, one with too few samples."""
    before = timing({"light": samples(2.0), "sky": samples(1.0, 3)})
    after = timing({"light": samples(3.0), "sky": samples(1.0, 3)}, frame=samples(4.0))
    after["passes"][0]["counters"]["draws"] = 5
    return diff_records(write(tmp_path / "a.json", before), write(tmp_path / "b|<b>.json", after))


def test_json(slower: Comparison) -> None:
    made = diff_record(slower, "all")
    assert json.loads(json.dumps(made, allow_nan=False)) == made
    assert made["schema"] == "rendergraph.diff/1"
    assert [t["name"] for t in made["times"] if t["verdict"] == "slower"] == ["light", None]
    assert len(made["regressions"]) == 3
    assert len(diff_record(slower, "exact")["regressions"]) == 1
    assert [w["code"] for w in made["warnings"]] == ["RG738"]
    sky = next(t for t in made["times"] if t["name"] == "sky")
    assert (sky["verdict"], sky["low"], sky["p"]) == ("inconclusive", None, None)


def test_tables_name_what_is_slower_first(slower: Comparison) -> None:
    console = Console(file=StringIO(), width=200)
    for table in diff_tables(slower, "all"):
        console.print(table)
    text = console.file.getvalue()  # type: ignore[attr-defined]
    assert text.index("light") < text.index("whole frame") < text.index("sky  ")
    assert "3 regressions" in text


def test_markdown_rows_keep_their_columns(slower: Comparison) -> None:
    lines = diff_markdown(slower, "all").splitlines()
    for head in (i for i, line in enumerate(lines) if line.startswith("|--")):
        columns = lines[head].count("|")
        rows = [line for line in lines[head - 1 :] if line.startswith("|")]
        assert all(row.replace("\\|", "").count("|") in (columns, 9) for row in rows)
    assert "<b>" not in lines[2]


def test_annotations_are_escaped_and_levelled(slower: Comparison) -> None:
    lines = diff_annotations(slower, "exact").splitlines()
    assert [line for line in lines if line.startswith("::error")] == [lines[0]]
    assert "draws" in lines[0]
    assert sum(line.startswith("::warning") for line in lines) == 3  # two slower ones not gated, too few samples
    assert all(line.startswith(("::error title=", "::warning title=", "::notice title=")) for line in lines)
    assert "%25" in "".join(lines)
    assert "% " not in "".join(lines).replace("%25", "").replace("%3A", "")


def test_annotations_stay_under_the_cap(tmp_path: Path) -> None:
    names = [f"pass_{i}" for i in range(40)]
    before = timing({name: samples(1.0, seed=1) for name in names})
    after = timing({name: samples(2.0, seed=2) for name in names})
    found = diff_records(write(tmp_path / "a.json", before), write(tmp_path / "b.json", after))
    lines = diff_annotations(found, "all").splitlines()
    assert sum(line.startswith("::error") for line in lines) == CAP
    assert "31 more" in lines[CAP - 1]


def test_the_job_summary_is_appended_where_github_wants_it(
    slower: Comparison, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "summary.md"
    path.write_text("before\n")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(path))
    append_summary(slower, "all")
    assert path.read_text().startswith("before\n### ")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(tmp_path))
    with pytest.raises(RenderGraphError) as caught:
        append_summary(slower, "all")
    assert [d.code for d in caught.value.diagnostics] == ["RG560"]
    monkeypatch.delenv("GITHUB_STEP_SUMMARY")
    append_summary(slower, "all")
