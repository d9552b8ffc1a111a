"""Looks points up in a cascaded shadow map, in float64: what shaders/shadow.glsl does, written from its definition.

Percentage-closer filtering: Reeves, Salesin and Cook, "Rendering antialiased shadows with depth maps", 1987; the four
comparisons of a bilinear tap as OpenGL 4.5 defines them (8.23.1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

#: Float32 arithmetic of the receiver's place, as a share of the map's range of depth and of its width.
ARITHMETIC = 3e-6


@dataclass(frozen=True, slots=True)
class Cascades:
    """The cascades' buffer: ``to_clip`` float64[4, 4, 4] world to clip, ``far`` view depths and ``texel`` widths,
    metres, float64[4].
    """

    to_clip: F64
    far: F64
    texel: F64
    count: int
    normal_bias: float

    @classmethod
    def of(cls, words: npt.NDArray[np.uint32]) -> Cascades:
        """From the buffer's 80 words (shaders/cascades.glsl)."""
        numbers = words.view(np.float32).astype(np.float64)
        # Column-major matrices.
        return cls(numbers[:64].reshape(4, 4, 4).transpose(0, 2, 1), numbers[64:68], numbers[68:72], int(words[72]),
                   float(numbers[73]))  # fmt: skip


@dataclass(frozen=True, slots=True)
class Lookup:
    """``lit`` float64[n] in 0..1; ``sure`` bool[n]: no comparison and no choice of a cascade was so close that float32
    may decide it otherwise; ``faded`` bool[n]: at or beyond the last tenth of the range, where shadows end.
    """

    lit: F64
    sure: Bools
    faded: Bools


def look_up(
    layers: F64,
    cascades: Cascades,
    position: F64,
    normal: F64,
    view_depth: F64,
    towards: F64,
    taps: int,
    reversed: bool,
) -> Lookup:
    """The sun's visibility at world-space points float64[n, 3] with unit normals, ``view_depth`` metres from the camera
    plane. ``layers`` float64[layers, size, size]; ``towards`` unit, to the sun; ``taps`` x ``taps`` bilinear ones.
    """
    count = len(position)
    if cascades.count == 0 or count == 0:
        return Lookup(np.ones(count), np.ones(count, dtype=bool), np.zeros(count, dtype=bool))
    ends = cascades.far[: cascades.count]
    end = ends[-1]
    chosen = np.minimum(np.searchsorted(ends, view_depth, side="left"), cascades.count - 1)
    sure = np.abs(view_depth[:, None] - ends).min(axis=1) > ARITHMETIC * view_depth
    size = layers.shape[-1]
    cosine = np.clip(normal @ towards, 0.0, 1.0)
    radius = cascades.texel[chosen] * (taps + 1) / 2.0
    moved = position + normal * (cascades.normal_bias * radius * np.sqrt(1.0 - cosine**2))[:, None]
    clip = np.einsum("nij,nj->ni", cascades.to_clip[chosen], np.concatenate([moved, np.ones((count, 1))], axis=1))
    # Taps are whole texels apart, so a row of them touches taps + 1 texels, the outer two by their share alone. In
    # texels, from the first one's centre, to the first tap's left one.
    place = (clip[:, :2] * 0.5 + 0.5) * size - 0.5 - 0.5 * (taps - 1)
    first = np.floor(place).astype(np.int64)
    share = place - first
    lit = np.zeros(count)
    for down in range(taps + 1):
        for right in range(taps + 1):
            weight = _weight(right, taps, share[:, 0]) * _weight(down, taps, share[:, 1])
            column, row = np.clip(first[:, 0] + right, 0, size - 1), np.clip(first[:, 1] + down, 0, size - 1)
            stored = layers[chosen, row, column]
            gap = clip[:, 2] - stored if reversed else stored - clip[:, 2]
            lit += weight * (gap >= 0.0)
            sure &= (np.abs(gap) > ARITHMETIC) | (weight < 1e-3)
    t = np.clip((view_depth / end - 0.9) / 0.1, 0.0, 1.0)
    fade = t * t * (3.0 - 2.0 * t)
    lit = np.where(view_depth >= end, 1.0, lit + (1.0 - lit) * fade)
    return Lookup(lit, sure | (view_depth >= end * (1.0 + 1e-5)), view_depth >= 0.9 * end)


def _weight(index: int, taps: int, share: F64) -> F64:
    """Of the texel ``index`` of a row of ``taps`` + 1, under a box of ``taps`` bilinear taps."""
    if index == 0:
        return (1.0 - share) / taps
    return share / taps if index == taps else np.full_like(share, 1.0 / taps)
