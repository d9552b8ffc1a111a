"""FLIP in float64 from its papers, to hold the evaluator against: plain two-dimensional sums, nothing separated.

LDR: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom and Fairchild 2020, "FLIP: a difference evaluator for
alternating images", Proc. ACM Computer Graphics and Interactive Techniques 3(2). HDR: Andersson, Nilsson, Shirley and
Akenine-Moller 2021, "Visualizing errors in rendered high dynamic range images", Eurographics short papers.
"""

from __future__ import annotations

from math import ceil, pi, sqrt

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]

# Contrast sensitivity of each opponent channel: g(x) = sum of a sqrt(pi/b) exp(-pi^2 x^2 / b)
SENSITIVITY = {
    "achromatic": ((1.0, 0.0047), (0.0, 1e-5)),
    "red_green": ((1.0, 0.0053), (0.0, 1e-5)),
    "blue_yellow": ((34.1, 0.04), (13.5, 0.025)),
}
Q_C, P_C, P_T = 0.7, 0.4, 0.95  # colour differences
Q_F, FEATURE_WIDTH = 0.5, 0.082  # feature differences; degrees

# Linear sRGB to XYZ, IEC 61966-2-1 chromaticities worked out exactly.
TO_XYZ = np.array(
    [
        [10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
        [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
        [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382],
    ]
)
WHITE = TO_XYZ.sum(axis=1)  # D65


def flip_map(judged: F64, truth: F64, pixels_per_degree: float) -> F64:
    """FLIP of each pixel, float64[h, w], for sRGB images float64[h, w, 3] in 0..1."""
    a, b = _opponent(_linear(judged)), _opponent(_linear(truth))
    colour = _colour_difference(a, b, pixels_per_degree)
    feature = _feature_difference(a, b, pixels_per_degree)
    return colour ** (1.0 - feature)


def hdr_flip_map(judged: F64, truth: F64, pixels_per_degree: float, exposures: tuple[float, float, int]) -> F64:
    """The largest LDR-FLIP of each pixel over exposures (first and last stop, count) of linear images, tone-mapped by
    Narkowicz's fit of ACES.
    """
    first, last, count = exposures
    maps = []
    for stop in np.linspace(first, last, count):
        shown = []
        for image in (judged, truth):
            x = 0.6 * image * 2.0**stop
            shown.append(_opponent(np.clip((2.51 * x * x + 0.03 * x) / (2.43 * x * x + 0.59 * x + 0.14), 0.0, 1.0)))
        colour = _colour_difference(*shown, pixels_per_degree)
        maps.append(colour ** (1.0 - _feature_difference(*shown, pixels_per_degree)))
    return np.max(maps, axis=0)


def colour_share(distance: float) -> float:
    """What a HyAB distance of uniform images counts as: the small ones take 0..P_T, the large ones the rest."""
    return float(_redistributed(np.array(distance**Q_C)))


def _colour_difference(a: F64, b: F64, pixels_per_degree: float) -> F64:
    kernels = [_sensitivity_kernel(terms, pixels_per_degree) for terms in SENSITIVITY.values()]
    seen = []
    for image in (a, b):
        filtered = np.stack([_filter(image[..., i], kernel) for i, kernel in enumerate(kernels)], axis=-1)
        seen.append(_hunt(_lab(np.clip(_from_opponent(filtered), 0.0, 1.0))))
    return _redistributed(_hyab(*seen) ** Q_C)


def _redistributed(powered: F64) -> F64:
    green, blue = (_hunt(_lab(np.array(colour))) for colour in ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    largest = _hyab(green, blue) ** Q_C
    knee = P_C * largest
    above = P_T + (powered - knee) / (largest - knee) * (1.0 - P_T)
    return np.where(powered < knee, powered * P_T / knee, above)


def _feature_difference(a: F64, b: F64, pixels_per_degree: float) -> F64:
    sigma = 0.5 * FEATURE_WIDTH * pixels_per_degree
    radius = ceil(3 * sigma)
    x = np.arange(-radius, radius + 1)[None, :]
    y = x.T
    gauss = np.exp(-(x**2 + y**2) / (2 * sigma**2))
    differences = []
    for kernel in (-x * gauss, (x**2 / sigma**2 - 1) * gauss):  # edges, points
        kernel = np.where(kernel < 0, kernel / -kernel[kernel < 0].sum(), kernel / kernel[kernel > 0].sum())
        size = [
            np.hypot(_filter(grey, kernel), _filter(grey, kernel.T))
            for grey in ((image[..., 0] + 16) / 116 for image in (a, b))
        ]
        differences.append(np.abs(size[0] - size[1]))
    return (np.maximum(*differences) / sqrt(2)) ** Q_F


def _sensitivity_kernel(terms: tuple[tuple[float, float], ...], pixels_per_degree: float) -> F64:
    widest = max(b for channel in SENSITIVITY.values() for _, b in channel)
    radius = ceil(3 * sqrt(widest / (2 * pi**2)) * pixels_per_degree)
    x = np.arange(-radius, radius + 1) / pixels_per_degree
    squared = x[None, :] ** 2 + x[:, None] ** 2
    kernel: F64 = sum(a * sqrt(pi / b) * np.exp(-(pi**2) * squared / b) for a, b in terms)
    return kernel / kernel.sum()


def _filter(field: F64, kernel: F64) -> F64:
    """Correlation with the edge texels repeated outwards."""
    radius = kernel.shape[0] // 2
    padded = np.pad(field, radius, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, kernel.shape)
    return np.einsum("hwyx,yx->hw", windows, kernel)


def _linear(encoded: F64) -> F64:
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def _opponent(linear: F64) -> F64:
    """Y'CxCz, a linear relative of L*a*b*."""
    x, y, z = np.moveaxis(linear @ TO_XYZ.T / WHITE, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def _from_opponent(opponent: F64) -> F64:
    y = (opponent[..., 0] + 16) / 116
    xyz = np.stack([y + opponent[..., 1] / 500, y, y - opponent[..., 2] / 200], axis=-1) * WHITE
    return xyz @ np.linalg.inv(TO_XYZ).T


def _lab(linear: F64) -> F64:
    ratios = linear @ TO_XYZ.T / WHITE
    delta = 6 / 29
    f = np.where(ratios > delta**3, np.cbrt(ratios), ratios / (3 * delta**2) + 4 / 29)
    x, y, z = np.moveaxis(f, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def _hunt(lab: F64) -> F64:
    """Colourfulness grows with luminance."""
    return np.stack([lab[..., 0], *(0.01 * lab[..., 0] * lab[..., i] for i in (1, 2))], axis=-1)


def _hyab(a: F64, b: F64) -> F64:
    """City-block in lightness, Euclidean in colour."""
    difference = a - b
    return np.abs(difference[..., 0]) + np.hypot(difference[..., 1], difference[..., 2])
