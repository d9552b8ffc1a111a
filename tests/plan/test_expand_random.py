"""Random wiring of small nodes: a graph or a list of diagnostics, never anything else."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st
from toy_nodes import TOYS, install_toys, write

from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.expand import expand

GOOD = ["toy_maker", "toy_maker", "toy_over", "toy_inner"]
PLAIN = st.sampled_from(["a", "b", "c", "image"])
NAMES = st.sampled_from(["a", "b", "c", "image", "p.half", "q.x", "r"])
PORTS = {
    "toy_filter": ["color", "table"],
    "toy_over": ["color"],
    "toy_layered": ["layers", "samples"],
    "toy_peek": ["a", "b"],
}

RESOURCE = st.one_of(
    st.fixed_dictionaries(
        {"format": st.sampled_from(["rgba16f", "rgba8", "d32f", "r8ui"])},
        optional={
            "scale": st.sampled_from([0.001, 0.5, 16]),
            "samples": st.sampled_from([1, 4]),
            "layers": st.integers(1, 5),
            "like": st.sampled_from(["a", "b", "c"]),
        },
    ),
    st.fixed_dictionaries({"bytes": st.sampled_from([4, 64])}),
    st.fixed_dictionaries({"previous": st.sampled_from(["a", "b", "c", "image"])}),
    st.fixed_dictionaries({"like": st.sampled_from(["a", "b", "c", "image"])}),
    st.fixed_dictionaries({"file": st.sampled_from(["none.png", "..", "graph.yaml", "/"])}),
)


@st.composite
def documents(draw: Any) -> dict[str, Any]:
    """A graph file that loads, or nearly."""
    passes = {}
    for name in draw(st.lists(st.sampled_from(["p", "q", "r", "s"]), min_size=1, unique=True)):
        wild = draw(st.integers(0, 5)) == 0
        node = draw(st.sampled_from(sorted(TOYS) if wild else GOOD))
        read = {port: draw(NAMES) for port in PORTS.get(node, ["color"] if "input" in node else [])}
        passes[name] = {"node": node, "read": read, "write": {"color": draw(NAMES if wild else PLAIN)}}
        passes[name]["after"] = draw(st.lists(st.sampled_from(["p", "q", "zz"]), max_size=int(wild)))
    resources = {name: {"format": "rgba16f"} for name in "abc"}
    resources |= draw(st.dictionaries(st.sampled_from(["a", "b", "c"]), RESOURCE, max_size=2))
    written = [entry["write"]["color"] for entry in passes.values()]
    outputs = {draw(st.one_of(st.sampled_from(written), NAMES)): {"file": "a.npy"}}
    barrier = {"resource": draw(NAMES), "after": "p", "before": draw(NAMES), "kind": "command"}
    return {
        "resources": resources,
        "passes": passes,
        "outputs": outputs,
        "barriers": draw(st.sampled_from([[], [barrier]])),
    }


@settings(
    max_examples=150, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(document=documents())
def test_never_a_traceback(document: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install_toys(monkeypatch)
    failure: RenderGraphError | None = None
    try:
        found, _ = expand(write(tmp_path, yaml.safe_dump(document)))
    except RenderGraphError as error:
        failure = error
    event("expanded" if failure is None else "refused")
    if failure is not None:
        assert failure.diagnostics
        assert all(d.position is not None for d in failure.diagnostics)
        return
    assert set(found.passes) == set(document["passes"])
    touched = {a.resource for p in found.passes.values() for s in p.subpasses for a in s.accesses}
    assert touched <= found.resources.keys()
    assert set(found.outputs) <= found.resources.keys()
    assert all(r.previous_of in found.resources for r in found.resources.values() if r.previous_of)
