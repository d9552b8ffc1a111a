"""What judging a pass finds out: a judgement for each measure of its reference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from rendergraph.measure.metrics.table import LARGER_IS_BETTER
from rendergraph.node.reference import Quantity

F64 = npt.NDArray[np.float64]
Verdict = Literal["within", "above", "cannot_judge"]


@dataclass(frozen=True, slots=True)
class WorstTexel:
    """Where a measure is furthest off: ``x``, ``y`` from the lower left of what was judged (the layers of an array
    stand above each other), the error there by the quantity's own map, both values, and what the inputs of that size
    hold there, by port.
    """

    x: int
    y: int
    error: float
    judged: tuple[float, ...]
    true: tuple[float, ...]
    inputs: Mapping[str, tuple[float, ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Pictures:
    """What was compared, float64[h, w, c] each with rows bottom-up, and bool[h, w], True where the truth is known;
    of a random pass the means over frames, and the ``variance`` of a frame's deviation from the truth.
    """

    judged: F64
    truth: F64
    mask: npt.NDArray[np.bool_] | None
    variance: F64 | None = None


@dataclass(frozen=True, slots=True)
class ZScore:
    """The outcome of a z-test over ``frames`` frames: the share of texels whose mean agrees with the truth, the share
    that must, and the two-sided significance left for one texel after Sidak's correction.
    """

    frames: int
    accepted: float
    required: float
    alpha_texel: float
    largest: float  # the largest z


@dataclass(frozen=True, slots=True)
class Judgement:
    """One measure of one pass, judged. ``metrics`` are all of the quantity's, ``value`` is the one named ``metric``,
    which is held against ``tolerance`` (None: infinite and good, such as the PSNR of equal images).

    ``masked`` is the share of texels whose truth is unknown; ``standard_error`` the truth's own error at 3 sigma, in
    terms of the metric; ``reason`` why the verdict is not plain: ``not_finite``, ``standard_error``, ``all_masked``,
    ``z_test``. ``seconds`` is what the reference took when it ran, ``cached`` whether it was spared now.
    """

    pass_name: str
    node: str
    measure: str
    quantity: Quantity
    metrics: Mapping[str, float | None]
    metric: str
    value: float | None
    tolerance: float
    verdict: Verdict
    masked: float
    worst_texel: WorstTexel | None
    standard_error: float
    reason: str = ""
    port: str = ""
    unit: str = ""
    help: str = ""
    method: str = ""
    source: str = ""
    ideal: bool = True
    seconds: float = 0.0
    cached: bool = False
    z_test: ZScore | None = None
    pictures: Pictures | None = field(default=None, repr=False, compare=False)


def exceeds(metric: str, value: float | None, tolerance: float) -> bool:
    """Whether a metric's value is on the wrong side of its tolerance, which is the least allowed for metrics of which
    more is better. None is infinite and good, NaN always wrong.
    """
    if value is None:
        return False
    return not (value >= tolerance if metric in LARGER_IS_BETTER else value <= tolerance)
