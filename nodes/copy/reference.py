"""What a copy must hold: the source's bits, or its values scaled and converted by the rules of OpenGL 4.5, 18.3.1."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from rendergraph.document.formats import FORMATS, Channel
from rendergraph.measure.truth.shares import as_shares
from rendergraph.measure.truth.storage import held, steps, storage_error
from rendergraph.node.reference import PassRun, Truth
from rendergraph.nodes.copy.texel_bits import reinterpret
from rendergraph.plan.graph import BufferDesc, TextureDesc

if TYPE_CHECKING:
    from rendergraph.nodes.copy import CopyParams

F64 = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

#: Bits of the fraction by which samplers weigh two texels (GL asks for none; 8 are what hardware has).
WEIGHT_BITS = 8
#: Steps by which a texel of an sRGB texture may be decoded wrongly (measured: 0.33 on llvmpipe).
SRGB_DECODING = 0.4
#: Relative, of a conversion through float32.
FLOAT32 = 2.0**-23
#: What is lost by reading 10-bit codes back as float32.
READ_BACK = 1e-6


def judge(run: PassRun) -> Mapping[str, Truth]:
    """``destination``, its errors as shares of :func:`_allowed`; where lower mip levels are filled, all levels in one
    row.
    """
    params: CopyParams = run.params  # type: ignore[assignment]
    one, two = run.descs["source"], run.descs["destination"]
    source, content = np.asarray(run.inputs["source"], np.float64), np.asarray(run.outputs["destination"], np.float64)
    if isinstance(one, BufferDesc) or isinstance(two, BufferDesc):
        return {"destination": Truth(source.reshape(1, -1, 1), judged=content.reshape(1, -1, 1))}
    if params.blit:
        levels = [Level(content, *_blitted(params, one, two, source))]
    elif one.format == two.format:
        levels = [Level(content, source, np.ones(source.shape[:-1], bool), np.zeros_like(source))]
    else:
        value, known = reinterpret(source, one.format, two.format)
        levels = [Level(content, value, known, np.full_like(value, READ_BACK if two.format == "rgb10_a2" else 0.0))]
    if params.mips:
        levels += _mip_levels(content, run.levels.get("destination", ()), two.format)
    return {"destination": _truth(levels)}


class Level(NamedTuple):
    """One mip level: what it holds, should hold (both float64[h, w, c]), where that is known, and what is allowed."""

    content: F64
    value: F64
    known: Mask
    allowed: F64


def _truth(levels: list[Level]) -> Truth:
    """One level as it is; several as one row of all their texels."""
    if len(levels) == 1:
        content, value, known, allowed = levels[0]
    else:
        content, value, allowed = (
            np.concatenate([level[i].reshape(1, -1, level[i].shape[-1]) for level in levels], axis=1) for i in (0, 1, 3)
        )
        known = np.concatenate([level.known.reshape(1, -1) for level in levels], axis=1)
    judged, shares, tolerance = as_shares(content, value, allowed)
    return Truth(shares, judged=judged, mask=known, tolerance=tolerance)


def _blitted(params: CopyParams, one: TextureDesc, two: TextureDesc, source: F64) -> tuple[F64, Mask, F64]:
    """(value, where it is known, by how much it may be off) after scaling, conversion and rounding."""
    layers = source if one.layers > 1 else source[None]
    each = [_scaled(layer, two, params.linear) for layer in layers]
    scaled, known, slack = np.stack([e[0] for e in each]), np.stack([e[1] for e in each]), max(e[2] for e in each)
    if one.layers == 1:
        scaled, known = scaled[0], known[0]
    value = held(two.format, _channels(scaled, FORMATS[two.format].channels))
    allowed = slack + storage_error(two.format, value)
    if FORMATS[two.format].channel not in (Channel.UINT, Channel.INT, Channel.DEPTH):
        allowed += FLOAT32 * np.abs(np.nan_to_num(value, posinf=0.0, neginf=0.0))
    if FORMATS[one.format].srgb:
        allowed[..., :3] += SRGB_DECODING * steps(one.format, scaled)[..., : min(3, value.shape[-1])]
    return value, known, allowed


def _scaled(source: F64, two: TextureDesc, linear: bool) -> tuple[F64, Mask, float]:
    """(the source at the destination's size, where that is sure, how far it may be off): the nearest texel is not sure
    where a place falls on the border between two, and weights of two texels are whole numbers over 256.
    """
    (rows, row_doubt), (columns, column_doubt) = (
        _places(old, new) for old, new in ((source.shape[0], two.height), (source.shape[1], two.width))
    )
    sure = np.ones((two.height, two.width), bool)
    if (two.height, two.width) == source.shape[:2]:
        return source, sure, 0.0
    if not linear:
        picked = source[rows.astype(int)[:, None], columns.astype(int)[None, :]]
        return picked, ~(row_doubt[:, None] | column_doubt[None, :]), 0.0
    value = _between(_between(source, rows - 0.5, 0), columns - 0.5, 1)
    return value, sure, 2.0**-WEIGHT_BITS * sum(_difference(source, axis) for axis in (0, 1))


def _places(old: int, new: int) -> tuple[F64, Mask]:
    """Where the centres of ``new`` texels lie among ``old``, in texels, and whether that is on a border."""
    place = (np.arange(new) + 0.5) * old / new
    return place, np.abs(place - np.round(place)) < 1e-3


def _between(grid: F64, place: F64, axis: int) -> F64:
    low = np.floor(place)
    share = (place - low).reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
    first, second = (np.clip(low + i, 0, grid.shape[axis] - 1).astype(int) for i in (0, 1))
    return np.asarray(grid.take(first, axis) * (1.0 - share) + grid.take(second, axis) * share)


def _difference(grid: F64, axis: int) -> float:
    """Largest difference of two neighbours."""
    return float(np.abs(np.diff(grid, axis=axis)).max()) if grid.shape[axis] > 1 else 0.0


def _mip_levels(first: F64, levels: tuple[F64, ...], format: str) -> list[Level]:
    """Each level against the means of four texels of the one above, which is as the device made it, rounded once an
    axis. Of an odd size the filter is not said by OpenGL, and nothing is known.
    """
    found = []
    above = first
    for level in levels:
        height, width = level.shape[:2]
        h, w = (min(2, above.shape[i]) for i in (0, 1))
        even = above.shape[:2] == (height * h, width * w)
        mean = above[: height * h, : width * w].reshape(height, h, width, w, -1).mean(axis=(1, 3))
        found.append(Level(level, mean, np.full((height, width), even), 2.0 * storage_error(format, mean)))
        above = level
    return found


def _channels(values: F64, count: int) -> F64:
    """As many channels: missing colours are 0 and alpha 1 (GL 4.5, table 15.1)."""
    missing = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (*values.shape[:-1], 4))[..., values.shape[-1] : count]
    return np.concatenate([values[..., :count], missing], axis=-1)
