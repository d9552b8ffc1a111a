"""What life.comp and life.frag must give: Conway's rules on a torus, and the palette."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from rendergraph.node.reference import PassRun, Truth

F64 = npt.NDArray[np.float64]
ALIVE = 255


def judge(run: PassRun) -> Mapping[str, Truth]:
    """Of the generation (life.comp) or its picture (life.frag), told apart by what the pass writes."""
    seen = "u_last" if "u_cells" in run.outputs else "u_cells"
    cells = np.asarray(run.inputs[seen], np.float64)[..., 0]
    if "u_cells" not in run.outputs:
        return picture(cells, *run.outputs["color"].shape[:2])
    height, width = run.outputs["u_cells"].shape[:2]
    living = first(height, width, run.frame.seed) if run.index == 0 else following(cells)
    return {"u_cells": Truth(living[..., None].astype(np.float64))}


def first(height: int, width: int, seed: int) -> npt.NDArray[np.int64]:
    """Seeded noise: pcg2d (Jarzynski and Olano 2020)."""
    y, x = np.mgrid[:height, :width].astype(np.uint32)
    mult, add, shift = np.uint32(1664525), np.uint32(1013904223), np.uint32(16)
    a, b = (x + np.uint32(seed & 0xFFFFFFFF)) * mult + add, y * mult + add
    a = a + b * mult
    b = b + a * mult
    a, b = a ^ (a >> shift), b ^ (b >> shift)
    a = a + b * mult
    a ^= a >> shift
    return np.where(a < 0x50000000, ALIVE, 0)


def following(cells: F64) -> npt.NDArray[np.int64]:
    """The next generation: 255 is alive, a dead cell keeps 15 sixteenths of what it was."""
    alive = (cells == ALIVE).astype(int)
    around = sum(np.roll(alive, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)) - alive
    lives = (around == 3) | ((around == 2) & (alive == 1))
    return np.where(lives, ALIVE, cells.astype(int) * 15 // 16)


def picture(cells: F64, height: int, width: int) -> Mapping[str, Truth]:
    """The nearest cell's colour; not known where a pixel's centre lies on the border between two."""
    places = [(np.arange(new) + 0.5) / new * old for new, old in ((height, cells.shape[0]), (width, cells.shape[1]))]
    on_border = [np.abs(place - np.round(place)) < 1e-3 for place in places]
    cell = cells[np.ix_(*(place.astype(int) for place in places))][..., None]
    trail = cell / 255.0
    dead = (1 - trail**2) * np.array([0.02, 0.02, 0.06]) + trail**2 * np.array([0.45, 0.15, 0.75])
    color = np.where(cell == ALIVE, np.array([1.0, 0.92, 0.6]), dead)
    color = np.concatenate([color, np.ones((height, width, 1))], axis=-1)
    return {"color": Truth(color, mask=~(on_border[0][:, None] | on_border[1][None, :]))}
