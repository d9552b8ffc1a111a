"""Judges the passes of a planned graph: runs it, looks at each pass as it runs, and holds it against its reference."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from rendergraph.device.context import Device
from rendergraph.device.includes import preprocess
from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.suggest import did_you_mean
from rendergraph.measure.truth.cache import TruthCache
from rendergraph.measure.truth.fingerprint import fingerprint
from rendergraph.measure.truth.invariants import broken_invariants
from rendergraph.measure.truth.judge import judge_pass, why_not_judged
from rendergraph.measure.truth.judgement import Judgement
from rendergraph.measure.truth.observe import observe, observe_frames
from rendergraph.measure.truth.stochastic import FRAMES, judge_frames
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import PassRun
from rendergraph.plan.graph import TextureDesc
from rendergraph.plan.plan import Plan
from rendergraph.run.plan_document import PlannedDocument

Progress = Callable[[str, int, int], None]

#: Bytes of decoded texels that are held at once: passes beyond are looked at in another run of the graph.
_HELD: Final = 1 << 30


@dataclass(frozen=True, slots=True)
class PassAccuracy:
    """A pass that was judged, its ``judgements`` and the invariants it breaks, in words (``broken``); or why it was not
    judged (``reason``).
    """

    name: str
    node: str
    judgements: tuple[Judgement, ...] = ()
    broken: tuple[str, ...] = ()
    reason: str = ""


def judge_graph(
    document: Document,
    planned: PlannedDocument,
    device: Device,
    passes: Sequence[str] = (),
    *,
    cache: TruthCache | None = None,
    flip: bool = True,
    show: Callable[[Judgement], None] | None = None,
    progress: Progress = lambda stage, done, total: None,
) -> tuple[PassAccuracy, ...]:
    """Judge the passes named (none: all) in the graph's last frame, in execution order; a stochastic node's in
    that and the frames after it. Those that did not run, or have no reference, say so.

    ``show`` is called with every judgement while its pictures are there; they are dropped after that (but a random
    pass's), so that a large graph needs no more memory than its largest passes. Without it they are kept.

    :raises RenderGraphError: RG746 for a name that is no pass; as
        :func:`~rendergraph.measure.truth.judge.judge_pass` and for every error of the run.
    """
    require_passes(document, passes)
    ran = list(dict.fromkeys(subpass.parent for subpass in planned.plan.order))
    wanted = [name for name in [*ran, *document.model.passes] if not passes or name in passes]
    reasons = {name: _why_not(document, name, ran) for name in dict.fromkeys(wanted)}
    judged = [name for name, reason in reasons.items() if not reason]
    content = run_content(planned, device) if judged else ""
    found: dict[str, PassAccuracy] = {}
    for batch in _batches(document, planned.plan, judged):
        for name, run in observe(document, planned, device, batch).items():
            progress(f"judging {name}", len(found), len(judged))
            judged_pass = _judge(document, planned, device, name, rooted(run, content), cache, flip)
            found[name] = _shown(judged_pass, show) if show is not None else judged_pass
    return tuple(
        found.get(name, PassAccuracy(name, document.model.passes[name].node, reason=reason))
        for name, reason in reasons.items()
    )


def require_passes(document: Document, passes: Iterable[str]) -> None:
    """Raise RenderGraphError RG746 for a name that is no pass of the document."""
    for name in passes:
        if name not in document.model.passes:
            hint = did_you_mean(name, document.model.passes, "passes: {choices}")
            raise RenderGraphError([diagnose("RG746", name=name, hint=hint)], exit_code=2)


def _why_not(document: Document, name: str, ran: Sequence[str]) -> str:
    if name not in ran:
        return "the pass does not run: `rg explain` tells why it was left out"
    return why_not_judged(find_node(document.model.passes[name].node))


def _judge(
    document: Document,
    planned: PlannedDocument,
    device: Device,
    name: str,
    run: PassRun,
    cache: TruthCache | None,
    flip: bool,
) -> PassAccuracy:
    node = find_node(document.model.passes[name].node)
    broken = broken_invariants(name, node, run)
    reason = why_not_judged(node, run)  # what only this pass's own files tell
    if reason:
        return PassAccuracy(name, node.name, (), broken, reason)
    if node.reference is not None and node.reference.stochastic:
        runs = (rooted(r[name], "") for r in observe_frames(document, planned, device, [name], FRAMES))
        judgements = judge_frames(name, node, runs, cache, flip=flip)
    else:
        judgements = judge_pass(name, node, run, cache, flip=flip)
    return PassAccuracy(name, node.name, judgements, broken)


# ---- what is held at once


def _shown(entry: PassAccuracy, show: Callable[[Judgement], None]) -> PassAccuracy:
    kept = []
    for judged in entry.judgements:
        show(judged)
        random = judged.pictures is not None and judged.pictures.variance is not None
        kept.append(judged if random else replace(judged, pictures=None))
    return replace(entry, judgements=tuple(kept))


def _batches(document: Document, plan: Plan, passes: Iterable[str]) -> Iterator[list[str]]:
    """The passes in runs that hold no more than ``_HELD`` bytes, at least one each."""
    batch: list[str] = []
    held = 0
    for name in passes:
        model = document.model.passes[name]
        needed = sum(_decoded_bytes(plan, r) for r in (*model.read.values(), *model.write.values()))
        if batch and held + needed > _HELD:
            yield batch
            batch, held = [], 0
        batch.append(name)
        held += needed
    if batch:
        yield batch


def _decoded_bytes(plan: Plan, resource: str) -> int:
    if resource not in plan.graph.resources:
        return 0
    desc = plan.graph.resources[resource].desc
    # float64, four channels at the most.
    return desc.width * desc.height * desc.layers * 32 if isinstance(desc, TextureDesc) else desc.bytes


# ---- what supersampled inputs are rendered from


@dataclass(frozen=True, slots=True)
class RootedInput:
    """``PassRun.supersampled`` with the hash of all that it renders from, for the cache of truths."""

    render: Callable[[str, int], Any]
    content: str

    def __call__(self, port: str, factor: int) -> Any:
        """The input, as the run itself gives it."""
        return self.render(port, factor)


def rooted(run: PassRun, content: str) -> PassRun:
    """The run, its supersampled inputs known to the cache of truths by ``content`` (:func:`run_content`)."""
    if run.supersampled is None or not content:
        return run
    return replace(run, supersampled=RootedInput(run.supersampled, f"{content} {run.index}"))


def run_content(planned: PlannedDocument, device: Device) -> str:
    """SHA-256 of the plan with the text of its shaders, the scene, and the renderer."""
    plan = planned.plan
    texts = []
    for subpass in plan.order:
        for stage, path in subpass.program.stages if subpass.program else ():
            texts.append((stage, preprocess(path, subpass.program.defines if subpass.program else ())[0]))
    steps = [repr(replace(subpass, program=None, position=None)) for subpass in plan.order]
    resources = [repr(plan.graph.resources[name].desc) for name in sorted(plan.graph.resources)]
    paths = [resource.file for resource in plan.graph.resources.values() if resource.file is not None]
    files = [hashlib.sha256(path.read_bytes()).hexdigest() for path in paths]
    scene = fingerprint(planned.scene.scene) if planned.scene else ""
    return fingerprint(
        [texts, steps, resources, files, scene, plan.graph.frame, device.info.renderer, device.info.driver]
    )
