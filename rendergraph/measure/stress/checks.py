"""What must hold of a pass at any extreme. Each check gives the failures it finds."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import numpy as np

from rendergraph.measure.stress.outcome import BadTexel, Failure
from rendergraph.measure.stress.texels import first_bad, texel_at
from rendergraph.measure.truth.cache import TruthCache
from rendergraph.measure.truth.invariants import broken_invariants, out_of_bounds
from rendergraph.measure.truth.judge import judge_pass
from rendergraph.measure.truth.judgement import Judgement
from rendergraph.node.contract import Node
from rendergraph.node.reference import PassRun, Quantity
from rendergraph.plan.graph import TextureDesc

AnyNode = type[Node[Any]]

#: How much brighter than the truth a float format may store a number: it rounds up by half a step at the most.
_ROUNDED: Final = {"r11g11b10f": 2.0**-5, "rgba16f": 2.0**-10}


def not_finite(run: PassRun) -> Iterable[Failure]:
    """Outputs of floats that hold NaN or an infinity."""
    for port, content in run.outputs.items():
        if content.dtype.kind == "f":
            good = np.isfinite(content)
            texel = first_bad(run, port, good) if content.ndim >= 3 else None
            if texel is not None:
                yield Failure("finite", f"{port} is not finite in {_share(good)}", texel)


def outside_bounds(node: AnyNode, run: PassRun) -> Iterable[Failure]:
    """Finite values beyond the node's declared bounds."""
    for port, (low, high) in node.bounds.items():
        content = run.outputs.get(port)
        if content is None or content.dtype.kind != "f" or content.ndim < 3:
            continue
        good = ~np.isfinite(content) | ((content >= low) & (content <= high))
        texel = first_bad(run, port, good)
        if texel is not None:
            yield Failure("bounded", f"{port} leaves {low:g} to {high:g} in {_share(good)}", texel)


def created_light(node: AnyNode, run: PassRun, light: float) -> Iterable[Failure]:
    """Radiance above what the scene's light allows. A display's image is no radiance, and not looked at."""
    if node.reference is None or not node.needs_scene:
        return
    measures = node.reference.measures.values()
    for port in sorted({m.port for m in measures if m.quantity is Quantity.RADIANCE and m.port}):
        content, desc = run.outputs.get(port), run.descs.get(port)
        if content is None or not isinstance(desc, TextureDesc):
            continue
        most = light * (1.0 + _ROUNDED.get(desc.format, 1e-5))
        radiance = content[..., :3]
        good = ~np.isfinite(radiance) | (radiance <= most)
        texel = first_bad(run, port, good)
        if texel is not None:
            yield Failure("energy", f"{port} sends out more than {light:g}, which arrives, in {_share(good)}", texel)


def broken(name: str, node: AnyNode, run: PassRun) -> Iterable[Failure]:
    """The node's own invariants that do not hold. Raises RenderGraphError RG744 where its check fails."""
    bounds = set(out_of_bounds(node, run))  # told with their texels by another check
    for sentence in broken_invariants(name, node, run):
        if sentence not in bounds:
            yield Failure("invariants", sentence)


def above_tolerance(name: str, node: AnyNode, run: PassRun, cache: TruthCache | None) -> Iterable[Failure]:
    """Measures above the tolerance that the reference gives for this run.

    Where a node tells the error of its implementation from that of its technique (``Measure.ideal``), the first alone
    is held to account: how good a technique is at an extreme is for a sweep to say.

    :raises RenderGraphError: as :func:`rendergraph.measure.truth.judge.judge_pass`.
    """
    judgements = judge_pass(name, node, run, cache, flip=False)
    measures = {} if node.reference is None else node.reference.measures
    own = [j for j in judgements if j.measure in measures and not measures[j.measure].ideal]
    for judgement in own or judgements:
        if judgement.verdict == "above":
            text = (
                f"{judgement.measure}: {judgement.metric} is {judgement.value:.4g}"
                if judgement.value is not None
                else (f"{judgement.measure}: {judgement.metric} is undefined")
            )
            unit = f" {judgement.unit}" if judgement.unit else ""
            text += f"{unit}, above {judgement.tolerance:.4g}{unit}" + (
                f" ({judgement.reason})" if judgement.reason else ""
            )
            yield Failure("error", text, _judged_texel(run, judgement))


def _judged_texel(run: PassRun, judgement: Judgement) -> BadTexel | None:
    worst = judgement.worst_texel
    if worst is None:
        return None
    port = judgement.port or next(iter(run.outputs), "")
    content = run.outputs.get(port)
    if content is not None and content.ndim >= 3:
        # The layers of an array are judged above each other.
        layer, y = divmod(worst.y, content.shape[-3])
        if worst.x < content.shape[-2] and layer < (content.shape[0] if content.ndim == 4 else 1):
            found = texel_at(run, port, worst.x, y, layer)
            return BadTexel(port, worst.x, y, layer, worst.judged, {**found.inputs, "truth": worst.true})
    return BadTexel(port, worst.x, worst.y, 0, worst.judged, {**worst.inputs, "truth": worst.true})


def _share(good: np.ndarray[Any, np.dtype[np.bool_]]) -> str:
    texels = good.all(axis=-1)
    return f"{int((~texels).sum())} of {texels.size} texels"
