"""The resources record says what the plan says, and adds up."""

import json
from pathlib import Path

from rendergraph.document.load import load_document
from rendergraph.plan.barriers import BITS
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.memory_advice import advise
from rendergraph.report.resources import BARRIER_BITS, resources_record
from tests.cli.refusal import write_graph


def record(**options: object) -> dict:  # type: ignore[type-arg]
    """The demo graph's record."""
    plan, _ = plan_without_scene(load_document("deferred_shading"), PlanOptions(**options))  # type: ignore[arg-type]
    return resources_record(plan, "title")


def test_it_is_plain_json() -> None:
    made = record()
    assert json.loads(json.dumps(made, allow_nan=False)) == made


def test_totals_are_ordered_and_add_up() -> None:
    made = record()
    totals = made["totals"]
    assert totals["load"] <= totals["placed"] <= totals["unshared"]
    assert totals["load"] <= totals["view_pool"] <= totals["exact_pool"] <= totals["unshared"]
    transient = [r for r in made["resources"] if r["kind"] == "transient"]
    padded = [-(-r["bytes"] // 256) * 256 if "buffer" in r["desc"] else r["bytes"] for r in transient]
    assert sum(padded) == totals["unshared"]  # buffers start at multiples of 256 bytes
    assert sum(s["bytes"] for s in made["slots"]) + made["heap_bytes"] >= totals["used"]


def test_who_shares_with_whom_is_mutual() -> None:
    resources = {r["name"]: r for r in record()["resources"]}
    sharing = [r for r in resources.values() if r.get("shares_with")]
    assert sharing
    for entry in sharing:
        for other in entry["shares_with"]:
            assert entry["name"] in resources[other]["shares_with"]
            assert entry["sharing"]["reason"] == ("shares_slot" if "slot" in entry else "shares_heap_range")
            assert resources[other].get("slot") == entry.get("slot")
            assert resources[other].get("view_class") == entry.get("view_class")
            if "offset" in entry:
                pair = entry, resources[other]
                assert max(r["offset"] for r in pair) < min(r["offset"] + r["bytes"] for r in pair)
            apart = entry["last_index"] < resources[other]["first_index"]
            assert apart or resources[other]["last_index"] < entry["first_index"]


def test_without_aliasing_nothing_is_shared() -> None:
    made = record(alias=False)
    assert made["totals"]["used"] >= record()["totals"]["used"]
    assert not any(r.get("shares_with") for r in made["resources"])


def test_barriers_name_their_hazards() -> None:
    barriers = record()["barriers"]
    assert {h["kind"] for b in barriers for h in b["hazards"]} >= {"shader_storage"}
    assert all(b["bits"] or b["texture_barrier"] for b in barriers)


def test_every_resource_says_why_it_shares_or_not() -> None:
    for options in ({}, {"alias": False}):
        for entry in record(**options)["resources"]:
            assert entry["sharing"]["why"].startswith(entry["name"])
            assert bool(entry["shares_with"]) == entry["sharing"]["reason"].startswith("shares_")


def test_the_peak_holds_what_is_live_there() -> None:
    made = record()
    peak, live = made["peak"], made["live_bytes"]
    assert len(live) == len(made["order"])
    assert max(live) == live[peak["index"]] == peak["bytes"] == made["totals"]["load"]
    assert peak["subpass"] == made["order"][peak["index"]]
    assert {h["name"] for h in peak["resources"]} == set(made["totals"]["peak"])
    assert sum(h["bytes"] for h in peak["resources"]) == peak["bytes"]
    sizes = [h["bytes"] for h in peak["resources"]]
    assert sizes == sorted(sizes, reverse=True)


def test_barrier_bits_are_spelled_out_and_reasoned() -> None:
    barriers = record()["barriers"]
    assert {n for b in barriers for n in b["names"]} >= {"GL_SHADER_STORAGE_BARRIER_BIT"}
    numbers = {name: bit for bit, name in BARRIER_BITS.items()}
    for barrier in barriers:
        assert sum(numbers[name] for name in barrier["names"]) == barrier["bits"]
        assert {r["kind"] for r in barrier["reasons"]} == {h["kind"] for h in barrier["hazards"]}
    assert set(BARRIER_BITS) == {bit for bit in BITS.values() if bit}


def test_objects_created_per_frame() -> None:
    plan, _ = plan_without_scene(load_document("exposure"), PlanOptions())
    assert resources_record(plan)["objects_created"] == {"frames": 0, "objects": 0, "per_frame": None}
    created = resources_record(plan, created=(4, 2))["objects_created"]
    assert created == {"frames": 4, "objects": 2, "per_frame": 0.5}


def test_a_plan_without_transients_has_no_peak(tmp_path: Path) -> None:
    path = write_graph(
        tmp_path, passes="  paint: {node: fullscreen, write: {o_color: image}, set: {shader: paint.frag}}\n"
    )
    plan, _ = plan_without_scene(load_document(path), PlanOptions())
    made = resources_record(plan, advice=advise(load_document(path), plan))
    assert (made["peak"], made["advice"], made["live_bytes"]) == (None, [], [0])
