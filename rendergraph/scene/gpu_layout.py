"""Scene data as bytes for the GPU: numpy dtypes that mirror shaders/scene.glsl and shaders/lights.glsl (std430)."""

from __future__ import annotations

import math

import numpy as np

from rendergraph.scene.scene import F64, Alpha, Material, Scene, TextureUse
from rendergraph.scene.texture_arrays import TextureArrayLayers, TexturePlacement, place_textures

__all__ = [
    "INSTANCE",
    "LIGHT",
    "MATERIAL",
    "NO_TEXTURE",
    "TEXTURE_REF",
    "TextureArrayLayers",
    "TexturePlacement",
    "mirrored",
    "normal_matrix",
    "pack_instances",
    "pack_lights",
    "pack_materials",
    "place_textures",
]

_VEC4 = (np.float32, (4,))

#: ``struct Instance``, 128 bytes.
INSTANCE = np.dtype(
    [
        ("world", np.float32, (4, 4)),
        ("normal", np.float32, (3, 4)),
        ("material", np.uint32),
        ("flags", np.uint32),
        ("object", np.uint32),
        ("reserved", np.uint32),
    ]
)

#: ``struct TextureRef``, 32 bytes.
TEXTURE_REF = np.dtype(
    [("array", np.uint32), ("layer", np.uint32), ("uv_set", np.uint32), ("wrap", np.uint32), ("transform", *_VEC4)]
)

#: ``struct Material``, 256 bytes.
MATERIAL = np.dtype(
    [
        ("base_color", *_VEC4),
        ("emissive", *_VEC4),
        ("factors", *_VEC4),
        ("flags", np.uint32),
        ("reserved", np.uint32, (3,)),
        ("rotation", np.float32, (8,)),
        ("textures", TEXTURE_REF, (5,)),
    ]
)

#: ``struct Light``, 64 bytes.
LIGHT = np.dtype([("position_radius", *_VEC4), ("intensity", *_VEC4), ("axis_outer", *_VEC4), ("inner", *_VEC4)])

NO_TEXTURE = 0xFFFFFFFF
MIRRORED = 1
MASKED, BLENDED, DOUBLE_SIDED, UNLIT = 1, 2, 4, 8
MINIMUM_DISTANCE = 0.01  # d0 of docs/conventions.md, metres
_POINT = -2.0  # below any cosine: a point light has no cone


def pack_instances(scene: Scene) -> bytes:
    """``INSTANCE[instances]``; one zeroed dummy when there are none. ``world`` is written column-major."""
    packed = np.zeros(max(1, len(scene.instances)), dtype=INSTANCE)
    for index, instance in enumerate(scene.instances):
        row = packed[index]
        row["world"] = instance.world.T
        row["normal"][:, :3] = normal_matrix(instance.world)
        row["material"] = scene.meshes[instance.mesh].material
        row["flags"] = MIRRORED if mirrored(instance.world) else 0
        row["object"] = index
    return packed.tobytes()


def mirrored(world: F64) -> bool:
    """Whether the transform turns a right hand into a left one."""
    return bool(np.linalg.det(world[:3, :3]) < 0)


def normal_matrix(world: F64) -> F64:
    """The inverse transpose of the upper left 3x3, ``float64[3, 3]``, always finite in float32.

    A transform without an inverse has no such matrix, but its cofactors (the inverse transpose times the determinant)
    exist and still give the normals of what is left of it; they are scaled to largest entry 1. A transform that leaves
    not even a plane gets the identity.
    """
    m = world[:3, :3]
    scale = np.abs(m).max()
    if not np.isfinite(scale) or scale == 0:
        return np.eye(3)
    m = m / scale
    cofactors = np.stack([np.cross(m[1], m[2]), np.cross(m[2], m[0]), np.cross(m[0], m[1])])
    determinant = float(m[0] @ cofactors[0])
    largest = float(np.abs(cofactors).max())
    if largest < 1e-30:
        return np.eye(3)
    if abs(determinant) * scale * 1e15 > largest:  # the inverse transpose stays below 1e15
        inverse_transpose: F64 = cofactors / (determinant * scale)
        return inverse_transpose
    scaled: F64 = cofactors / math.copysign(largest, determinant)
    return scaled


def pack_materials(scene: Scene, placement: TexturePlacement) -> bytes:
    """``MATERIAL[materials]``; one zeroed dummy when there are none."""
    packed = np.zeros(max(1, len(scene.materials)), dtype=MATERIAL)
    packed["textures"]["array"] = NO_TEXTURE
    for row, material in zip(packed, scene.materials, strict=False):
        row["base_color"] = material.base_color
        row["emissive"] = (*material.emissive, material.alpha_cutoff)
        row["factors"] = (
            material.metallic, material.roughness, material.normal_scale, material.occlusion_strength,
        )  # fmt: skip
        row["flags"] = _flags(material)
        for slot, use in enumerate(material.textures):
            place = None if use is None else placement.ref(use.image)
            if use is not None and place is not None:
                row["textures"][slot] = _texture_ref(use, place)
                row["rotation"][slot] = use.rotation
    return packed.tobytes()


def _flags(material: Material) -> int:
    return (
        (MASKED if material.alpha is Alpha.MASKED else 0)
        | (BLENDED if material.alpha is Alpha.BLENDED else 0)
        | (DOUBLE_SIDED if material.double_sided else 0)
        | (UNLIT if material.unlit else 0)
    )


def _texture_ref(use: TextureUse, place: tuple[int, int]) -> tuple[int, int, int, int, tuple[float, ...]]:
    return (*place, use.uv_set, int(use.wrap[0]) | int(use.wrap[1]) << 2, (*use.offset, *use.scale))


def pack_lights(scene: Scene, turn: float = 0.0) -> bytes:
    """``LIGHT[lights]``; one black dummy when there are none, so that the buffer is never empty.

    ``turn``: how much of their circles moving lights have run.
    """
    packed = np.zeros(max(1, len(scene.lights)), dtype=LIGHT)
    packed["intensity"][:, 3] = MINIMUM_DISTANCE
    packed["axis_outer"][:] = (0.0, -1.0, 0.0, _POINT)
    for row, light in zip(packed, scene.lights, strict=False):
        row["position_radius"] = (*light.position_at(turn), light.radius)
        row["intensity"][:3] = light.intensity
        if light.outer is not None:
            axis = np.asarray(light.axis, dtype=np.float64)
            length = float(np.linalg.norm(axis))
            row["axis_outer"][:3] = axis / length if length > 0 else (0.0, -1.0, 0.0)
            row["axis_outer"][3] = math.cos(light.outer)
            row["inner"][0] = math.cos(min(light.inner, light.outer))
    return packed.tobytes()
