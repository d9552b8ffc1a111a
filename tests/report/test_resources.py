"""The resources record says what the plan says, and adds up."""

import json

from rendergraph.document.load import load_document
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.resources import resources_record


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
            assert resources[other]["slot"] == entry["slot"]
            assert resources[other]["view_class"] == entry["view_class"]
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
