"""`rg render --reference`: what is judged, written and shown, and when it fails."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from rendergraph.document.load import load_document
from rendergraph.report.accuracy_shape import AccuracyRecord
from tests.cli.conftest import Rg

SIZE = ("--size", "64x36", "--samples", "1")


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RENDERGRAPH_CACHE", str(tmp_path / "cache"))


def graph(folder: Path, **changes: object) -> str:
    """The shipped graph ``tonemap`` with another budget, and its shader beside it."""
    shipped = load_document("tonemap").path
    data = yaml.safe_load(shipped.read_text())
    (folder / "shaders").mkdir(exist_ok=True)
    for shader in (shipped.parent / "shaders").glob("colour_chart.frag"):
        (folder / "shaders" / shader.name).write_bytes(shader.read_bytes())
    path = folder / "graph.yaml"
    path.write_text(yaml.safe_dump(data | changes, sort_keys=False))
    return str(path)


@pytest.mark.gpu
def test_a_sound_graph_is_judged_and_recorded(rg: Rg, tmp_path: Path) -> None:
    outcome = rg("render", "tonemap", *SIZE, "--reference", "--html", "-o", str(tmp_path / "one"))
    assert outcome.code == 0, outcome.err
    assert "Accuracy" in outcome.out
    text = (tmp_path / "one" / "accuracy.json").read_text()
    AccuracyRecord.model_validate_json(text)
    record = json.loads(text)
    passes = {entry["name"]: entry for entry in record["passes"]}
    assert set(passes) == set(load_document("tonemap").model.passes)
    assert passes["through_agx"]["measures"][0]["verdict"] == "within"
    assert not passes["through_agx"]["cached"]
    assert record["verdicts"]["above"] == 0
    assert 'id="accuracy-through_agx"' in (tmp_path / "one" / "report.html").read_text()

    again = rg("render", "tonemap", *SIZE, "--reference", "--format", "json", "-o", str(tmp_path / "two"))
    assert again.code == 0, again.err
    assert all(entry["cached"] for entry in json.loads(again.out)["accuracy"]["passes"] if entry["measures"])
    compared = rg("diff", str(tmp_path / "one"), str(tmp_path / "two"), "--gate", "exact")
    assert compared.code == 0, compared.out


@pytest.mark.gpu
def test_only_the_passes_named_are_judged(rg: Rg, tmp_path: Path) -> None:
    out = ("-o", str(tmp_path / "out"))
    outcome = rg("render", "tonemap", *SIZE, "--reference-pass", "through_aces", "--format", "json", *out)
    assert outcome.code == 0, outcome.err
    assert [entry["name"] for entry in json.loads(outcome.out)["accuracy"]["passes"]] == ["through_aces"]


def test_an_unknown_pass_is_refused_before_rendering(rg: Rg, tmp_path: Path) -> None:
    outcome = rg("render", "tonemap", "--reference-pass", "through_acse", "-o", str(tmp_path / "out"))
    assert outcome.code == 2
    assert "RG746" in outcome.err
    assert not (tmp_path / "out").exists()


@pytest.mark.gpu
@pytest.mark.parametrize(("limit", "code"), [(1e-7, 1), (0.5, 0)])
def test_a_budget_of_error_fails_the_run(rg: Rg, tmp_path: Path, limit: float, code: int) -> None:
    path = graph(tmp_path, budget={"error": {"through_agx": limit}})
    options = (path, *SIZE, "--reference-pass", "through_agx", "-o", str(tmp_path / "out"))
    outcome = rg("render", *options)
    assert outcome.code == code, outcome.err
    assert ("RG710" in outcome.err) == bool(code)
    assert "RG709" not in outcome.err
    unchecked = rg("render", path, *SIZE, "-o", str(tmp_path / "out"))
    assert unchecked.code == 0
    assert "RG709" in unchecked.err


@pytest.mark.gpu
def test_without_the_option_nothing_is_judged(rg: Rg, tmp_path: Path) -> None:
    outcome = rg("render", "tonemap", *SIZE, "-o", str(tmp_path / "out"))
    assert outcome.code == 0
    assert not (tmp_path / "out" / "accuracy.json").exists()
    assert "Accuracy" not in outcome.out


@pytest.mark.gpu
def test_without_a_place_for_the_cache_it_says_so(rg: Rg, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.delenv("RENDERGRAPH_CACHE")
    monkeypatch.setitem(sys.modules, "platformdirs", None)
    options = (*SIZE, "--reference-pass", "through_aces", "-o", str(tmp_path / "out"))
    outcome = rg("render", "tonemap", *options)
    assert outcome.code == 0
    assert "RG745" in outcome.err
