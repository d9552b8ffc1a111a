"""Judges a pass by its node's reference: each measure compared with its truth, and a verdict."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Mapping
from dataclasses import replace
from types import ModuleType
from typing import TYPE_CHECKING, Any

from rendergraph.document.formats import FORMATS, Channel
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.measure.metrics import unit
from rendergraph.measure.truth.judgement import Judgement, Verdict, WorstTexel
from rendergraph.measure.truth.score import Score, score
from rendergraph.node.contract import Node
from rendergraph.node.reference import Measure, PassRun, Quantity, Reference, Truth
from rendergraph.plan.graph import TextureDesc

if TYPE_CHECKING:
    from rendergraph.measure.truth.cache import CachedTruths, TruthCache

__all__ = ["Judgement", "Verdict", "WorstTexel", "judge_pass"]


def judge_pass(
    name: str, node: type[Node[Any]], run: PassRun, cache: TruthCache | None = None, *, flip: bool = True
) -> tuple[Judgement, ...]:
    """Every measure of the node's reference, judged on what ``run`` shows; nothing for a node without a reference.

    ``cache`` keeps truths between runs. Without ``flip`` that metric, the slowest, is taken only where a verdict needs
    it.

    :raises RenderGraphError: RG744 where the reference module fails or gives what it did not declare; what the
        reference raises itself.
    """
    module = reference_module(node)
    reference = node.reference or implied_reference(node, run)
    if module is None or reference is None:
        if node.reference is not None:
            raise broken(name, node, "there is no reference.py with judge(run) beside the node")
        return ()
    kept, cached = recall_truths(name, node, reference, run, cache)
    found = []
    for key, measure in reference.measures.items():
        try:
            scored = score(measure, kept.truths[key], run, flip=flip)
        except (ValueError, KeyError, TypeError) as error:
            raise broken(name, node, f"measure '{key}': {error}") from error
        found.append(replace(judge_scored(name, node, reference, key, scored), seconds=kept.seconds, cached=cached))
    return tuple(found)


def judge_scored(name: str, node: type[Node[Any]], reference: Reference, key: str, scored: Score) -> Judgement:
    """A judgement of what was measured, without what the reference took."""
    measure = reference.measures[key]
    return Judgement(
        pass_name=name,
        node=node.name,
        measure=key,
        quantity=measure.quantity,
        metrics=scored.metrics,
        metric=measure.metric,
        value=scored.value,
        tolerance=scored.tolerance,
        verdict=scored.verdict,
        masked=scored.masked,
        worst_texel=scored.worst_texel,
        standard_error=scored.standard_error,
        reason=scored.reason,
        port=measure.port,
        unit=measure.unit or unit(measure.quantity, measure.metric),
        help=measure.help,
        method=reference.method,
        source=reference.source,
        ideal=reference.ideal and measure.ideal,
        pictures=scored.pictures,
    )


def recall_truths(
    name: str, node: type[Node[Any]], reference: Reference, run: PassRun, cache: TruthCache | None
) -> tuple[CachedTruths, bool]:
    """The truths of a run, and whether the cache had them. Raises as :func:`judge_pass`."""
    from rendergraph.measure.truth.cache import compute_timed

    def compute(seen: PassRun) -> Mapping[str, Truth]:
        return compute_truths(name, node, reference, seen)

    return cache.recall(node, run, compute) if cache is not None else (compute_timed(compute, run), False)


def compute_truths(name: str, node: type[Node[Any]], reference: Reference, run: PassRun) -> Mapping[str, Truth]:
    """What ``judge(run)`` of the node's reference module says. Raises as :func:`judge_pass`."""
    try:
        module = importlib.import_module(f"{node.__module__}.reference")
        truths: Mapping[str, Truth] = module.judge(run)
        given = {key: truth for key, truth in truths.items() if isinstance(truth, Truth)}
    except RenderGraphError:
        raise
    except Exception as error:  # somebody's code, which may fail in any way
        raise broken(name, node, f"{type(error).__name__}: {error}") from error
    if set(given) != set(reference.measures) or len(given) != len(truths):
        declared, said = ", ".join(sorted(reference.measures)), ", ".join(sorted(map(str, truths)))
        raise broken(name, node, f"the node declares the measures {declared}, judge(run) gives {said or 'none'}")
    return given


def reference_module(node: type[Node[Any]]) -> ModuleType | None:
    """The node's ``reference`` module, None where it has none with ``judge``. Raises RenderGraphError RG744."""
    name = f"{node.__module__}.reference"
    try:
        if name not in sys.modules and importlib.util.find_spec(name) is None:
            return None
        module = importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name == name or (error.name and name.startswith(f"{error.name}.")):
            return None
        raise broken("", node, f"{type(error).__name__}: {error}") from error
    except Exception as error:
        raise broken("", node, f"{type(error).__name__}: {error}") from error
    return module if hasattr(module, "judge") else None


def implied_reference(node: type[Node[Any]], run: PassRun) -> Reference | None:
    """What an exact node need not declare: each output equals the truth of its port's name, by the metric ``max``
    (``mismatch_rate`` for integers), with tolerance 0.
    """
    if not node.exact:
        return None
    measures = {}
    for port in run.outputs:
        desc = run.descs.get(port)
        whole = not isinstance(desc, TextureDesc) or FORMATS[desc.format].channel in (Channel.UINT, Channel.INT)
        quantity, metric = (Quantity.IDENTITY, "mismatch_rate") if whole else (Quantity.SCALAR, "max")
        measures[port] = Measure(quantity, metric, 0.0, "Equal to the truth.", port=port)
    return Reference("analytic", measures)


def why_not_judged(node: type[Node[Any]], run: PassRun | None = None) -> str:
    """Why a node cannot be judged, or, with a ``run``, why that pass of it cannot, which its reference module may tell
    by ``why_not(run)``; empty where it can. Raises RenderGraphError RG744.
    """
    if run is not None:
        ask = getattr(reference_module(node), "why_not", None)
        return str(ask(run)) if ask is not None else ""
    if node.reference is not None or (node.exact and reference_module(node) is not None):
        return ""
    if node.exact:
        return "it is declared exact, and its own tests hold it against what it must give"
    return "the node has no reference"


def broken(name: str, node: type[Node[Any]], reason: str) -> RenderGraphError:
    """The diagnostic for a reference that does not do what it must."""
    return RenderGraphError([diagnose("RG744", name=name or node.name, node=node.name, reason=reason)])
