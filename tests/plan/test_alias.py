"""Who shares memory with whom, the reason given for each, and the five totals."""

from __future__ import annotations

import pytest
from plan_graphs import adds, make_graph, make_pass, reads, texture, writes

from rendergraph.plan.compile import compile_plan
from rendergraph.plan.graph import BufferDesc, Graph, Kind, TextureDesc
from rendergraph.plan.packing import Block, pack
from rendergraph.plan.plan import Plan, PlanOptions


def chain(*descs: TextureDesc | BufferDesc) -> Graph:
    """r0 -> r1 -> r2 -> ... -> out: each lives for two steps."""
    passes = [make_pass("p0", [writes("r0", _write(descs[0]))])]
    for i, desc in enumerate(descs[1:], 1):
        passes.append(make_pass(f"p{i}", [reads(f"r{i - 1}", _read(descs[i - 1])), writes(f"r{i}", _write(desc))]))
    passes.append(make_pass("end", [reads(f"r{len(descs) - 1}", _read(descs[-1])), writes("out")]))
    return make_graph(passes, ["out"], descs={f"r{i}": d for i, d in enumerate(descs)})


def _write(desc: TextureDesc | BufferDesc) -> str:
    if isinstance(desc, BufferDesc):
        return "storage_write"
    return "depth" if desc.format.startswith("d") else "color"


def _read(desc: TextureDesc | BufferDesc) -> str:
    return "storage_read" if isinstance(desc, BufferDesc) else "sampled"


def plan_of(graph: Graph, **options: object) -> Plan:
    return compile_plan(graph, PlanOptions(**options))[0]  # type: ignore[arg-type]


def reasons(plan: Plan) -> dict[str, str]:
    return {d.subject: d.reason for d in plan.decisions if d.kind == "alias"}


def test_formats_of_one_view_class_take_turns() -> None:
    plan = plan_of(chain(texture("rgba8"), texture("r32f"), texture("rg16f"), texture("r11g11b10f")))
    assert [slot.tenants for slot in plan.slots] == [("r0", "r2"), ("r1", "r3")]
    assert plan.totals.exact_pool == 4 * 16 * 16 * 4
    assert plan.totals.used == plan.totals.view_pool == plan.totals.load == 2 * 16 * 16 * 4
    assert reasons(plan) == {
        "out": "never_pooled_persistent",
        **dict.fromkeys(("r0", "r1", "r2", "r3"), "shares_slot"),
    }


def test_storage_has_the_format_of_most_tenants() -> None:
    plan = plan_of(chain(texture("rgba8"), texture("r8"), texture("r32f"), texture("r8"), texture("r32f")))
    assert {slot.tenants: slot.desc.format for slot in plan.slots} == {
        ("r0", "r2", "r4"): "r32f",
        ("r1", "r3"): "r8",
    }


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (texture("rgba8"), texture("rgba16f")),
        (texture("rgba8"), texture("rgba8", 8)),
        (texture("rgba8"), texture("rgba8", mips=2)),
        (texture("rgba8"), texture("rgba8", layers=2)),
        (texture("d32f"), texture("r32f")),
        (texture("d24"), texture("d32f")),
        (texture("rgba8", samples=4), texture("r32f", samples=4)),
        (texture("rgba8", samples=4), texture("rgba8")),
    ],
    ids=["texel", "size", "mips", "layers", "depth-colour", "depth-depth", "ms-class", "samples"],
)
def test_other_classes_never_share(one: TextureDesc, other: TextureDesc) -> None:
    plan = plan_of(chain(one, texture("r8", 4), other))
    assert plan.slot_of["r0"] != plan.slot_of["r2"]
    assert reasons(plan)["r0"] == "only_one_in_class"


@pytest.mark.parametrize("desc", [texture("d32f"), texture("rgba8", samples=4)], ids=["depth", "multisampled"])
def test_exact_formats_share(desc: TextureDesc) -> None:
    plan = plan_of(chain(desc, texture("r8", 4), desc))
    assert plan.slot_of["r0"] == plan.slot_of["r2"]


def test_a_step_that_reads_one_and_writes_the_other_keeps_them_apart() -> None:
    plan = plan_of(chain(texture(), texture()))
    assert plan.slot_of["r0"] != plan.slot_of["r1"]
    assert reasons(plan)["r0"] == reasons(plan)["r1"] == "overlaps_in_time"


def test_history_and_its_source_are_never_pooled() -> None:
    graph = make_graph(
        [
            make_pass("a", [writes("t")]),
            make_pass("b", [reads("t"), reads("last"), writes("x")]),
            make_pass("c", [reads("x"), writes("out")]),
        ],
        ["out"],
        history={"last": "x"},
    )
    plan = plan_of(graph)
    assert set(plan.slot_of) == {"t"}
    found = reasons(plan)
    assert (found["last"], found["x"]) == ("never_pooled_history", "never_pooled_persistent")


def test_imported_resources_are_never_pooled() -> None:
    graph = make_graph([make_pass("a", [reads("photo"), writes("x")])], ["x"], kinds={"photo": Kind.IMPORTED})
    assert reasons(plan_of(graph))["photo"] == "never_pooled_imported"


def test_a_transient_output_lives_to_the_end_of_the_frame() -> None:
    passes = [make_pass("a", [writes("x")]), make_pass("b", [writes("y")]), make_pass("c", [reads("y"), writes("z")])]
    graph = make_graph(passes, ["x", "z"], kinds={"y": Kind.TRANSIENT})
    transient = make_graph(passes, ["z"], kinds={})
    assert plan_of(transient).culled == ("a.0",)
    resources = {n: r if n != "x" else type(r)(r.name, r.desc) for n, r in graph.resources.items()}
    plan = plan_of(type(graph)(graph.frame, resources, graph.passes, graph.outputs))
    assert plan.lifetimes["x"].last == len(plan.order) - 1
    assert all(slot.tenants[-1] == "x" for slot in plan.slots if "x" in slot.tenants)


def test_aliasing_off_gives_each_its_own() -> None:
    plan = plan_of(
        chain(texture(), texture(), texture(), BufferDesc(100), BufferDesc(100), BufferDesc(100)), alias=False
    )
    assert all(len(slot.tenants) == 1 for slot in plan.slots)
    assert sorted(b.offset for b in plan.buffer_of.values()) == [0, 256, 512]
    assert plan.totals.used == plan.totals.unshared == 3 * 1024 + 3 * 256
    assert {reasons(plan)[f"r{i}"] for i in range(6)} == {"aliasing_off"}


def test_buffers_share_ranges_of_one_heap() -> None:
    plan = plan_of(chain(*[BufferDesc(1000)] * 4))
    assert plan.heap_bytes == 2 * 1024
    assert {place.offset for place in plan.buffer_of.values()} == {0, 1024}
    assert {place.bytes for place in plan.buffer_of.values()} == {1000}
    assert {reasons(plan)[f"r{i}"] for i in range(4)} == {"shares_heap_range"}


def test_buffers_alive_together_are_apart() -> None:
    plan = plan_of(chain(BufferDesc(64), BufferDesc(64)))
    assert reasons(plan)["r0"] == "overlaps_in_time"


def test_totals_by_hand() -> None:
    # r0 (1 KiB) and r1 (2 KiB), then r1 and r2 (1 KiB), then r2 and r3 (4 KiB): the peak is the last pair.
    plan = plan_of(chain(texture("rgba8"), texture("rgba16f"), texture("r32f"), texture("rgba32f")))
    totals = plan.totals
    assert (totals.unshared, totals.exact_pool, totals.view_pool) == (8192, 8192, 7168)
    assert (totals.placed, totals.load, totals.peak) == (5120, 5120, ("r2", "r3"))


def test_a_blended_target_stays_live_between_its_writers() -> None:
    graph = make_graph(
        [
            make_pass("a", [writes("x")]),
            make_pass("b", [writes("y")], after=["a"]),
            make_pass("c", [reads("y"), adds("x")], [reads("x"), writes("out")]),
        ],
        ["out"],
    )
    plan = plan_of(graph)
    assert plan.slot_of["x"] != plan.slot_of["y"]


# ---------------------------------------------------------------- the packer


def check(blocks: list[Block], offsets: list[int], size: int) -> None:
    for i, (a, at) in enumerate(zip(blocks, offsets, strict=True)):
        assert 0 <= at <= size - a.bytes
        for b, other in zip(blocks[:i], offsets[:i], strict=True):
            if a.first <= b.last and b.first <= a.last:
                assert at + a.bytes <= other or other + b.bytes <= at


def test_packing_reaches_the_bound_where_first_use_order_does_not() -> None:
    # Placed by first use, c lands above the hole that a leaves, and d does not fit into it any more.
    blocks = [Block(4, 0, 1), Block(2, 0, 3), Block(2, 2, 5), Block(4, 4, 6), Block(2, 2, 3)]
    offsets, size = pack(blocks, 6)
    check(blocks, offsets, size)
    assert size == 6


def test_packing_nothing() -> None:
    assert pack([], 0) == ([], 0)


def test_packing_too_many_pairs_still_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rendergraph.plan.packing.MAX_PAIRS", 10)
    blocks = [Block(256 * (1 + i % 5), i // 3, i // 3 + i % 7) for i in range(60)]
    offsets, size = pack(blocks, 0)
    check(blocks, offsets, size)
    assert size < sum(b.bytes for b in blocks)
