"""Barriers of small graphs, bit by bit, and the comparison with what the author stated."""

from __future__ import annotations

import pytest
from plan_graphs import adds, make_graph, make_pass, reads, texture, writes

from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.graph import BufferDesc, CopyTexture, Graph, Pass, SubPass
from rendergraph.plan.place_barriers import place
from rendergraph.plan.plan import Barrier, PlanOptions

BUFFER = {"b": BufferDesc(256)}


def barriers_of(graph: Graph) -> dict[str, Barrier]:
    """Barriers by the sub-pass they are issued before."""
    plan, _ = compile_plan(graph)
    return {plan.order[b.index].name: b for b in plan.barriers}


@pytest.mark.parametrize(
    ("usage", "bit"),
    [
        ("storage_read", 0x2000), ("uniform", 0x4), ("indirect", 0x40), ("vertex", 0x1), ("index", 0x2),
        ("copy_from", 0x200), ("host_read", 0x200),
    ],
)  # fmt: skip
def test_the_bit_names_how_a_stored_buffer_is_used_next(usage: str, bit: int) -> None:
    graph = make_graph(
        [make_pass("a", [writes("b", "storage_write")]), make_pass("r", [reads("b", usage), writes("out")])],
        ["out"],
        descs=BUFFER,
    )
    found = barriers_of(graph)
    assert found["r.0"].bits == bit
    # The next frame's store waits for this frame's read.
    assert found["a.0"].bits == 0x2000


@pytest.mark.parametrize(
    ("usage", "bit"), [("sampled", 0x8), ("image_read", 0x20), ("copy_from", 0x100), ("host_read", 0x100)]
)
def test_the_bit_names_how_a_stored_image_is_used_next(usage: str, bit: int) -> None:
    graph = make_graph(
        [make_pass("a", [writes("i", "image_write")]), make_pass("r", [reads("i", usage), writes("out")])], ["out"]
    )
    found = barriers_of(graph)
    assert (found["r.0"].bits, found["a.0"].bits) == (bit, 0x20)


@pytest.mark.parametrize(("usage", "bit"), [("color", 0x400), ("clear", 0x100), ("copy_to", 0x100)])
def test_coherent_writes_wait_for_stores(usage: str, bit: int) -> None:
    graph = make_graph(
        [
            make_pass("a", [writes("i", "image_write")]),
            make_pass("r", [reads("i"), writes("s")]),
            make_pass("w", [writes("i", usage)], after=["r", "a"]),
            make_pass("z", [reads("i"), reads("s"), writes("out")]),
        ],
        ["out"],
    )
    found = barriers_of(graph)
    assert found["w.0"].bits == bit
    assert "z.0" not in found  # what `w` replaced needs no fetch barrier


def test_a_blit_is_rendering() -> None:
    blit = SubPass(
        "blit.0", "blit", (reads("i", "copy_from"), writes("out", "copy_to")), CopyTexture("i", "out", blit=True)
    )
    graph = make_graph([make_pass("a", [writes("i", "image_write")]), Pass("blit", "copy", (blit,))], ["out"])
    assert barriers_of(graph)["blit.0"].bits == 0x400


def test_drawing_sampling_copying_and_clearing_need_none() -> None:
    graph = make_graph(
        [
            make_pass("a", [writes("x", "clear")], [adds("x")], [reads("x"), writes("y")]),
            make_pass("b", [reads("y", "copy_from"), writes("z", "copy_to")]),
            make_pass("c", [reads("z", "image_read"), writes("out")]),
        ],
        ["out"],
    )
    assert barriers_of(graph) == {}


def test_reads_of_one_kind_share_a_barrier() -> None:
    graph = make_graph(
        [
            make_pass("a", [writes("i", "image_write")]),
            make_pass("r1", [reads("i"), writes("x")]),
            make_pass("r2", [reads("i"), writes("y")]),
            make_pass("r3", [reads("i", "image_read"), writes("z")]),
        ],
        ["x", "y", "z"],
    )
    found = barriers_of(graph)
    assert {name: b.bits for name, b in found.items()} == {"a.0": 0x20, "r1.0": 0x8, "r3.0": 0x20}
    assert {h.later for h in found["r1.0"].hazards} == {"r1.0", "r2.0"}


def test_a_store_waits_for_earlier_sampling() -> None:
    graph = make_graph(
        [
            make_pass("a", [writes("i")]),
            make_pass("r", [reads("i"), writes("x")]),
            make_pass("w", [adds("i", "image_write")], after=["r"]),
            make_pass("z", [reads("i"), reads("x"), writes("out")]),
        ],
        ["out"],
    )
    found = barriers_of(graph)
    assert found["w.0"].bits == 0x20
    assert found["a.0"].bits == 0x400  # the next frame's drawing over this frame's store


def test_disjoint_mips_do_not_conflict() -> None:
    chain = [[writes("m", "image_write", mip=0)]]
    chain += [[reads("m", "sampled", mip=i - 1), writes("m", "image_write", mip=i)] for i in (1, 2)]
    passes = [make_pass("c", *chain, keep=True), make_pass("z", [reads("m", mip=0), writes("out")], after=["c"])]
    graph = make_graph(passes, ["out"], descs={"m": texture(mips=3)})
    found = barriers_of(graph)
    assert found["c.1"].bits & 0x8
    assert found["c.2"].bits & 0x8
    assert "z.0" not in found  # mip 0 was stored before c.1's barrier


def test_tenants_of_one_slot_guard_each_other() -> None:
    graph = make_graph(
        [
            make_pass("a", [writes("t1", "image_write")]),
            make_pass("b", [reads("t1", "image_read"), writes("s")]),
            make_pass("c", [reads("s"), writes("t2")]),
            make_pass("d", [reads("t2"), writes("out")]),
        ],
        ["out"],
        descs={"s": texture("r8", 8), "t2": texture("r32f")},
    )
    plan, _ = compile_plan(graph)
    assert plan.slot_of["t1"] == plan.slot_of["t2"]
    found = {plan.order[b.index].name: b for b in plan.barriers}
    assert found["c.0"].bits == 0x400
    assert {(h.resource, h.previous_resource) for h in found["c.0"].hazards} == {("t2", "t1")}
    assert any(d.reason == "shared_storage" and d.subject == "c.0" for d in plan.decisions)
    apart, _ = compile_plan(graph, PlanOptions(alias=False))
    assert "c.0" not in {apart.order[b.index].name for b in apart.barriers}


def test_history_is_guarded_across_the_frame() -> None:
    graph = make_graph(
        [make_pass("a", [reads("last"), writes("x", "image_write")]), make_pass("b", [reads("x"), writes("out")])],
        ["out"],
        history={"last": "x"},
    )
    found = barriers_of(graph)
    # `b` fetches what `a` stored; the fetch of `last` in the next frame is served by that barrier too. The store waits
    # for the fetch of the same storage, a frame ago, as `last`.
    assert {name: b.bits for name, b in found.items()} == {"a.0": 0x20, "b.0": 0x8}
    assert ("last", "x") in {(h.resource, h.previous_resource) for h in found["b.0"].hazards}
    assert ("x", "last") in {(h.resource, h.previous_resource) for h in found["a.0"].hazards}


def test_feedback_takes_a_texture_barrier() -> None:
    graph = make_graph([make_pass("a", [writes("x")]), make_pass("f", [reads("x"), adds("x")])], ["x"])
    found = barriers_of(graph)
    assert {name: (b.bits, b.texture_barrier) for name, b in found.items()} == {"f.0": (0, True)}


def test_depth_that_is_only_tested_may_be_sampled() -> None:
    graph = make_graph(
        [make_pass("a", [writes("d", "depth")]), make_pass("s", [reads("d"), reads("d", "depth_read"), writes("out")])],
        ["out"],
        descs={"d": texture("d32f")},
    )
    assert barriers_of(graph) == {}


def test_feedback_on_another_mip_is_none() -> None:
    graph = make_graph(
        [make_pass("a", [writes("x", mip=0)], [reads("x", mip=0), writes("x", mip=1)])], ["x"],
        descs={"x": texture(mips=2)},
    )  # fmt: skip
    assert barriers_of(graph) == {}


# ---------------------------------------------------------------- placing on the circle


@pytest.mark.parametrize(
    ("hazards", "length", "points"),
    [
        ({3: 0}, 5, [3]),
        ({3: 0, 4: 1}, 5, [3]),
        ({3: 0, 4: 3}, 5, [3, 4]),
        ({0: -1, 3: 0}, 5, [0, 3]),  # the tail of one frame against the head of the next
        ({0: -3, 3: 1}, 5, [3]),  # a barrier at 3 serves the next frame's head too
        ({1: -5, 2: -5}, 5, [1]),
    ],
)
def test_placing(hazards: dict[int, int], length: int, points: list[int]) -> None:
    assert place(hazards, length) == points


# ---------------------------------------------------------------- the author's barriers


def light_lists(barriers: list[tuple[str, str, str, str]] | None) -> Graph:
    return make_graph(
        [
            make_pass("cull", [writes("b", "storage_write")]),
            make_pass("light", [reads("b", "storage_read"), writes("x")], [reads("b", "uniform"), adds("x")]),
            make_pass("dead", [reads("x"), writes("y")]),
        ],
        ["x"],
        descs=BUFFER,
        barriers=barriers,
    )


STORAGE = ("b", "cull", "light", "shader_storage")
UNIFORM = ("b", "cull", "light", "uniform")


def codes(barriers: list[tuple[str, str, str, str]] | None) -> list[str]:
    try:
        return [d.code for d in compile_plan(light_lists(barriers))[1] if d.code != "RG239"]
    except RenderGraphError as error:
        return [d.code for d in error.diagnostics]


def test_stated_barriers_are_compared() -> None:
    assert codes(None) == []
    assert codes([STORAGE, UNIFORM]) == []
    assert codes([]) == ["RG401", "RG401"]
    assert codes([STORAGE]) == ["RG401"]
    assert codes([("b", "cull.0", "light.0", "shader_storage"), ("b", "cull", "light.1", "uniform")]) == []


def test_remarks_on_stated_barriers() -> None:
    assert codes([STORAGE, UNIFORM, ("x", "light", "cull", "texture_fetch")]) == ["RG402"]
    assert codes([STORAGE, UNIFORM, ("b", "cull", "light", "command")]) == ["RG403"]
    assert codes([STORAGE, UNIFORM, ("x", "light", "dead", "shader_image")]) == ["RG404"]
    # Stating what crosses the frame boundary is not asked for, but true.
    assert codes([STORAGE, UNIFORM, ("b", "light", "cull", "shader_storage")]) == []


def test_a_missing_barrier_names_what_to_state() -> None:
    with pytest.raises(RenderGraphError) as caught:
        compile_plan(light_lists([STORAGE]))
    (found,) = caught.value.diagnostics
    assert found.severity == "error"
    assert (found.data["resource"], found.data["after"], found.data["before"], found.data["kind"]) == UNIFORM
