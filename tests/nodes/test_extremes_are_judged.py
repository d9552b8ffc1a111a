"""Every extreme that these nodes declare, on their own graph: within tolerance with all invariants, or refused."""

from __future__ import annotations

import pytest
from judged import judge_run, passes_of

from rendergraph.device.context import Device
from rendergraph.document.messages import RenderGraphError
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import Extreme

NODES = ("tonemap", "exposure", "sky", "fxaa", "copy", "clear", "fullscreen", "compute", "draw")
#: Fewer frames than the graphs have, enough for history.
FRAMES = {"exposure": ("frame.count=3",), "compute": ("frame.count=3",)}
CASES = [
    pytest.param(node, extreme, id=f"{node}-{extreme.name}") for node in NODES for extreme in find_node(node).extremes
]


@pytest.mark.gpu
@pytest.mark.parametrize(("node", "extreme"), CASES)
def test_extreme(device: Device, node: str, extreme: Extreme) -> None:
    settings = ("frame.size=[48, 27]", *FRAMES.get(node, ()), *extreme.overrides)
    if extreme.refused:
        with pytest.raises(RenderGraphError) as raised:
            passes_of(device, node, node, *settings)
        assert extreme.refused in {d.code for d in raised.value.diagnostics}
        return
    runs = passes_of(device, node, node, *settings)
    assert runs
    for run in runs.values():
        judged = judge_run(node, run)
        assert judged.above == ()
        assert judged.within
        assert judged.broken == ()


@pytest.mark.parametrize("node", NODES)
def test_names_are_told_apart_and_explained(node: str) -> None:
    extremes = find_node(node).extremes
    assert len({e.name for e in extremes}) == len(extremes) >= 4
    # One without overrides amends the common extreme of its name.
    assert all(e.help.endswith(".") and (e.overrides or e.skips) for e in extremes)
