"""What all renderers draw: one file, camera, size and set of lights, as one line of JSON between processes."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass

import numpy as np
import numpy.typing as npt

Vec3 = tuple[float, float, float]


@dataclass(frozen=True)
class PointLight:
    """A point light: metres, linear rgb radiant intensity, reach in metres."""

    position: Vec3
    intensity: Vec3
    radius: float


@dataclass(frozen=True)
class Shot:
    """World space, Y up, metres; ``fov`` is vertical, radians; light and colours are linear Rec. 709."""

    scene: str
    size: tuple[int, int]
    position: Vec3
    target: Vec3
    fov: float
    sun_direction: Vec3  # the way the light travels
    sun_irradiance: Vec3
    ambient: Vec3  # radiance from all around
    points: tuple[PointLight, ...]

    def to_json(self) -> str:
        """One line."""
        return json.dumps(asdict(self))

    @staticmethod
    def from_json(text: str) -> Shot:
        """The inverse of :meth:`to_json`."""
        data = json.loads(text)
        points = tuple(PointLight(tuple(p["position"]), tuple(p["intensity"]), p["radius"]) for p in data.pop("points"))
        return Shot(points=points, **{key: tuple(v) if isinstance(v, list) else v for key, v in data.items()})


def look_at(position: Vec3, target: Vec3, up: Vec3 = (0.0, 1.0, 0.0)) -> npt.NDArray[np.float64]:
    """Object to world, ``float64[4, 4]``: -Z points at the target, as glTF cameras and lights look."""
    back = np.subtract(position, target)
    back = back / np.linalg.norm(back)
    right = np.cross(up, back)
    right = right / np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :] = np.stack([right, np.cross(back, right), back, np.asarray(position)], axis=1)
    return pose


def strength(rgb: Vec3) -> tuple[list[float], float]:
    """Colour with 1 as its largest channel, and the factor left out."""
    largest = max(*rgb, math.ulp(0.0))
    return [c / largest for c in rgb], largest
