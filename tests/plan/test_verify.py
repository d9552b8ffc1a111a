"""The verifier finds planted faults: each good plan is broken in one way, and the fault must be named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from plan_graphs import adds, make_graph, make_pass, reads, texture, writes

from rendergraph.plan import compile as compile_module
from rendergraph.plan.compile import PlanError, compile_plan
from rendergraph.plan.graph import BufferDesc, Graph, Kind
from rendergraph.plan.plan import Lifetime, Plan, TextureSlot
from rendergraph.plan.verify import verify


def frame() -> Graph:
    """A small frame with everything in it."""
    return make_graph(
        [
            make_pass("gbuffer", [writes("depth", "depth"), writes("normal")]),
            make_pass("count", [writes("list", "storage_write"), reads("depth")], [writes("list2", "storage_write")]),
            make_pass("ao", [reads("depth"), reads("normal"), writes("ao", "image_write")]),
            make_pass("light", [reads("ao"), reads("list", "uniform"), reads("list2", "storage_read"), writes("hdr")]),
            make_pass("glow", [reads("list2", "uniform"), adds("hdr")]),
            make_pass("fog", [reads("depth"), adds("hdr")], after=["glow"]),
            make_pass("blend", [reads("hdr"), reads("last"), writes("taa")]),
            make_pass("tone", [reads("taa"), writes("ldr")], [reads("ldr"), writes("out")]),
            make_pass("dead", [reads("ldr"), writes("unread")]),
        ],
        ["out"],
        descs={
            "depth": texture("d32f"),
            "list": BufferDesc(1024),
            "list2": BufferDesc(1024),
            "hdr": texture("r32f"),
            "unread": texture("r8"),
        },
        history={"last": "taa"},
    )


PLAN = compile_plan(frame())[0]


def swapped(plan: Plan, a: str, b: str) -> Plan:
    """The plan with two sub-passes in each other's place."""
    at = {step.name: i for i, step in enumerate(plan.order)}
    order = list(plan.order)
    order[at[a]], order[at[b]] = order[at[b]], order[at[a]]
    return replace(plan, order=tuple(order))


def merged(plan: Plan, a: str, b: str) -> Plan:
    """The plan with one texture moved into another's slot."""
    slots = [TextureSlot(s.desc, tuple(t for t in s.tenants if t != b)) for s in plan.slots]
    home = plan.slot_of[a]
    slots[home] = TextureSlot(
        slots[home].desc, tuple(sorted((*slots[home].tenants, b), key=lambda n: plan.lifetimes[n].first))
    )
    return replace(plan, slots=tuple(slots), slot_of={**plan.slot_of, b: home})


def without_step(plan: Plan, name: str) -> Plan:
    """The plan with a sub-pass culled."""
    order = tuple(step for step in plan.order if step.name != name)
    return replace(plan, order=order, culled=(*plan.culled, name))


def pooled(plan: Plan, name: str) -> Plan:
    desc = plan.graph.resources[name].desc
    assert not isinstance(desc, BufferDesc)
    return replace(
        plan,
        slots=(*plan.slots, TextureSlot(desc, (name,))),
        slot_of={**plan.slot_of, name: len(plan.slots)},
    )


def kinds(graph: Graph, **changed: Kind) -> Graph:
    return replace(graph, resources={n: replace(r, kind=changed.get(n, r.kind)) for n, r in graph.resources.items()})


def moved_buffer(plan: Plan) -> Plan:
    place = plan.buffer_of["list"]
    return replace(plan, buffer_of={**plan.buffer_of, "list2": place})


FAULTS: dict[str, tuple[str, Callable[[Plan], Plan]]] = {
    "reader before writer": ("order", lambda p: swapped(p, "gbuffer.0", "ao.0")),
    "modifier before definer": ("order", lambda p: swapped(p, "light.0", "glow.0")),
    "modifiers against after": ("order", lambda p: swapped(p, "glow.0", "fog.0")),
    "reader before the last writer": ("order", lambda p: swapped(p, "fog.0", "blend.0")),
    "steps out of order": ("order", lambda p: swapped(p, "tone.0", "tone.1")),
    "a step twice": ("order", lambda p: replace(p, order=(*p.order, p.order[0]))),
    "a step lost": ("order", lambda p: replace(p, order=p.order[:-1])),
    "a step changed": ("order", lambda p: replace(p, order=(replace(p.order[0], uniforms={"x": 1}), *p.order[1:]))),
    "a producer culled": ("culled", lambda p: without_step(p, "ao.0")),
    "a modifier culled": ("culled", lambda p: without_step(p, "glow.0")),
    "an output culled": ("culled", lambda p: without_step(p, "tone.1")),
    "history's source culled": (
        "culled",
        lambda p: replace(without_step(without_step(p, "tone.0"), "blend.0"), graph=replace(p.graph, outputs=("hdr",))),
    ),
    "a kept pass culled": (
        "culled",
        lambda p: replace(
            p, graph=replace(p.graph, passes={**p.graph.passes, "dead": replace(p.graph.passes["dead"], keep=True)})
        ),
    ),
    "live tenants share a slot": ("memory", lambda p: merged(p, "normal", "ao")),
    "view across classes": ("memory", lambda p: merged(p, "depth", "ldr")),
    "history pooled": ("memory", lambda p: pooled(p, "last")),
    "output pooled": ("memory", lambda p: pooled(p, "out")),
    "history's source pooled": (
        "memory",
        lambda p: pooled(replace(p, graph=kinds(p.graph, taa=Kind.TRANSIENT)), "taa"),
    ),
    "no slot at all": ("memory", lambda p: replace(p, slot_of={k: v for k, v in p.slot_of.items() if k != "ao"})),
    "live buffers overlap": ("memory", moved_buffer),
    "a buffer beyond the heap": ("memory", lambda p: replace(p, heap_bytes=256)),
    "a false lifetime": ("memory", lambda p: replace(p, lifetimes={**p.lifetimes, "depth": Lifetime(0, 1)})),
    "a false sum": ("memory", lambda p: replace(p, totals=replace(p.totals, load=p.totals.load - 1))),
    "load above used": ("memory", lambda p: replace(p, totals=replace(p.totals, used=0))),
    "barriers dropped": ("barrier", lambda p: replace(p, barriers=())),
    "barriers too early": (
        "barrier",
        lambda p: replace(p, barriers=tuple(replace(b, index=max(0, b.index - 1)) for b in p.barriers[-1:])),
    ),
    "a barrier without cause": (
        "barrier",
        lambda p: replace(p, barriers=(replace(p.barriers[0], hazards=()), *p.barriers[1:])),
    ),
}


def test_the_plan_is_sound() -> None:
    assert verify(PLAN) == ()
    assert PLAN.barriers
    assert PLAN.culled == ("dead.0",)


@pytest.mark.parametrize("fault", FAULTS)
def test_planted_faults_are_found(fault: str) -> None:
    word, plant = FAULTS[fault]
    assert any(found.startswith(word) for found in verify(plant(PLAN))), verify(plant(PLAN))


def test_each_bit_is_missed() -> None:
    for number, barrier in enumerate(PLAN.barriers):
        for bit in (1 << k for k in range(16) if barrier.bits >> k & 1):
            poorer = replace(barrier, bits=barrier.bits & ~bit)
            broken = replace(PLAN, barriers=(*PLAN.barriers[:number], poorer, *PLAN.barriers[number + 1 :]))
            assert any(found.startswith("barrier") for found in verify(broken))


def test_a_fault_of_the_planner_is_an_internal_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compile_module, "verify", lambda plan: ("order: planted",))
    with pytest.raises(PlanError, match="planted"):
        compile_plan(frame())


def scratch() -> Plan:
    """One target made anew and read three times over; nothing needs the second reading."""
    rounds = [
        (make_pass(f"make{i}", [writes("scratch")], after=[f"use{i - 1}"] if i else []),
         make_pass(f"use{i}", [reads("scratch"), writes(f"t{i}")], after=[f"make{i}"]))
        for i in range(3)
    ]  # fmt: skip
    last = make_pass("last", [reads("t0"), reads("t2"), writes("out")])
    return compile_plan(make_graph([p for pair in rounds for p in pair] + [last], ["out"]))[0]


def test_who_is_replaced_unread_may_be_culled() -> None:
    plan = scratch()
    assert plan.culled == ("make1.0", "use1.0")
    assert verify(plan) == ()


@pytest.mark.parametrize("needed", ["make0.0", "make2.0"])
def test_who_is_read_before_being_replaced_may_not(needed: str) -> None:
    found = verify(without_step(scratch(), needed))
    assert [fault for fault in found if fault.startswith("culled") and needed.partition(".")[0] in fault]


def test_the_last_word_on_an_output_may_not_be_culled() -> None:
    plan = scratch()
    plan = replace(plan, graph=replace(plan.graph, outputs=("out", "scratch")))
    assert not any(fault.startswith("culled") for fault in verify(plan))
    assert any("last word" in fault for fault in verify(without_step(plan, "make2.0")))
