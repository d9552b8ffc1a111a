"""What histogram.comp must count and histogram.frag must show."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rendergraph.node.reference import PassRun, Truth

BINS = 64


def judge(run: PassRun) -> Mapping[str, Truth]:
    """Of the bins (histogram.comp) or of their picture (histogram.frag), told apart by what the pass writes."""
    picture = np.asarray(run.inputs["u_picture"], np.float64)[..., :3]
    if "Bins" in run.outputs:
        return {"Bins": count(picture, np.asarray(run.before["Bins"], np.float64), np.asarray(run.outputs["Bins"]))}
    return {"color": show(picture, np.asarray(run.inputs["Bins"], np.float64), *run.outputs["color"].shape[:2])}


def count(picture: np.ndarray, before: np.ndarray, bins: np.ndarray) -> Truth:
    """Exact, but for texels on the border of two bins, which float32 may put into either: they are not asked for."""
    place = picture @ [0.2126, 0.7152, 0.0722] * BINS
    sure = np.abs(place - np.round(place)) > 1e-4
    certain = np.bincount(np.minimum(place[sure], BINS - 1).astype(int), minlength=BINS) + before[:BINS]
    possible = certain.copy()
    for border in np.round(place[~sure]).astype(int):
        possible[[max(border - 1, 0), min(border, BINS - 1)]] += 1
    found = bins[:BINS].astype(np.float64)
    complete = found.sum() == place.size + before[:BINS].sum()
    value = np.where((found >= certain) & (found <= possible) & complete, found, certain)
    return Truth(np.concatenate([value, before[BINS:]]).reshape(1, -1, 1))


def show(picture: np.ndarray, bins: np.ndarray, height: int, width: int) -> Truth:
    """Bars over the dimmed picture; not known within a thousandth of a bar's edge."""
    x, y = np.meshgrid(
        ((np.arange(width) + 0.5) / width - 0.05) / 0.9, ((np.arange(height) + 0.5) / height - 0.06) / 0.4
    )
    inside = (x >= 0) & (y >= 0) & (x < 1) & (y < 1)
    along = np.clip(x, 0, 1 - 1e-9) * BINS
    level = bins[along.astype(int)] / (6.0 * picture.shape[0] * picture.shape[1] / BINS)
    bar = (y < level) & (along % 1 > 0.15)
    rows, columns = (np.arange(n) * old // n for n, old in ((height, picture.shape[0]), (width, picture.shape[1])))
    shade = picture[np.ix_(rows, columns)]
    panel = np.where(bar[..., None], np.array([1.0, 0.85, 0.35]), 0.35 * shade)
    color = np.concatenate([np.where(inside[..., None], panel, shade), np.ones((height, width, 1))], axis=-1)
    edges = (along % 1, along % 1 - 0.15, along % 1 - 1.0, y - level, x, y, x - 1.0, y - 1.0)
    sure = np.logical_and.reduce([np.abs(edge) > 1e-3 for edge in edges])
    return Truth(color, mask=sure | (np.abs(x - 0.5) > 0.502) | (np.abs(y - 0.5) > 0.502))
