"""Which metrics belong to which quantity, which is its headline, and in what unit. No numpy here."""

from __future__ import annotations

from typing import Final

from rendergraph.node.reference import Quantity

#: Counted in every comparison: texels whose judged value is no finite number where the truth is.
NOT_FINITE: Final = "not_finite"

#: ``max``, ``mean``, ``rmse``, ``p50`` and ``p99`` are of the quantity's own error (:data:`UNITS`); with the ending
#: ``_ulp`` or ``_relative`` they are of that one. docs/metrics.md says what each means and when it misleads.
METRICS: Final[dict[Quantity, tuple[str, ...]]] = {
    Quantity.DISPLAY: ("max", "mean", "rmse", "p50", "p99", "psnr", "ssim", "flip", NOT_FINITE),
    Quantity.RADIANCE: ("max", "mean", "rmse", "p50", "p99", "rel_mse", "flip", NOT_FINITE),
    Quantity.NORMAL: ("max", "mean", "rmse", "p50", "p99", "max_length", NOT_FINITE),
    Quantity.DEPTH: (
        *("max", "mean", "rmse", "p50", "p99"),
        *("max_ulp", "mean_ulp", "p99_ulp"),
        *("max_relative", "mean_relative", "p99_relative"),
        NOT_FINITE,
    ),
    Quantity.SHARE: ("max", "mean", "rmse", "p50", "p99", "psnr", "ssim", NOT_FINITE),
    Quantity.IDENTITY: ("mismatch_rate", NOT_FINITE),
    Quantity.SCALAR: (
        *("max", "mean", "rmse", "p50", "p99"),
        *("max_relative", "mean_relative", "p99_relative"),
        NOT_FINITE,
    ),
}

#: The one number shown where there is room for one.
HEADLINE: Final[dict[Quantity, str]] = {
    Quantity.DISPLAY: "flip",
    Quantity.RADIANCE: "rel_mse",
    Quantity.NORMAL: "mean",
    Quantity.DEPTH: "rmse",
    Quantity.SHARE: "rmse",
    Quantity.IDENTITY: "mismatch_rate",
    Quantity.SCALAR: "rmse",
}

#: Metrics that fall as the error grows, so that a tolerance is their least value.
LARGER_IS_BETTER: Final = frozenset({"psnr", "ssim"})

#: Unit of a quantity's own error.
UNITS: Final[dict[Quantity, str]] = dict.fromkeys(Quantity, "") | {Quantity.NORMAL: "degrees"}


def unit(quantity: Quantity, metric: str) -> str:
    """Unit of a metric: ``degrees``, ``ulp``, ``dB``, ``texels``, or nothing for a share or the values' own unit."""
    if metric.endswith("_ulp"):
        return "ulp"
    own = {"psnr": "dB", NOT_FINITE: "texels", "max_length": ""}
    return own.get(metric, UNITS[quantity])
