"""Normal packings and depth reconstruction in float64 numpy: the truth the shaders are measured against."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]


def octahedral_encode(n: F64) -> F64:
    """Unit vectors ``float64[k, 3]`` to the square [-1, 1]^2, ``float64[k, 2]`` (Cigolle et al. 2014)."""
    p = n / np.abs(n).sum(axis=1, keepdims=True)
    folded = (1.0 - np.abs(p[:, 1::-1])) * np.where(p[:, :2] >= 0.0, 1.0, -1.0)
    square: F64 = np.where(p[:, 2:] >= 0.0, p[:, :2], folded)
    return square


def octahedral_decode(e: F64) -> F64:
    """The square back to unit vectors."""
    z = 1.0 - np.abs(e).sum(axis=1)
    folded = (1.0 - np.abs(e[:, ::-1])) * np.where(e >= 0.0, 1.0, -1.0)
    n = np.column_stack([np.where(z[:, None] >= 0.0, e, folded), z])
    unit: F64 = n / np.linalg.norm(n, axis=1, keepdims=True)
    return unit


def quantise_unorm(x: F64, bits: int) -> F64:
    """[-1, 1] stored as 0.5 + 0.5 x in an unsigned normalised channel, and read back."""
    top = 2.0**bits - 1.0
    return np.round((x * 0.5 + 0.5) * top) / top * 2.0 - 1.0


def angle_degrees(a: F64, b: F64) -> F64:
    """Angle between unit vectors, degrees; accurate for small angles (``atan2`` of sine and cosine)."""
    degrees: F64 = np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.sum(a * b, axis=1)))
    return degrees


def sphere(count: int, seed: int = 0) -> F64:
    """``count`` random directions, and the poles, axes and octants' edges where packings break, ``float64[k, 3]``."""
    random = np.random.default_rng(seed).normal(size=(count, 3))
    signs = np.array([-1.0, 0.0, 1.0])
    lattice = np.stack(np.meshgrid(signs, signs, signs), axis=-1).reshape(-1, 3)
    special = lattice[np.abs(lattice).sum(axis=1) > 0]
    near_poles = np.array([[x * 1e-4, y * 1e-4, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    every = np.concatenate([random, special, near_poles])
    unit: F64 = every / np.linalg.norm(every, axis=1, keepdims=True)
    return unit


def view_z(depth: F64, projection: F64) -> F64:
    """View-space z, metres, of depth-buffer values, by inverting ``projection`` (``float64[4, 4]``, view to clip)."""
    inverse = np.linalg.inv(projection)
    clip = np.stack([np.zeros_like(depth), np.zeros_like(depth), depth, np.ones_like(depth)], axis=-1)
    view = clip @ inverse.T
    z: F64 = view[..., 2] / view[..., 3]
    return z
