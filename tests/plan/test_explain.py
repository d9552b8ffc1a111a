"""Every decision has a sentence, every code an explanation, every name of a plan its story."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import pytest

from rendergraph.document.load import load_document, shipped_graphs
from rendergraph.document.messages import MESSAGES, RenderGraphError
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.expand import expand
from rendergraph.plan.explain import SENTENCES, explain_code, explain_decision, explain_subject
from rendergraph.plan.graph import Decision
from rendergraph.plan.plan import Plan, PlanOptions
from rendergraph.scene.features import SceneFeatures

OPTIONS = (
    PlanOptions(),
    PlanOptions(alias=False),
    PlanOptions(cull=False),
    PlanOptions(order="memory", order_budget=5),
    PlanOptions(order="random", seed=3),
)


@cache
def plan(name: str, options: PlanOptions = OPTIONS[0], bare: bool = False) -> Plan:
    """A shipped graph's plan: for a scene with everything, or with nothing."""
    graph, _ = expand(load_document(name), features=SceneFeatures() if bare else None)
    return compile_plan(graph, options)[0]


def decisions() -> Iterator[Decision]:
    """All decisions of all shipped graphs under all options."""
    for name in shipped_graphs():
        for options in OPTIONS:
            yield from plan(name, options).decisions
        yield from plan(name, OPTIONS[0], True).decisions


def test_every_decision_of_the_shipped_graphs_has_a_sentence() -> None:
    seen = {(d.kind, d.reason) for d in decisions()}
    assert seen <= SENTENCES.keys()
    assert {"expand", "order", "alias", "barrier"} <= {kind for kind, _ in seen}
    for decision in decisions():
        sentence = explain_decision(decision)
        assert decision.reason not in sentence
        assert "{" not in sentence


def test_a_sentence_is_chosen_by_the_evidence_there_is() -> None:
    alone = explain_decision(Decision("alias", "overlaps_in_time", "a"))
    named = explain_decision(Decision("alias", "overlaps_in_time", "a", {"with": ["b", "c"]}))
    assert "b and c" in named
    assert alone != named


@pytest.mark.parametrize("node", ["exposure", "fxaa", "tonemap"])
def test_no_sentence_needs_an_article(node: str) -> None:
    text = explain_decision(Decision("expand", "node_expanded", "p", {"node": node, "steps": ["p.draw"]}))
    assert node in text
    assert not {"a", "an"} & set(text.split())


def test_an_unknown_reason_is_shown_as_it_is() -> None:
    sentence = explain_decision(Decision("cull", "moon_phase", "a", {"phase": "new"}))
    assert all(word in sentence for word in ("a", "moon_phase", "phase", "new"))


@pytest.mark.parametrize("code", sorted(MESSAGES))
def test_every_code_is_explained(code: str) -> None:
    text = explain_code(code)
    assert text.startswith(f"{code} ({MESSAGES[code].severity})")
    assert MESSAGES[code].explain in text


def test_unknown_code() -> None:
    with pytest.raises(RenderGraphError) as caught:
        explain_code("RG999")
    assert [d.code for d in caught.value.diagnostics] == ["RG227"]
    assert caught.value.exit_code == 2
    assert "mean" not in caught.value.diagnostics[0].help, "an unrelated code is no help"


def test_subjects() -> None:
    found = plan("clear")
    assert any("count.dispatch" in line and "shader_storage" in line for line in explain_subject(found, "count"))
    assert any("256 bytes" in line for line in explain_subject(found, "bins"))
    assert any("shader_storage" in line for line in explain_subject(found, "bins"))
    assert explain_subject(found, "count.dispatch")
    assert len(explain_subject(found)) == len({id(d) for d in (*found.graph.decisions, *found.decisions)})


@pytest.mark.parametrize("name", ["nobody", "count.nothing", ""])
def test_unknown_subject(name: str) -> None:
    with pytest.raises(RenderGraphError) as caught:
        explain_subject(plan("clear"), name)
    assert [d.code for d in caught.value.diagnostics] == ["RG228"]


def test_a_culled_pass_says_why(tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("culled") / "graph.yaml"
    path.write_text(
        "rendergraph: 1\nresources: {a: {format: r8}}\n"
        "passes: {p: {node: clear, write: {target: a}}, q: {node: clear, write: {target: image}}}\n"
        "outputs: {image: {file: a.png}}\n",
        encoding="utf-8",
    )
    found = compile_plan(expand(load_document(path))[0], PlanOptions())[0]
    assert explain_decision(Decision("cull", "nothing_reads_it", "p", {"writes": ["a"]})) in explain_subject(found, "p")
    assert any("p.clear" in line for line in explain_subject(found, "a"))
