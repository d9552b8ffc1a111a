"""Whatever the plan does with memory and order, the image is bit-identical."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.node.discovery import node_folder
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.render import RenderOptions, render_document

pytestmark = pytest.mark.gpu

GRAPH = node_folder().parent / "graphs" / "deferred_shading.yaml"
SMALL = ["scene.detail=0.05", "resources.shadow.fixed=[256, 256]", "scene.lights.points={count: 8, seed: 1}"]
OPTIONS = RenderOptions(size=(160, 90), samples=0)


def image(options: RenderOptions, path: Path = GRAPH) -> np.ndarray:
    """The demo graph's output."""
    return render_document(load_document(path, SMALL), options).images["image"]


@pytest.fixture(scope="module")
def plain() -> np.ndarray:
    """The image with every default."""
    found = image(OPTIONS)
    assert np.ptp(found[..., :3]) > 100, "a flat image proves nothing"
    return found


@pytest.mark.parametrize(
    "options",
    [
        pytest.param(replace(OPTIONS, poison=True), id="poison"),
        pytest.param(replace(OPTIONS, plan=PlanOptions(alias=False)), id="no alias"),
        pytest.param(replace(OPTIONS, plan=PlanOptions(cull=False)), id="no cull"),
        pytest.param(replace(OPTIONS, poison=True, plan=PlanOptions(alias=False)), id="poison, no alias"),
        pytest.param(replace(OPTIONS, plan=PlanOptions(order="memory")), id="memory order"),
        pytest.param(replace(OPTIONS, full=True), id="full"),
    ],
)
def test_options_do_not_change_the_image(device: Device, plain: np.ndarray, options: RenderOptions) -> None:
    found = image(options)
    if options.full and not device.info.is_software:
        # Another shader, which a driver may compile to other roundings; antialiasing may then decide otherwise.
        assert (found != plain).any(axis=-1).mean() < 0.05
    else:
        assert (found == plain).all()


def test_random_legal_orders_give_the_same_image(plain: np.ndarray) -> None:
    orders = set()
    for seed in range(20):
        options = replace(OPTIONS, plan=PlanOptions(order="random", seed=seed), poison=True)
        result = render_document(load_document(GRAPH, SMALL), options)
        orders.add(tuple(s.name for s in result.plan.order))
        assert (result.images["image"] == plain).all(), f"order seed {seed}"
    assert len(orders) > 1, "twenty seeds must not all give one order"


def test_shuffled_passes_give_the_same_plan_and_image(plain: np.ndarray, tmp_path: Path) -> None:
    document = yaml.safe_load(GRAPH.read_text())
    for key in ("passes", "resources"):
        document[key] = dict(reversed(document[key].items()))
    shuffled = tmp_path / "shuffled.yaml"
    shuffled.write_text(yaml.safe_dump(document, sort_keys=False))
    assert (image(OPTIONS, shuffled) == plain).all()
    orders = [[s.name for s in render_document(load_document(p, SMALL), OPTIONS).plan.order] for p in (GRAPH, shuffled)]
    assert orders[0] == orders[1]


def test_aliasing_saves_memory_here() -> None:
    """Otherwise the tests above compare a plan with itself."""
    result = render_document(load_document(GRAPH, SMALL), OPTIONS)
    assert result.plan.totals.used < result.plan.totals.unshared
    assert any(len(slot.tenants) > 1 for slot in result.plan.slots)
