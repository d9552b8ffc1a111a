"""Whole runs on the device: a sound node passes its reference, and each mistake put into its shader is caught."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml

from rendergraph.device.context import Device
from rendergraph.document.load import Document, load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.truth.accuracy import PassAccuracy, judge_graph
from rendergraph.measure.truth.cache import TruthCache
from rendergraph.measure.truth.judgement import Judgement
from rendergraph.plan.plan import PlanOptions
from rendergraph.report.accuracy_findings import accuracy_findings
from rendergraph.run.plan_document import plan_document
from tests.measure.truth.slope_node import (
    DAPPLE,
    DAPPLE_REFERENCE,
    DAPPLE_SHADER,
    HEIGHT_SHADER,
    MISTAKES,
    SLOPE,
    SLOPE_REFERENCE,
    SLOPE_SHADER,
)

pytestmark = pytest.mark.gpu


def document(folder: Path, settings: Mapping[str, Any], **extra: Any) -> Document:
    (folder / "height.frag").write_text(HEIGHT_SHADER)
    graph = {
        "rendergraph": 1,
        "frame": {"size": [32, 24]},
        "resources": {"height": {"format": "rgba32f"}},
        "passes": {
            "hills": {"node": "fullscreen", "write": {"color": "height"}, "set": {"shader": "height.frag"}},
            "slope": {
                "node": "slope",
                "read": {"height": "height"},
                "write": {"normal": "normal"},
                "set": dict(settings),
            },
        },
        "outputs": {"normal": {"file": "normal.npy"}},
        **extra,
    }
    (folder / "graph.yaml").write_text(yaml.safe_dump(graph, sort_keys=False))
    return load_document(folder / "graph.yaml")


def judge(
    loaded: Document, device: Device, passes: tuple[str, ...] = (), cache: TruthCache | None = None
) -> dict[str, PassAccuracy]:
    planned = plan_document(loaded, PlanOptions())
    return {entry.name: entry for entry in judge_graph(loaded, planned, device, passes, cache=cache)}


def slope(install: Any, mistake: str | None = None) -> None:
    shader = SLOPE_SHADER
    if mistake is not None:
        assert MISTAKES[mistake][0] in shader
        shader = shader.replace(*MISTAKES[mistake])
    install("slope", {"__init__.py": SLOPE, "reference.py": SLOPE_REFERENCE, "slope.frag": shader})


def test_a_sound_node_is_within_its_tolerance(install: Any, device: Device, tmp_path: Path) -> None:
    slope(install)
    loaded = document(tmp_path, {})
    entry = judge(loaded, device, ("slope",))["slope"]
    (judged,) = entry.judgements
    assert (judged.verdict, entry.broken, entry.reason) == ("within", (), "")
    assert judged.value is not None
    assert 0.0 <= judged.value < 0.01
    assert judged.unit == "degrees"
    assert accuracy_findings(loaded, [entry]) == []


@pytest.mark.parametrize("mistake", MISTAKES)
def test_each_mistake_is_caught(install: Any, device: Device, tmp_path: Path, mistake: str) -> None:
    slope(install, mistake)
    loaded = document(tmp_path, {})
    entry = judge(loaded, device, ("slope",))["slope"]
    found = accuracy_findings(loaded, [entry])
    codes = {finding.code for finding in found}
    if mistake == "no_normalise":  # the direction is right: only the invariant can tell
        assert codes == {"RG747"}
    else:
        (judged,) = entry.judgements
        assert judged.verdict == "above"
        assert judged.worst_texel is not None
        assert judged.worst_texel.error == judged.value > 0.3
        assert set(judged.worst_texel.inputs) == {"height"}
        assert "RG742" in codes


def test_the_help_names_the_knob_that_raises_accuracy(install: Any, device: Device, tmp_path: Path) -> None:
    slope(install)
    loaded = document(tmp_path, {"detail": "coarse"})
    (finding,) = accuracy_findings(loaded, list(judge(loaded, device, ("slope",)).values()))
    assert finding.code == "RG742"
    assert "passes.slope.set.detail" in finding.help
    assert finding.position is not None
    assert finding.position.file.endswith("graph.yaml")


def test_pictures_are_shown_and_then_dropped(install: Any, device: Device, tmp_path: Path) -> None:
    slope(install)
    loaded = document(tmp_path, {})
    seen: list[Judgement] = []
    (entry,) = judge_graph(loaded, plan_document(loaded, PlanOptions()), device, ("slope",), show=seen.append)
    assert [found.pictures is not None for found in seen] == [True]
    assert [found.pictures for found in entry.judgements] == [None]
    assert entry.judgements == tuple(seen)  # else the same


def test_a_pass_without_a_reference_says_so(install: Any, device: Device, tmp_path: Path) -> None:
    slope(install)
    loaded = document(tmp_path, {}, resources={"height": {"format": "rgba32f"}, "spare": {"format": "rgba32f"}})
    entry = judge(loaded, device)["hills"]
    assert entry.judgements == ()
    assert entry.reason


def test_an_unknown_pass_is_refused(install: Any, device: Device, tmp_path: Path) -> None:
    slope(install)
    with pytest.raises(RenderGraphError) as refused:
        judge(document(tmp_path, {}), device, ("slpe",))
    assert [d.code for d in refused.value.diagnostics] == ["RG746"]


def test_truths_are_kept_between_runs_and_forgotten_with_their_source(
    install: Any, device: Device, tmp_path: Path
) -> None:
    slope(install)
    cached = []
    for strength, reference in ((4.0, ""), (4.0, ""), (3.0, ""), (4.0, "\n# another source")):
        install("slope", {"reference.py": SLOPE_REFERENCE + reference})
        cache = TruthCache(tmp_path / "cache")
        entry = judge(document(tmp_path, {"strength": strength}), device, ("slope",), cache)["slope"]
        cached.append(entry.judgements[0].cached)
        assert entry.judgements[0].verdict == "within"
    assert cached == [False, True, False, False]


@pytest.mark.parametrize(("bias", "verdict"), [(0.0, "within"), (0.4, "above")])
def test_a_random_node_is_judged_by_its_mean_over_frames(
    install: Any, device: Device, tmp_path: Path, bias: float, verdict: str
) -> None:
    install("dapple", {"__init__.py": DAPPLE, "reference.py": DAPPLE_REFERENCE, "dapple.frag": DAPPLE_SHADER})
    graph = {
        "rendergraph": 1,
        "frame": {"size": [32, 24], "count": 2},
        "resources": {"light": {"format": "r32f"}},
        "passes": {"dapple": {"node": "dapple", "write": {"light": "light"}, "set": {"bias": bias}}},
        "outputs": {"light": {"file": "light.npy"}},
    }
    (tmp_path / "graph.yaml").write_text(yaml.safe_dump(graph))
    (judged,) = judge(load_document(tmp_path / "graph.yaml"), device)["dapple"].judgements
    assert judged.verdict == verdict
    assert judged.z_test is not None
    assert judged.z_test.frames == 16
    assert judged.z_test.accepted < 0.05 if bias else judged.z_test.accepted >= judged.z_test.required
    assert judged.pictures is not None
    assert judged.pictures.variance is not None
    assert judged.pictures.variance.mean() == pytest.approx(0.25 / 12, rel=0.05)  # of uniform noise 0.5 wide
