"""Every shipped graph validates without a warning, renders, is finite, and looks as it did."""

from pathlib import Path

import numpy as np
import pytest

from rendergraph.device.context import open_device
from rendergraph.document.load import load_document
from rendergraph.node.discovery import node_folder, node_names
from rendergraph.plan.validate import validate_graph
from rendergraph.run.render import RenderOptions, render_document
from tests.graphs import golden

GRAPHS = sorted((node_folder().parent / "graphs").glob("*.yaml"))
SIZE = (160, 90)
#: Full detail is for looking at: tests ask the same questions of fewer triangles.
CHEAPER = ["scene.detail=0.1"]


def overrides(graph: Path) -> list[str]:
    """What makes a graph quick enough to test."""
    model = load_document(graph).model
    return CHEAPER if model.scene is not None and model.scene.source == "atrium" else []


@pytest.mark.parametrize("graph", GRAPHS, ids=lambda p: p.stem)
def test_validates_without_findings(graph: Path) -> None:
    diagnostics, code = validate_graph(graph)
    assert [(d.code, d.text) for d in diagnostics] == []
    assert code == 0


@pytest.mark.gpu
@pytest.mark.parametrize("graph", GRAPHS, ids=lambda p: p.stem)
def test_renders_finite_and_like_its_golden(graph: Path, tmp_path: Path, pytestconfig: pytest.Config) -> None:
    document = load_document(graph, overrides(graph))
    frames = min(document.model.frame.count, 8)
    options = RenderOptions(size=SIZE, frames=frames, samples=0, check_finite=True, poison=True)
    result = render_document(document, options)
    on_llvmpipe = open_device().info.renderer.startswith("llvmpipe")
    for name, pixels in result.images.items():
        assert np.isfinite(pixels.astype(np.float64)).all()
        assert np.ptp(pixels.astype(np.float64)) > 0, f"{name} is one flat value"
        if on_llvmpipe:
            key = f"{graph.stem}.{name}"
            golden.compare(key, pixels, tmp_path, regenerate=pytestconfig.getoption("--regenerate-goldens"))


def test_every_node_has_a_graph_named_after_it() -> None:
    assert set(node_names()) <= {graph.stem for graph in GRAPHS}


def test_a_changed_image_fails_and_leaves_its_difference(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(golden, "FOLDER", tmp_path / "goldens")
    pixels = np.full((4, 6, 3), 100, dtype=np.uint8)
    golden.compare("a", pixels, tmp_path, regenerate=True)
    golden.compare("a", pixels + np.uint8(1), tmp_path, regenerate=False)
    pixels[1, 2] += 2
    with pytest.raises(AssertionError, match=r"1 pixels differ by up to 2 .* \(x 2, y 1\)"):
        golden.compare("a", pixels, tmp_path, regenerate=False)
    assert (tmp_path / "a_difference.png").is_file()
    with pytest.raises(AssertionError, match="no golden image"):
        golden.compare("b", pixels, tmp_path, regenerate=False)
