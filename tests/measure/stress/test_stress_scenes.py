"""The common extremes of scenes: on a healthy graph they pass; lighting that makes light of nothing does not."""

from __future__ import annotations

from pathlib import Path

import pytest

from rendergraph.measure.stress.common import COMMON
from rendergraph.measure.stress.stress import StressOptions, StressReport, stress
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import Extreme
from rendergraph.scene.floating_origin import ORIGIN

pytestmark = pytest.mark.gpu

GRAPH = """\
rendergraph: 1
frame: {size: [12, 8]}
scene: {source: spheres}
resources: {depth: {format: d32f}, hdr: {format: rgba16f}}
passes:
  shade: {node: forward_shading, write: {color: hdr, depth: depth}}
  sky: {node: sky, read: {depth: depth}, write: {color: hdr}, after: [shade]}
outputs: {hdr: {file: hdr.npy}}
"""


@pytest.fixture
def graph(tmp_path: Path) -> Path:
    """Shading and a sky."""
    file = tmp_path / "scene.yaml"
    file.write_text(GRAPH)
    return file


def run(graph: Path, *only: str) -> StressReport:
    """In this process."""
    return stress(str(graph), StressOptions(only=only, isolate=False))


def test_a_healthy_graph_survives_the_extremes_of_scenes(graph: Path) -> None:
    cases = [c.name for c in COMMON if c.edit is not None and c.name not in ("lights_65536", "fov_170")]
    report = run(graph, *cases, "standard_z", "reversed_z_d24", "float_targets")
    assert [(c.name, p.name, f) for c in report.cases for p in c.passes for f in p.failures if c.failed] == []
    assert {c.state for c in report.cases} == {"ran"}


def test_all_lights_at_once(graph: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the reference, which takes most of the time."""
    monkeypatch.setattr(
        find_node("forward_shading"), "extremes", (Extreme("lights_65536", "", skips={"error": "too slow for a test"}),)
    )
    report = stress(str(graph), StressOptions(only=("lights_65536",), isolate=False))
    assert (report.cases[0].size, report.failed) == ((8, 5), ())
    assert {p.name: p.status for p in report.cases[0].passes} == {"shade": "pass", "sky": "pass"}


@pytest.mark.parametrize(
    ("case", "right", "wrong"),
    [
        ("furnace_rough", "vec3 radiance = emissive;", "vec3 radiance = emissive + 0.05;"),
        ("darkness", "vec3 radiance = emissive;", "vec3 radiance = emissive + 0.001;"),
        ("fov_1", "return min(radiance, MAX_RADIANCE);", "return sqrt(radiance - 1000.0);"),
    ],
)
def test_created_light_is_found(
    graph: Path, case: str, right: str, wrong: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    from rendergraph.device import includes

    real = includes.preprocess

    def broken(*arguments, **named):  # type: ignore[no-untyped-def]
        text, table = real(*arguments, **named)
        return text.replace(right, wrong), table

    monkeypatch.setattr("rendergraph.device.programs.preprocess", broken)
    found = next(p for p in run(graph, case).cases[0].passes if p.name == "shade")
    assert found.status == "fail"
    assert ("finite" if case == "fov_1" else "energy") in [f.check for f in found.failures]
    assert all(f.texel is not None for f in found.failures if f.check in ("finite", "energy"))


def test_far_from_the_origin_needs_the_floating_origin(monkeypatch: pytest.MonkeyPatch) -> None:
    options = StressOptions(only=("far_from_origin",), isolate=False)
    assert not stress("gbuffer", options).failed
    monkeypatch.setattr("rendergraph.run.runner.device_origin", lambda cameras: ORIGIN)
    assert [f.check for f in stress("gbuffer", options).cases[0].passes[0].failures] == ["error", "error"]
