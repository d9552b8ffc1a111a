"""Runs a target at one extreme and checks every pass. Nothing that goes wrong in it gets out."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from rendergraph.device.context import Device
from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.stress import checks
from rendergraph.measure.stress.case import CHECKS, Case
from rendergraph.measure.stress.inject import inject, injectable
from rendergraph.measure.stress.outcome import CaseOutcome, CaseState, Failure, PassOutcome, PassStatus
from rendergraph.measure.stress.target import MOST_FRAMES, StressTarget, frame_size, load_target
from rendergraph.measure.stress.texels import finite_inputs
from rendergraph.measure.truth.cache import TruthCache
from rendergraph.measure.truth.observe import watch_frame
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import PassRun
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import PlannedDocument, load_document_scene, plan_for_scene
from rendergraph.run.render import frame_cameras
from rendergraph.run.runner import Runner
from rendergraph.scene.load import LoadedScene

_BROKEN_REFERENCE: Final = "RG744"


@dataclass
class Bench:
    """Tries extremes of one target one after another. ``size`` is the frame's where the extreme does not set it."""

    target: StressTarget
    overrides: tuple[str, ...]
    size: tuple[int, int] | None
    device: Device
    cache: TruthCache | None = None

    def __post_init__(self) -> None:
        self._scenes: dict[str, LoadedScene | None] = {}

    def attempt(self, case: Case) -> CaseOutcome:
        """Run one extreme. Whatever it ends with is in the outcome; only an interruption passes."""
        start = time.perf_counter()
        size = case.size or self.size or (1, 1)
        state: CaseState = "ran"
        code = text = ""
        passes: tuple[PassOutcome, ...] = ()
        try:
            document = load_target(self.target, self.overrides)
            size = case.size or self.size or frame_size(document)
            reason = _why_not(case, document)
            if reason:
                state, text = "not_applicable", reason
            else:
                passes = self._passes(case, size, document)
                if case.extreme.refused:
                    state, text = "not_refused", f"{case.extreme.refused} is declared, and did not come"
        except RenderGraphError as error:
            codes = [d.code for d in error.diagnostics]
            state = "refused" if case.extreme.refused in codes else "failed"
            code = case.extreme.refused if state == "refused" else codes[0]
            text = next(d.text for d in error.diagnostics if d.code == code)
            self._settle()
        except MemoryError:
            state, text = "failed", "out of memory"
        except Exception as error:  # somebody's node, which may fail in any way
            state, text = "failed", f"{type(error).__name__}: {error}" + _place(error)
            self._settle()
        return CaseOutcome(
            case.name, case.extreme.help, case.common, state, size, time.perf_counter() - start, code, text, passes
        )

    def _settle(self) -> None:
        """Drop driver errors that the failed run left, so that the next extreme does not find them."""
        self.device.debug.take_errors()

    def _passes(self, case: Case, size: tuple[int, int], document: Document) -> tuple[PassOutcome, ...]:
        overrides = [*case.extreme.overrides, *(case.swap(document) if case.swap else ())]
        if overrides:
            document = load_target(self.target, (*self.overrides, *overrides))
        loaded = self._scene(document)
        if case.edit is not None and loaded is not None:
            loaded = case.edit(loaded)
        frames = min(document.model.frame.count, MOST_FRAMES)
        planned = plan_for_scene(document, loaded, PlanOptions(), size=size, frames=frames)
        names = list(document.model.passes)
        runs = self._watch(document, planned, case)
        found = []
        for name in _in_order(names, runs):
            node = document.model.passes[name].node
            if self.target.node and node != self.target.node:
                continue
            if name not in runs:
                found.append(PassOutcome(name, node, "not_run", reason="the plan leaves it out"))
            elif case.inject is not None and not injectable(document, planned.plan, name):
                found.append(PassOutcome(name, node, "not_run", reason="it reads no colour in floats"))
            else:
                found.append(self._check(name, node, runs[name], case))
        return tuple(found)

    def _watch(self, document: Document, planned: PlannedDocument, case: Case) -> dict[str, PassRun]:
        """What the passes of the last frame saw and did."""
        plan, scene = planned.plan, planned.scene.scene if planned.scene else None
        last = plan.graph.frame.count - 1
        runner = Runner(self.device, plan, scene, frame_cameras(planned))
        try:
            runner.prepare()
            for index in range(last):
                runner.run_frame(index)

            def prepare(name: str) -> None:
                if case.inject is not None:
                    inject(runner, document, self.device, name, last, case.inject)

            with np.errstate(invalid="ignore"):  # NaN is looked for, not tripped over
                return watch_frame(
                    runner, document, planned, self.device, set(document.model.passes), last, prepare=prepare
                )
        finally:
            runner.release()

    def _scene(self, document: Document) -> LoadedScene | None:
        """The document's scene, kept between extremes."""
        key = repr((document.model.scene, document.model.frame.seed))
        if key not in self._scenes:
            self._scenes[key] = load_document_scene(document, None)
        return self._scenes[key]

    def _check(self, name: str, node_name: str, run: PassRun, case: Case) -> PassOutcome:
        node = find_node(node_name)
        skipped = dict(_skips(case, node_name))
        failures: list[Failure] = []
        for check in CHECKS:
            if check in skipped:
                continue
            try:
                if check == "finite":
                    failures += checks.not_finite(run)
                elif check == "bounded":
                    failures += checks.outside_bounds(node, run)
                elif check == "energy" and case.light is not None:
                    failures += checks.created_light(node, run, case.light)
                elif check == "invariants":
                    failures += checks.broken(name, node, run)
                elif check == "error":
                    failures += checks.above_tolerance(name, node, run, self.cache)
            except RenderGraphError as error:
                first = error.diagnostics[0]
                if first.code == _BROKEN_REFERENCE:
                    failures.append(Failure(check, f"{first.code} {first.text}"))
                else:  # what the reference itself needs is not to be had here; the pass has run
                    skipped[check] = f"it cannot be judged: {first.code} {first.text}"
        # What was put into the inputs here is this pass's own to bear.
        inherited = bool(failures) and case.inject is None and not finite_inputs(run)
        status: PassStatus = "inherited" if inherited else "fail" if failures else "pass"
        return PassOutcome(name, node_name, status, tuple(failures), skipped)


def _skips(case: Case, node: str) -> Mapping[str, str]:
    skips = case.skips.get(node, {})
    if case.inject is not None:
        return {"error": "there is no truth about what is not finite", **skips}
    return skips


def _why_not(case: Case, document: Document) -> str:
    if case.edit is not None and document.model.scene is None:
        return "the graph has no scene"
    if case.swap is not None and not case.swap(document):
        return "no target is of another format that its ports take"
    if case.inject is not None and not any(model.read for model in document.model.passes.values()):
        return "no pass reads anything"
    return ""


def _in_order(names: Iterable[str], runs: Mapping[str, PassRun]) -> list[str]:
    """Passes in the order they ran, then those that did not."""
    return [*runs, *(name for name in names if name not in runs)]


def _place(error: BaseException) -> str:
    """Where an exception was raised: file and line, as the author of a node needs it."""
    trace = error.__traceback__
    if trace is None:
        return ""
    while trace.tb_next is not None:
        trace = trace.tb_next
    code = trace.tb_frame.f_code
    return f" ({code.co_filename.rpartition('/')[2]}:{trace.tb_lineno})"
