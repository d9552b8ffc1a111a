"""The error of single values: absolute, relative, in units in the last place, an angle, a mismatch.

Every function takes ``judged`` and ``truth`` as float64[..., channels] of equal shape. The same value in both has the
error 0, NaN and infinities included; a value that is no finite number where the other is another has an infinite error.
"""

from __future__ import annotations

from math import inf

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]


def absolute_error(judged: F64, truth: F64) -> F64:
    """``|judged - truth|``, float64[..., channels]."""
    with np.errstate(invalid="ignore", over="ignore"):
        return _settled(np.abs(judged - truth), judged, truth)


def relative_error(judged: F64, truth: F64) -> F64:
    """``|judged - truth| / |truth|``, float64[..., channels]; infinite where only the truth is 0.

    Of a reversed depth with the far plane at infinity (``near / z``) it is the relative error of ``z``, to first order.
    """
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        return _settled(np.abs(judged - truth) / np.abs(truth), judged, truth)


def ulp_distance(judged: F64, truth: F64) -> F64:
    """How many float32 lie between, float64[..., channels]: 1 for neighbours, 0 for +0 and -0.

    Both are rounded to float32, whose bit patterns, the negative ones mirrored, are whole numbers in the order of the
    values (Dawson 2012, "Comparing floating point numbers"): their difference counts across zero too.
    """
    return _settled(np.abs(_rank(judged) - _rank(truth)).astype(np.float64), judged, truth)


def angular_error(judged: F64, truth: F64) -> F64:
    """Degrees between vectors, float64[..., 1] in 0..180, whatever their lengths.

    ``atan2(|a x b|, a . b)``: the arc cosine of the dot product loses half the digits near 0 and 180 (Kahan 2006, "How
    futile are mindless assessments of roundoff", section 12). No vector has the direction of a zero vector: 180.

    :raises ValueError: for other than three channels.
    """
    if judged.shape[-1] != 3:
        raise ValueError(f"a normal has 3 channels, not {judged.shape[-1]}")
    (ax, ay, az), (bx, by, bz) = a, b = _scaled(judged), _scaled(truth)
    with np.errstate(invalid="ignore"):
        cross = np.sqrt((ay * bz - az * by) ** 2 + (az * bx - ax * bz) ** 2 + (ax * by - ay * bx) ** 2)
        degrees = np.degrees(np.arctan2(cross, ax * bx + ay * by + az * bz))
    lost = (np.abs(a).max(axis=0) == 0) != (np.abs(b).max(axis=0) == 0)
    found: F64 = np.where(lost, 180.0, degrees)
    if not np.isfinite(found).all():
        same = _agree(judged, truth).all(axis=-1)
        finite = np.asarray((np.isfinite(judged) & np.isfinite(truth)).all(axis=-1))
        found = np.where(same, 0.0, np.where(finite, found, inf))
    return found[..., None]


def length_error(judged: F64, truth: F64) -> F64:
    """``| |judged| - |truth| |`` of vectors, float64[..., 1]: what no angle shows of a normal left unnormalised."""
    return absolute_error(np.linalg.norm(judged, axis=-1, keepdims=True), np.linalg.norm(truth, axis=-1, keepdims=True))


def mismatch(judged: F64, truth: F64) -> F64:
    """1 where any channel differs and 0 elsewhere, float64[..., 1]."""
    return np.asarray((~_agree(judged, truth)).any(axis=-1, keepdims=True), np.float64)


def not_finite(judged: F64, truth: F64) -> npt.NDArray[np.bool_]:
    """bool[...]: where a channel of ``judged`` is NaN or infinite and the truth's is not the same."""
    if np.isfinite(judged).all():
        return np.zeros(judged.shape[:-1], np.bool_)
    return np.asarray((~np.isfinite(judged) & ~_agree(judged, truth)).any(axis=-1))


def _agree(judged: F64, truth: F64) -> npt.NDArray[np.bool_]:
    agree: npt.NDArray[np.bool_] = (judged == truth) | (np.isnan(judged) & np.isnan(truth))
    return agree


def _settled(error: F64, judged: F64, truth: F64) -> F64:
    """The error with the cases that arithmetic does not know: 0 where both agree, infinite where one is not finite."""
    if np.isfinite(error).all() and np.isfinite(judged).all() and np.isfinite(truth).all():
        return error
    known = np.isfinite(judged) & np.isfinite(truth) & ~np.isnan(error)
    return np.where(_agree(judged, truth), 0.0, np.where(known, error, inf))


def _rank(values: F64) -> npt.NDArray[np.int64]:
    """Each value's place among the float32, 0 for both zeros."""
    with np.errstate(over="ignore", invalid="ignore"):
        bits = values.astype(np.float32).view(np.int32).astype(np.int64)
    return np.where(bits < 0, -(bits & 0x7FFFFFFF), bits)


def _scaled(vectors: F64) -> F64:
    """The vectors' components first, [3, ...], scaled to a largest of 1, so that squares of tiny and huge vectors stay
    in range; zero stays zero, and what is not finite becomes NaN.
    """
    parts = np.ascontiguousarray(np.moveaxis(vectors, -1, 0))
    largest = np.abs(parts).max(axis=0)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        scaled: F64 = parts / np.where(largest == 0, 1.0, largest)
    return scaled
