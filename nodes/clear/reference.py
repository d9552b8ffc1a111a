"""What a clear leaves behind: the value, as the target's format can hold it, in every texel of every level."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rendergraph.document.formats import FORMATS, Channel
from rendergraph.measure.truth.decode import srgb_decode
from rendergraph.measure.truth.storage import channel_bits, held, rounding, steps
from rendergraph.node.reference import PassRun, Truth
from rendergraph.plan.graph import BufferDesc

if TYPE_CHECKING:
    from rendergraph.nodes.clear import ClearParams

F64 = npt.NDArray[np.float64]


def judge(run: PassRun) -> Mapping[str, Truth]:
    """``target``, in steps of the format: one layer above the other, the lower levels after the first; the stencil
    beside the depth.
    """
    params: ClearParams = run.params  # type: ignore[assignment]
    desc, content = run.descs["target"], run.outputs["target"]
    if isinstance(desc, BufferDesc):
        words = np.asarray(content, np.float64).reshape(1, -1, 1)
        return {"target": Truth(np.full_like(words, float(params.value)), judged=words)}  # type: ignore[arg-type]
    texel = stored_value(params, desc.format, run.frame.depth)
    levels = [np.asarray(content, np.float64), *run.levels.get("target", ())]
    judged = _one_picture(levels)
    size = steps(desc.format, texel)
    judged, value = judged / size, np.broadcast_to(texel / size, judged.shape)
    tolerance = rounding(desc.format) * (2 if desc.samples > 1 else 1)  # a resolve rounds again
    if "target" in run.stencils:
        stencil = 2.0 * run.stencils["target"]  # so that being off by one is more than any rounding of the depth
        judged = np.concatenate([judged, stencil], axis=-1)
        value = np.concatenate([value, np.full_like(stencil, 2.0 * params.stencil)], axis=-1)
    return {"target": Truth(np.asarray(value), judged=judged, tolerance=tolerance)}


def stored_value(params: ClearParams, format: str, depth: str) -> F64:
    """What a shader should read of a texel, ``float64[channels]``.

    Normalised formats clamp, whole numbers are cut off, depth is a distance under either convention, and an sRGB target
    takes its value as encoded already (docs/conventions.md).
    """
    row = FORMATS[format]
    given = params.value if isinstance(params.value, tuple) else (params.value,) * 4
    texel = np.array(given[: row.channels], np.float64)
    if row.depth:
        return (1.0 - texel if depth == "reversed" else texel).astype(np.float32).astype(np.float64)
    if row.channel in (Channel.UINT, Channel.INT):
        return np.trunc(texel)
    texel = held(format, texel)
    if row.srgb:
        texel[:3] = srgb_decode(texel[:3])
    return texel.astype(np.float32).astype(np.float64) if channel_bits(format)[0] == 32 else texel


def _one_picture(levels: list[F64]) -> F64:
    """A single level as it is; several as one row of all their texels."""
    if len(levels) == 1:
        return levels[0]
    return np.concatenate([level.reshape(1, -1, level.shape[-1]) for level in levels], axis=1)
