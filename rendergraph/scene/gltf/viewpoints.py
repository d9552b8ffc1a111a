"""What nodes carry beside meshes: cameras (glTF 2.0, 3.10) and lights (KHR_lights_punctual)."""

from __future__ import annotations

import math

import numpy as np

from rendergraph.scene.gltf.document import Document
from rendergraph.scene.gltf.items import Item
from rendergraph.scene.scene import F64, Camera, Light, Sun

Vec3 = tuple[float, float, float]

#: A light without a range ends where its irradiance falls below this.
IRRADIANCE_CUTOFF = 0.02


def read_camera(item: Item, world: F64, node: str, document: Document) -> Camera | None:
    """A perspective camera at its node, looking down the node's -z; none (and a note) for an orthographic one."""
    kind = item.require("type")
    if kind.as_text() == "orthographic":
        document.note(f"{item.path} is orthographic and was skipped")
        return None
    if kind.as_text() != "perspective":
        raise kind.wrong("perspective or orthographic")
    lens = item.require("perspective")
    near = lens.require("znear").as_number(1e-9)
    far = lens.get("zfar")
    if far is not None and far.as_number() <= near:
        raise far.wrong(f"a number above znear, {near:g}")
    position = _vector(world[:3, 3])
    forward = _unit(-world[:3, 2], (0.0, 0.0, -1.0))
    return Camera(
        position=position,
        target=(position[0] + forward[0], position[1] + forward[1], position[2] + forward[2]),
        up=_unit(world[:3, 1], (0.0, 1.0, 0.0)),
        fov=lens.require("yfov").as_number(1e-3, math.pi - 1e-3),
        near=near,
        far=None if far is None else far.as_number(),
        name=item.text("name"),
        node=node,
    )


def read_light(item: Item, world: F64) -> Light | Sun:
    """A light placed by its node, travelling along the node's -z. Candela and lux are taken as scene-linear units."""
    kind = item.require("type")
    if kind.as_text() not in ("directional", "point", "spot"):
        raise kind.wrong("directional, point or spot")
    red, green, blue = item.numbers("color", (1.0, 1.0, 1.0), 0.0)
    intensity = item.number("intensity", 1.0, 0.0, 1e18)
    color = (red * intensity, green * intensity, blue * intensity)
    axis = _unit(-world[:3, 2], (0.0, 0.0, -1.0))
    if kind.as_text() == "directional":
        return Sun(axis, color)
    reach = item.get("range")
    radius = cutoff_radius(color) if reach is None else reach.as_number(1e-6)
    position = _vector(world[:3, 3])
    if kind.as_text() == "point":
        return Light(position, color, radius)
    cone = item.require("spot")
    outer = cone.number("outerConeAngle", math.pi / 4, 1e-6, math.pi / 2)
    return Light(position, color, radius, axis, cone.number("innerConeAngle", 0.0, 0.0, outer), outer)


def cutoff_radius(intensity: Vec3) -> float:
    """The distance in metres at which the unwindowed irradiance is ``IRRADIANCE_CUTOFF``; a centimetre at least."""
    return max(math.sqrt(max(intensity) / IRRADIANCE_CUTOFF), 0.01)


def _vector(values: F64) -> Vec3:
    x, y, z = (float(v) for v in values)
    return x, y, z


def _unit(values: F64, otherwise: Vec3) -> Vec3:
    """The direction of a vector; ``otherwise`` where a node scaled to nothing has none."""
    length = float(np.linalg.norm(values))
    return _vector(values / length) if length > 1e-30 else otherwise
