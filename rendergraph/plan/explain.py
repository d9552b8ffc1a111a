"""Decisions and codes in sentences: `rg explain`. Every reason a phase may give has its row here."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from string import Formatter
from typing import Any, Final

from rendergraph.document.messages import MESSAGES, RenderGraphError, diagnose
from rendergraph.document.suggest import did_you_mean
from rendergraph.plan.graph import BufferDesc, Decision, Resource, TextureDesc
from rendergraph.plan.plan import Plan

#: (kind, reason) to sentences; the first whose evidence is all there is used.
SENTENCES: Final[Mapping[tuple[str, str], tuple[str, ...]]] = {
    ("expand", "node_expanded"): ("{subject}, of node {node}, became {steps}",),
    ("expand", "output_undeclared"): (
        "{subject} is not declared: it is a frame-sized texture of format {format}, by {from}",
    ),
    ("expand", "kept_for_history"): ("{subject} is kept to the next frame, where {history} shows it",),
    ("expand", "kept_for_output"): ("{subject} is kept to the end of the frame, to be written to {file}",),
    ("specialise", "scene_lacks_feature"): ("{subject} is left out or simplified: the scene has no {feature}",),
    ("specialise", "none_in_view"): ("{subject} is left out or simplified: nothing {feature} comes into view",),
    ("specialise", "no_light_reaches_the_view"): (
        "{subject} leaves out local lights: none of the {lights} reaches what is in view",
    ),
    ("specialise", "nothing_casts_into_view"): (
        "{subject} is left out: nothing solid stands between the sun and what is in view",
    ),
    ("specialise", "shadows_end_before_the_view"): (
        "{subject} is left out: shadows end at {distance} m, and all in view is beyond {nearest} m",
    ),
    ("specialise", "scene_covers_the_frame"): ("{subject} is left out: opaque geometry covers the whole frame",),
    ("specialise", "format_narrowed"): (
        "{subject} is {to} in place of {from}, without loss: {by} has nothing more to put into it, {saved} bytes less",
    ),
    ("specialise", "pass_left_out"): ("{subject} is left out whole: it has nothing to do in this scene ({because})",),
    ("cull", "writes_nothing"): ("{subject} is culled: it writes nothing",),
    ("cull", "nothing_reads_it"): ("{subject} is culled: nothing reads {writes}, and it is no output",),
    ("cull", "overwritten_before_read"): (
        "{subject} is culled: {overwritten_by} overwrites {writes} before anything reads it",
    ),
    ("cull", "no_reader_reaches_an_output"): (
        "{subject} is culled: {writes} is read by {readers} alone, and none of it reaches an output",
    ),
    ("cull", "unused"): ("{subject} is not allocated: no pass touches it",),
    ("cull", "only_culled_passes_use_it"): ("{subject} is not allocated: only {by} used it, and is culled",),
    ("order", "depth_first_from_outputs"): ("the order is depth first from the outputs, ties broken by name",),
    ("order", "random_legal_order"): ("the order is a random legal one, from seed {seed}",),
    ("order", "as_listed"): ("the order is the one listed",),
    ("order", "memory_search_improved"): (
        "the order was searched for memory: {trials} trials lowered the peak from {load_before} to {load} bytes",
    ),
    ("order", "memory_search_found_no_better"): (
        "the order was searched for memory: {trials} trials found none below {load} bytes",
    ),
    ("order", "writers_in_order"): ("{subject} is written more than once, in this order: {writers}",),
    ("order", "reads_before_later_writer"): ("{subject} reads {resource} before {before} writes it again",),
    ("alias", "shares_slot"): ("{subject} shares texture slot {slot} with {with}: they are never live at once",),
    ("alias", "shares_heap_range"): ("{subject} shares bytes of the buffer heap with {with}",),
    ("alias", "only_one_in_class"): ("{subject} shares nothing: no other transient resource is of its class",),
    ("alias", "overlaps_in_time"): (
        "{subject} shares nothing: it is live together with {with}",
        "{subject} shares nothing: it is live together with all it could share with",
    ),
    ("alias", "sharing_saves_nothing"): ("{subject} shares nothing: sharing would not make the buffer heap smaller",),
    ("alias", "aliasing_off"): ("{subject} shares nothing: sharing is switched off",),
    ("alias", "never_pooled_persistent"): ("{subject} shares nothing: its content is needed after the frame",),
    ("alias", "never_pooled_history"): ("{subject} shares nothing: it holds last frame's {previous_of}",),
    ("alias", "never_pooled_imported"): ("{subject} shares nothing: it is read from a file once",),
    ("barrier", "incoherent_access"): (
        "a {kind} barrier stands before {subject}: {earlier} stored into {resource}, which {later} uses",
    ),
    ("barrier", "shared_storage"): (
        "a {kind} barrier stands before {subject}: {later} uses {resource} in memory where {earlier} stored "
        "{previous_resource}",
    ),
    ("barrier", "feedback_loop"): (
        "a texture barrier stands before {subject}: {later} samples {resource} while {earlier} rendered to it",
    ),
}

#: What a kind of decision is about, in the order a reader asks.
_KINDS: Final = ("expand", "specialise", "cull", "order", "alias", "barrier")


def explain_decision(decision: Decision) -> str:
    """One sentence. A reason without a row (of another package's node) is shown as it is."""
    values = {key: _listed(value) for key, value in decision.evidence.items()} | {"subject": decision.subject}
    for sentence in SENTENCES.get((decision.kind, decision.reason), ()):
        if all(field in values for _, field, _, _ in Formatter().parse(sentence) if field):
            return sentence.format(**values)
    evidence = ", ".join(f"{key}: {_listed(value)}" for key, value in decision.evidence.items())
    return f"{decision.subject}: {decision.kind}, {decision.reason}" + (f" ({evidence})" if evidence else "")


def explain_code(code: str) -> str:
    """What a diagnostic's code means, in a few lines. Raises ``RenderGraphError`` (RG227) for an unknown one."""
    if code not in MESSAGES:
        raise RenderGraphError([diagnose("RG227", name=code)], exit_code=2)
    message = MESSAGES[code]
    lines = [f"{code} ({message.severity}): {_template(message.text)}", f"help: {_template(message.help)}"]
    return "\n".join([*lines, "", message.explain] if message.explain else lines)


def all_decisions(plan: Plan) -> list[Decision]:
    """Those of expansion and of every planning phase, in the order a reader asks."""
    counted = {id(decision) for decision in plan.decisions}
    decisions = [*(d for d in plan.graph.decisions if id(d) not in counted), *plan.decisions]
    return sorted(decisions, key=lambda d: _KINDS.index(d.kind) if d.kind in _KINDS else len(_KINDS))


def explain_subject(plan: Plan, name: str | None = None) -> list[str]:
    """Sentences on a pass, sub-pass or resource: what became of it and why; on the whole plan without a name.

    Raises ``RenderGraphError`` (RG228) for a name the graph does not have.
    """
    graph = plan.graph
    decisions = all_decisions(plan)
    if name is None:
        return [explain_decision(decision) for decision in decisions]
    steps = {step.name for found in graph.passes.values() for step in found.subpasses}
    if name in graph.resources:
        facts = _resource_facts(plan, graph.resources[name])
    elif name in graph.passes or name in steps:
        facts = _step_facts(plan, name)
    else:
        known = [*graph.resources, *graph.passes, *steps]
        raise RenderGraphError([diagnose("RG228", name=name, hint=did_you_mean(name, known))], exit_code=2)
    return [*facts, *(explain_decision(d) for d in decisions if _is_about(d, name))]


def _is_about(decision: Decision, name: str) -> bool:
    """Whether it concerns the name: as its subject, a step of it, or the resource a barrier is for."""
    evidence = decision.evidence
    return (
        decision.subject == name
        or decision.subject.startswith(f"{name}.")
        or (decision.kind == "barrier" and name in (evidence.get("resource"), evidence.get("previous_resource")))
    )


def _step_facts(plan: Plan, name: str) -> list[str]:
    runs = [
        f"{step.name} runs as number {number} of {len(plan.order)}"
        for number, step in enumerate(plan.order, 1)
        if name in (step.name, step.parent)
    ]
    return runs or [f"{name} does not run"]


def _resource_facts(plan: Plan, resource: Resource) -> list[str]:
    desc, life = resource.desc, plan.lifetimes.get(resource.name)
    facts = [f"{resource.name} is a {resource.kind.value} {_described(desc)}, {desc.bytes} bytes"]
    if life is not None and plan.order:
        first, last = plan.order[life.first].name, plan.order[life.last].name
        facts.append(f"{resource.name} is in use from {first} (number {life.first + 1}) to {last} ({life.last + 1})")
    if resource.name in plan.totals.peak:
        facts.append(f"{resource.name} is live where memory use peaks")
    return facts


def _described(desc: TextureDesc | BufferDesc) -> str:
    if isinstance(desc, BufferDesc):
        return "buffer"
    parts = [f"texture of {desc.width} x {desc.height} texels of {desc.format}"]
    parts += [f"{count} {what}" for count, what in ((desc.layers, "layers"), (desc.mips, "mip levels")) if count > 1]
    return ", ".join(parts + ([f"{desc.samples} samples a texel"] if desc.samples > 1 else []))


def _listed(value: Any) -> str:
    if isinstance(value, str) or not isinstance(value, Iterable):
        return str(value)
    words = [str(item) for item in value]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else "nothing"


def _template(text: str) -> str:
    """A template for reading: ``{name}`` becomes ``NAME``."""
    parts = Formatter().parse(text)
    return "".join(literal + (field.upper() if field else "") for literal, field, _, _ in parts)
