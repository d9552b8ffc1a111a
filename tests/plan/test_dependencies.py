"""Who runs before whom, told from accesses alone; and what is refused."""

from __future__ import annotations

import pytest
from plan_graphs import adds, make_graph, make_pass, reads, texture, writes

from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.graph import Access, BufferDesc, Graph, Kind, Usage
from rendergraph.plan.plan import Plan, PlanOptions


def order_of(graph: Graph, **options: object) -> list[str]:
    return [step.name for step in plan_of(graph, **options).order]


def plan_of(graph: Graph, **options: object) -> Plan:
    return compile_plan(graph, PlanOptions(**options))[0]  # type: ignore[arg-type]


def refused(graph: Graph) -> list[str]:
    with pytest.raises(RenderGraphError) as caught:
        compile_plan(graph)
    return [d.code for d in caught.value.diagnostics]


def test_writer_comes_before_reader_whatever_the_file_says() -> None:
    graph = make_graph([make_pass("a", [reads("x"), writes("out")]), make_pass("b", [writes("x")])], ["out"])
    assert order_of(graph) == ["b.0", "a.0"]


def test_the_definer_comes_before_modifiers_and_readers_see_the_last() -> None:
    graph = make_graph(
        [
            make_pass("add", [adds("x")]),
            make_pass("read", [reads("x"), writes("out")]),
            make_pass("define", [writes("x")]),
        ],
        ["out"],
    )
    assert order_of(graph) == ["define.0", "add.0", "read.0"]


def test_two_modifiers_need_an_order() -> None:
    define, one, two = make_pass("d", [writes("x")]), make_pass("one", [adds("x")]), make_pass("two", [adds("x")])
    assert refused(make_graph([define, one, two], ["x"])) == ["RG230"]
    stated = make_pass("one", [adds("x")], after=["two"])
    assert order_of(make_graph([define, stated, two], ["x"])) == ["d.0", "two.0", "one.0"]


def test_two_writers_without_order_are_named_with_the_resource() -> None:
    graph = make_graph([make_pass("a", [writes("x")], line=4), make_pass("b", [writes("x")], line=9)], ["x"])
    with pytest.raises(RenderGraphError) as caught:
        compile_plan(graph)
    (found,) = caught.value.diagnostics
    assert (found.code, found.data["first"], found.data["second"], found.data["resource"]) == ("RG230", "a", "b", "x")
    assert found.position is not None
    assert found.position.line == 9


def test_other_data_orders_modifiers() -> None:
    graph = make_graph(
        [
            make_pass("z", [adds("x"), writes("flag")]),
            make_pass("a", [reads("flag"), adds("x")]),
            make_pass("define", [writes("x")]),
        ],
        ["x"],
    )
    assert order_of(graph) == ["define.0", "z.0", "a.0"]


def test_an_order_found_in_one_resource_decides_another() -> None:
    # z orders the writers of y. Only then is it known that `third`, which reads y, runs after `second`; and with that,
    # that of the two modifiers of x `second` comes first.
    graph = make_graph(
        [
            make_pass("define", [writes("x"), writes("y")]),
            make_pass("first", [adds("y"), writes("z")]),
            make_pass("second", [adds("y"), reads("z"), adds("x")]),
            make_pass("third", [reads("y"), adds("x")]),
        ],
        ["x"],
    )
    assert order_of(graph) == ["define.0", "first.0", "second.0", "third.0"]


def test_a_reader_bound_before_a_later_writer_sees_the_earlier_content() -> None:
    graph = make_graph(
        [
            make_pass("define", [writes("x")]),
            make_pass("copy", [reads("x"), writes("kept")]),
            make_pass("mix", [reads("kept"), adds("x")]),
        ],
        ["x"],
    )
    plan = plan_of(graph)
    assert [s.name for s in plan.order] == ["define.0", "copy.0", "mix.0"]
    assert any(d.reason == "reads_before_later_writer" and d.subject == "copy" for d in plan.decisions)


def test_a_resource_defined_twice_follows_after() -> None:
    graph = make_graph(
        [
            make_pass("one", [writes("x")]),
            make_pass("use_one", [reads("x"), writes("a")]),
            make_pass("two", [writes("x")], after=["one", "use_one"]),
            make_pass("use_two", [reads("x"), writes("b")]),
        ],
        ["a", "b"],
    )
    assert order_of(graph) == ["one.0", "use_one.0", "two.0", "use_two.0"]


def test_culling_between_two_accesses_keeps_their_order() -> None:
    # The modifier in the middle dies; the reader before it must still run before the writer after it.
    for seed in range(20):
        graph = make_graph(
            [
                make_pass("define", [writes("x")]),
                make_pass("p", [reads("x"), writes("a")], [adds("x")], [writes("x")]),
                make_pass("end", [reads("x"), reads("a"), writes("out")]),
            ],
            ["out"],
        )
        plan = plan_of(graph, order="random", seed=seed)
        assert plan.culled == ("p.1",)
        names = [s.name for s in plan.order]
        assert names.index("p.0") < names.index("p.2")


def test_steps_of_one_pass_keep_program_order_per_resource() -> None:
    chain = [[writes("m", mip=0)], *([reads("m", mip=i - 1), writes("m", mip=i)] for i in range(1, 4))]
    graph = make_graph(
        [make_pass("chain", *chain), make_pass("use", [reads("m"), writes("out")])],
        ["out"],
        descs={"m": texture(mips=4)},
    )
    for seed in range(5):
        assert order_of(graph, order="random", seed=seed) == ["chain.0", "chain.1", "chain.2", "chain.3", "use.0"]


def test_disjoint_layers_have_independent_writers() -> None:
    graph = make_graph(
        [
            make_pass("a", [writes("s", "depth", layer=0)]),
            make_pass("b", [writes("s", "depth", layer=1)]),
            make_pass("use", [reads("s"), writes("out")]),
        ],
        ["out"],
        descs={"s": texture("d32f", layers=2)},
    )
    assert order_of(graph)[-1] == "use.0"


@pytest.mark.parametrize(
    ("graph", "codes"),
    [
        (make_graph([make_pass("a", [reads("x"), writes("out")])], ["out"]), ["RG231"]),
        (make_graph([make_pass("a", [adds("x")])], ["x"]), ["RG232"]),
        (
            make_graph(
                [
                    make_pass("r", [reads("x"), writes("out")]),
                    make_pass("one", [writes("x")], after=["r"]),
                    make_pass("two", [writes("x")], after=["one"]),
                ],
                ["out"],
            ),
            ["RG237"],
        ),
        (make_graph([make_pass("a", [writes("x")])], ["x", "nobody"]), ["RG234"]),
        (
            make_graph([make_pass("a", [reads("h"), writes("out")])], ["out"], history={"h": "x"}),
            ["RG235"],
        ),
        (
            make_graph([make_pass("a", [writes("x")], [writes("h")])], ["x"], history={"h": "x"}),
            ["RG236"],
        ),
        (
            make_graph([make_pass("a", [writes("photo"), writes("x")])], ["x"], kinds={"photo": Kind.IMPORTED}),
            ["RG236"],
        ),
        (
            make_graph(
                [
                    make_pass("a", [reads("x"), writes("out")]),
                    make_pass("b", [writes("y")]),
                    make_pass("c", [writes("y")]),
                ],
                ["out", "y"],
            ),
            ["RG230", "RG231"],
        ),
    ],
    ids=["undefined", "blend", "before", "output", "history", "write-history", "write-imported", "all-at-once"],
)
def test_mistakes_are_refused_by_code(graph: Graph, codes: list[str]) -> None:
    assert refused(graph) == codes


def test_history_and_imported_resources_need_no_writer() -> None:
    graph = make_graph(
        [make_pass("a", [reads("last"), reads("photo"), writes("x")])],
        ["x"],
        history={"last": "x"},
        kinds={"photo": Kind.IMPORTED},
    )
    assert order_of(graph) == ["a.0"]


def test_a_cycle_is_shown_as_a_path() -> None:
    graph = make_graph(
        [
            make_pass("c", [reads("b"), writes("c")]),
            make_pass("a", [reads("c"), writes("a")]),
            make_pass("b", [reads("a"), writes("b")]),
            make_pass("far", [reads("b"), writes("out")]),
        ],
        ["out"],
    )
    with pytest.raises(RenderGraphError) as caught:
        compile_plan(graph)
    (found,) = caught.value.diagnostics
    assert found.code == "RG233"
    assert found.data["passes"] == ["a", "b", "c"]
    for resource in ("a", "b", "c"):
        assert f"by {resource}" in found.data["steps"]


def test_waiting_for_itself_is_a_cycle() -> None:
    graph = make_graph([make_pass("a", [writes("x")], after=["a"])], ["x"])
    assert refused(graph) == ["RG233"]


def test_a_pass_is_one_unit_in_a_cycle() -> None:
    graph = make_graph(
        [
            make_pass("a", [writes("x")], [reads("y"), writes("out")]),
            make_pass("b", [reads("x"), writes("y")]),
        ],
        ["out"],
    )
    assert refused(graph) == ["RG233"]


def test_after_orders_what_no_data_orders() -> None:
    passes = [make_pass("a", [writes("x")], after=["b"]), make_pass("b", [writes("y")], [writes("z")])]
    for seed in range(5):
        names = order_of(make_graph(passes, ["x", "y", "z"]), order="random", seed=seed)
        assert names[-1] == "a.0"


def test_an_unknown_order_is_refused() -> None:
    with pytest.raises(ValueError, match="sideways"):
        compile_plan(make_graph([make_pass("a", [writes("x")])], ["x"]), PlanOptions(order="sideways"))


def test_random_orders_differ_and_are_repeatable() -> None:
    graph = make_graph([make_pass(name, [writes(name)]) for name in "abcdef"], list("abcdef"))
    orders = {tuple(order_of(graph, order="random", seed=seed)) for seed in range(40)}
    assert len(orders) > 20
    assert order_of(graph, order="random", seed=7) == order_of(graph, order="random", seed=7)


def test_default_order_keeps_producers_close_to_consumers() -> None:
    # Two independent chains: each is run to its end, not level by level.
    passes = [
        make_pass("a1", [writes("a1")]),
        make_pass("a2", [reads("a1"), writes("a2")]),
        make_pass("b1", [writes("b1")]),
        make_pass("b2", [reads("b1"), writes("b2")]),
        make_pass("mix", [reads("a2"), reads("b2"), writes("out")]),
    ]
    assert order_of(make_graph(passes, ["out"])) == ["a1.0", "a2.0", "b1.0", "b2.0", "mix.0"]


def test_memory_order_finds_the_smaller_peak() -> None:
    # Big temporaries reduced to small results: the best order finishes one reduction before it starts the next.
    big, small = texture("rgba32f", 64), texture("r8", 8)
    passes = [make_pass("mix", [*(reads(f"s{i}") for i in range(4)), writes("out")])]
    descs = {}
    for i in range(4):
        descs |= {f"b{i}": big, f"s{i}": small}
        passes.append(make_pass(f"make{i}", [writes(f"b{i}")]))
        passes.append(make_pass(f"reduce{i}", [reads(f"b{i}"), writes(f"s{i}")]))
        passes.append(make_pass(f"zz{i}", [reads(f"b{i}"), reads(f"s{3 - i}"), writes(f"t{i}")], keep=True))
    graph = make_graph(passes, ["out"], descs=descs)
    default, searched = plan_of(graph), plan_of(graph, order="memory", order_budget=200)
    assert searched.totals.load <= default.totals.load
    worst = max(plan_of(graph, order="random", seed=seed).totals.load for seed in range(10))
    assert searched.totals.load < worst


def test_stores_to_a_buffer_flow_like_any_write() -> None:
    graph = make_graph(
        [
            make_pass("draw", [reads("args", "indirect"), writes("out")]),
            make_pass("count", [Access("args", Usage.CLEAR, load=False)], [adds("args", "storage_update")]),
        ],
        ["out"],
        descs={"args": BufferDesc(64)},
    )
    assert order_of(graph) == ["count.0", "count.1", "draw.0"]
