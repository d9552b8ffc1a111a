"""All metrics of a quantity at once, and the error of every texel."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from math import inf, isfinite
from typing import Final

import numpy as np
import numpy.typing as npt

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.metrics import errors, summary
from rendergraph.measure.metrics.flip import flip, flip_version
from rendergraph.measure.metrics.ssim import ssim_map
from rendergraph.measure.metrics.table import METRICS, NOT_FINITE
from rendergraph.node.reference import Quantity

F64 = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

_STATISTICS: Final[dict[str, Callable[[F64], float]]] = {
    "max": lambda e: float(e.max()),
    "mean": lambda e: float(e.mean()),
    "rmse": summary.rmse,
    "p50": lambda e: summary.percentile(e, 50),
    "p99": lambda e: summary.percentile(e, 99),
}
_ERRORS: Final[dict[str, Callable[[F64, F64], F64]]] = {
    "absolute": errors.absolute_error,
    "relative": errors.relative_error,
    "ulp": errors.ulp_distance,
    "angular": errors.angular_error,
    "length": errors.length_error,
    "mismatch": errors.mismatch,
}
_OWN: Final = {Quantity.NORMAL: "angular", Quantity.IDENTITY: "mismatch"}


def compare(
    quantity: Quantity, judged: F64, truth: F64, mask: Mask | None = None, metrics: Iterable[str] | None = None
) -> dict[str, float | None]:
    """Metrics of ``judged`` against ``truth``, float64[h, w, c] (or [h, w]), by name: all of ``METRICS[quantity]``, or
    those asked for. Texels where ``mask`` (bool[h, w]) is False change no number, whatever they hold.

    None: no texel is known, or ``psnr`` of equal images. Infinite (``psnr`` and ``ssim``: minus infinity): somewhere
    one image holds NaN or an infinity that the other has not. ``flip`` is left out where its package is not installed,
    unless it is asked for.

    :raises RenderGraphError: RG749 for ``flip`` asked for where it is not installed.
    :raises ValueError: for unequal shapes, no texels, or a metric that the quantity has not.
    """
    pair = _Pair.of(quantity, judged, truth, mask)
    names = tuple(metrics) if metrics is not None else METRICS[quantity]
    if unknown := [name for name in names if name not in METRICS[quantity]]:
        raise ValueError(f"{quantity} has no metric {unknown[0]}, only {', '.join(METRICS[quantity])}")
    if metrics is None and "flip" in names and not _has_flip():
        names = tuple(name for name in names if name != "flip")
    return {name: pair.metric(name) for name in names}


def error_map(quantity: Quantity, judged: F64, truth: F64, mask: Mask | None = None, metric: str = "max") -> F64:
    """The error of every texel, float64[h, w]: the largest of its channels; NaN where ``mask`` is False.

    It is the quantity's own error, in its unit, so that the largest of it is the metric ``max``; for ``flip`` the FLIP
    map, for ``ssim`` one minus the similarity, for names ending in ``_ulp``, ``_relative`` or ``_length`` that error.

    :raises RenderGraphError: RG749 for ``flip`` where it is not installed.
    :raises ValueError: as :func:`compare`.
    """
    pair = _Pair.of(quantity, judged, truth, mask)
    if metric not in ("max", *METRICS[quantity]):
        raise ValueError(f"{quantity} has no metric {metric}, only {', '.join(METRICS[quantity])}")
    known = np.ones(pair.truth.shape[:2], np.bool_) if mask is None else mask
    if metric == "flip":
        return np.where(known, flip(pair.judged, pair.truth, hdr=quantity is Quantity.RADIANCE, mask=mask).map, np.nan)
    if metric == "ssim":
        return np.where(known, 1.0 - pair.similarity(), np.nan)
    found = np.full(known.shape, np.nan)
    found[known] = pair.error(pair.kind(metric)).max(axis=-1)
    return found


def worst_texel(errors: F64) -> tuple[int, int] | None:
    """Where an :func:`error_map` is largest: x, y from the lower left. None where all texels are masked."""
    if np.isnan(errors).all():
        return None
    y, x = np.unravel_index(int(np.nanargmax(errors)), errors.shape)
    return int(x), int(y)


def as_json(metrics: Mapping[str, float | None]) -> dict[str, float | None]:
    """The metrics with None for infinities, which JSON has not.

    None then reads: where ``not_finite`` is None too, no texel was known; ``psnr`` beside an ``rmse`` of 0: the images
    are equal; any other: infinitely wrong.
    """
    return {name: value if value is None or isfinite(value) else None for name, value in metrics.items()}


def _has_flip() -> bool:
    try:
        flip_version()
    except RenderGraphError:
        return False
    return True


@dataclass(frozen=True, slots=True)
class _Pair:
    """Two images of one shape [h, w, c], and the known texels of each as [n, c]."""

    quantity: Quantity
    judged: F64
    truth: F64
    mask: Mask | None
    judged_texels: F64
    truth_texels: F64
    errors_by_kind: dict[str, F64] = field(default_factory=dict)

    @classmethod
    def of(cls, quantity: Quantity, judged: F64, truth: F64, mask: Mask | None) -> _Pair:
        if judged.shape != truth.shape or truth.size == 0 or truth.ndim not in (2, 3):
            raise ValueError(f"shapes {judged.shape} and {truth.shape} are no two images of one size")
        if mask is not None and (mask.shape != truth.shape[:2] or mask.dtype != np.bool_):
            raise ValueError(f"a mask {mask.dtype}{mask.shape} does not fit {truth.shape}")
        a, b = (np.asarray(image, np.float64).reshape(*truth.shape[:2], -1) for image in (judged, truth))
        known_a, known_b = (image.reshape(-1, a.shape[2]) if mask is None else image[mask] for image in (a, b))
        return cls(quantity, a, b, mask, known_a, known_b)

    def metric(self, name: str) -> float | None:
        if not len(self.truth_texels):
            return None
        if name == NOT_FINITE:
            return float(errors.not_finite(self.judged_texels, self.truth_texels).sum())
        if name == "flip":
            return flip(self.judged, self.truth, hdr=self.quantity is Quantity.RADIANCE, mask=self.mask).mean
        if name == "ssim":
            return float((self.similarity() if self.mask is None else self.similarity()[self.mask]).mean())
        if name == "psnr":
            return summary.psnr(summary.mean_square(self.error("absolute")))
        if name == "rel_mse":
            return summary.relative_mse(self.error("absolute"), self.truth_texels)
        if name == "mismatch_rate":
            return float(self.error("mismatch").mean())
        return _STATISTICS[name.partition("_")[0]](self.error(self.kind(name)))

    def kind(self, metric: str) -> str:
        return metric.partition("_")[2] if metric.partition("_")[2] in _ERRORS else _OWN.get(self.quantity, "absolute")

    def error(self, kind: str) -> F64:
        if kind not in self.errors_by_kind:
            self.errors_by_kind[kind] = _ERRORS[kind](self.judged_texels, self.truth_texels)
        return self.errors_by_kind[kind]

    def similarity(self) -> F64:
        """SSIM of each texel; minus infinity where only one image is finite."""
        a, b = self.judged[..., :3], self.truth[..., :3]  # not alpha, which is 1 nearly everywhere
        finite = np.asarray((np.isfinite(a) & np.isfinite(b)).all(axis=-1))
        same = ((a == b) | (np.isnan(a) & np.isnan(b))).all(axis=-1)
        known = finite if self.mask is None else finite & self.mask
        found = ssim_map(a, b, None if known.all() else known)
        return np.where(finite, found, np.where(same, 1.0, -inf))
