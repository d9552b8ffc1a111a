"""What does not run, and the reason given."""

from __future__ import annotations

from plan_graphs import adds, make_graph, make_pass, reads, writes

from rendergraph.plan.compile import compile_plan
from rendergraph.plan.graph import Graph, Kind
from rendergraph.plan.plan import PlanOptions


def culled(graph: Graph) -> dict[str, str]:
    plan, _ = compile_plan(graph)
    return {d.subject: d.reason for d in plan.decisions if d.kind == "cull"}


BASE = make_pass("base", [writes("x")])


def test_a_pass_that_nobody_reads() -> None:
    graph = make_graph([BASE, make_pass("dead", [reads("x"), writes("y")])], ["x"])
    assert culled(graph) == {"dead": "nothing_reads_it", "dead.0": "nothing_reads_it", "y": "only_culled_passes_use_it"}
    plan, notes = compile_plan(graph)
    assert plan.culled == ("dead.0",)
    assert [(n.code, n.severity, n.data["name"]) for n in notes] == [("RG239", "note", "dead")]


def test_a_chain_names_the_reader_that_would_have_kept_it() -> None:
    graph = make_graph(
        [BASE, make_pass("one", [writes("a")]), make_pass("two", [reads("a"), writes("b")])],
        ["x"],
    )
    plan, _ = compile_plan(graph)
    found = {d.subject: d for d in plan.decisions if d.kind == "cull"}
    assert found["one"].reason == "no_reader_reaches_an_output"
    assert found["one"].evidence["readers"] == ["two.0"]
    assert found["two"].reason == "nothing_reads_it"


def test_content_that_is_overwritten_unread() -> None:
    graph = make_graph([BASE, make_pass("again", [writes("x")], after=["base"])], ["x"])
    plan, _ = compile_plan(graph)
    found = {d.subject: d for d in plan.decisions if d.kind == "cull"}
    assert found["base"].reason == "overwritten_before_read"
    assert found["base"].evidence["overwritten_by"] == ["again.0"]


def test_a_pass_that_writes_nothing() -> None:
    assert culled(make_graph([BASE, make_pass("look", [reads("x")])], ["x"]))["look"] == "writes_nothing"


def test_single_steps_are_culled() -> None:
    graph = make_graph([make_pass("p", [writes("x")], [writes("debug")])], ["x"])
    assert culled(graph) == {"p.1": "nothing_reads_it", "debug": "only_culled_passes_use_it"}
    _, notes = compile_plan(graph)
    assert notes == ()


def test_a_modifier_keeps_its_definer_alive() -> None:
    graph = make_graph([BASE, make_pass("add", [adds("x")])], ["x"])
    assert culled(graph) == {}


def test_a_modifier_after_the_last_reader_is_culled() -> None:
    graph = make_graph(
        [BASE, make_pass("r", [reads("x"), writes("out")]), make_pass("m", [adds("x")], after=["r"])], ["out"]
    )
    assert culled(graph) == {"m": "nothing_reads_it", "m.0": "nothing_reads_it"}


def test_keep_opts_out_with_all_that_it_reads() -> None:
    graph = make_graph(
        [BASE, make_pass("feed", [writes("f")]), make_pass("kept", [reads("f"), writes("y")], keep=True)], ["x"]
    )
    assert culled(graph) == {}


def test_history_in_use_keeps_its_source_alive() -> None:
    graph = make_graph(
        [make_pass("blend", [reads("last"), writes("out")]), make_pass("store", [writes("x")])],
        ["out"],
        history={"last": "x"},
    )
    assert culled(graph) == {}
    unread = make_graph(
        [make_pass("blend", [writes("out")]), make_pass("store", [writes("x")])], ["out"], history={"last": "x"}
    )
    assert culled(unread)["store"] == "nothing_reads_it"


def test_an_output_that_is_history_or_a_file_needs_no_pass() -> None:
    graph = make_graph(
        [make_pass("store", [writes("x")])], ["last", "photo"], history={"last": "x"}, kinds={"photo": Kind.IMPORTED}
    )
    plan, _ = compile_plan(graph)
    assert [step.name for step in plan.order] == ["store.0"]
    assert (plan.lifetimes["last"].last, plan.lifetimes["photo"].last) == (0, 0)


def test_a_resource_that_nothing_touches_is_unused() -> None:
    graph = make_graph([BASE], ["x"], history={"spare": "x"})
    assert culled(graph) == {"spare": "unused"}


def test_no_cull_keeps_all() -> None:
    graph = make_graph([BASE, make_pass("dead", [writes("y")])], ["x"])
    plan, notes = compile_plan(graph, PlanOptions(cull=False))
    assert len(plan.order) == 2
    assert plan.culled == ()
    assert notes == ()
