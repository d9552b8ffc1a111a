"""What a scene's cameras can see, told from the bounds of its instances: conservative, for plans to rely on."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import product

import numpy as np
import numpy.typing as npt

from rendergraph.scene.cameras import view_matrix
from rendergraph.scene.coverage import covers_view
from rendergraph.scene.features import ViewFeatures
from rendergraph.scene.scene import F64, Alpha, Camera, Material, Scene

#: How much wider a view is taken than it is: more than rounding, sub-pixel snapping and a sample's place can move.
SLACK = 1.01
#: Of a box's largest coordinate: what float32 transforms may move its corners.
_ROUNDING = 1e-5
#: Instances times cameras beyond which nothing is claimed: planning must stay quick.
_MOST = 4_000_000
#: Cameras beyond which coverage, which looks at triangles, is not claimed.
_MOST_COVERED = 8

_FEATURES = ("opaque", "masked", "blended", "double_sided", "unlit", "emissive", "normal_mapped", "occlusion_mapped")


def view_features(scene: Scene, cameras: Iterable[Camera], aspect: float) -> ViewFeatures | None:
    """What holds for all of the cameras; ``aspect`` is width over height. None where there are too many to look at, or
    bounds are not finite.
    """
    distinct = list(dict.fromkeys(cameras))
    if not distinct or len(distinct) * max(1, len(scene.instances) + len(scene.lights)) > _MOST:
        return None
    corners = box_corners(scene)
    if not np.isfinite(corners).all():
        return None
    rounding = _rounding(corners)
    skinned = np.array([i.skin is not None for i in scene.instances], dtype=bool)
    seen = np.zeros(len(corners), dtype=bool)
    lit, near, far = False, math.inf, 0.0
    for camera in distinct:
        planes = frustum_planes(camera, aspect)
        inside = _touching(corners, planes, rounding) | skinned
        seen |= inside
        lit = lit or _any_light(scene, planes)
        depths = -(corners[inside] @ view_matrix(camera)[2, :3] + view_matrix(camera)[2, 3])  # [n, 8]
        if len(depths):
            near = min(near, float((depths.min(axis=1) - rounding[inside]).min()))
            far = max(far, float((depths.max(axis=1) + rounding[inside]).max()))
    planes_near = min(camera.near for camera in distinct)
    return ViewFeatures(
        unseen=frozenset(_unseen(scene, seen)),
        lit=lit,
        casters=_casters(scene, corners, seen),
        depth_range=None if not seen.any() or skinned.any() else _octaves(max(near, planes_near), far),
        near=planes_near,
        covered=len(distinct) <= _MOST_COVERED and all(covers_view(scene, camera, aspect) for camera in distinct),
    )


def box_corners(scene: Scene) -> F64:
    """World corners of each instance's bounds, float64[instances, 8, 3]."""
    if not scene.instances:
        return np.zeros((0, 8, 3))
    meshes = [scene.meshes[i.mesh] for i in scene.instances]
    box = np.array([[m.bounds_min, m.bounds_max] for m in meshes], dtype=np.float64)  # [n, 2, 3]
    choose = np.array(list(product((0, 1), repeat=3)))  # [8, 3]
    local = box[:, choose, np.arange(3)]  # [n, 8, 3]
    worlds = np.stack([i.world for i in scene.instances])
    world: F64 = np.einsum("nij,nkj->nki", worlds[:, :3, :3], local) + worlds[:, None, :3, 3]
    return world


def _rounding(corners: F64) -> F64:
    """How far float32 transforms may move the corners of each box, float64[n]."""
    if len(corners) == 0:
        return np.zeros(0)
    largest: F64 = np.abs(corners).max(axis=(1, 2))
    return largest * _ROUNDING


def frustum_planes(camera: Camera, aspect: float) -> F64:
    """Inward unit planes of the widened view, float64[p, 4]: ``n . x + d >= 0`` inside; four sides, near, and far."""
    view = view_matrix(camera)
    right, up, back = view[:3, :3]
    eye = np.asarray(camera.position, dtype=np.float64)
    tangent = math.tan(camera.fov / 2) * SLACK
    # A point is inside a side when its offset along the side's axis is at most `tangent` times its depth.
    normals = [
        -back * tangent * aspect - right,
        -back * tangent * aspect + right,
        -back * tangent - up,
        -back * tangent + up,
    ]
    planes = [[*n, -n @ eye] for n in (n / np.linalg.norm(n) for n in normals)]
    planes.append([*-back, back @ eye - camera.near / SLACK])
    if camera.far is not None:
        planes.append([*back, -back @ eye + camera.far * SLACK])
    return np.array(planes)


def _touching(corners: F64, planes: F64, rounding: F64) -> npt.NDArray[np.bool_]:
    """Boxes that do not lie wholly outside of one plane, bool[n]."""
    sides = np.einsum("nki,pi->npk", corners, planes[:, :3]) + planes[:, 3][:, None]
    touching: npt.NDArray[np.bool_] = (sides.max(axis=2) >= -rounding[:, None]).all(axis=1)
    return touching


def _any_light(scene: Scene, planes: F64) -> bool:
    """Whether some light's sphere, or the ring that it sweeps, touches the view."""
    for light in scene.lights:
        if any(light.intensity) and light.radius > 0.0:
            reach = (light.radius + abs(light.circle)) * SLACK
            if (planes[:, :3] @ np.asarray(light.position) + planes[:, 3] >= -reach).all():
                return True
    return False


def _has(material: Material, feature: str) -> bool:
    queue = {"opaque": Alpha.OPAQUE, "masked": Alpha.MASKED, "blended": Alpha.BLENDED}
    if feature in queue:
        return material.alpha is queue[feature]
    if feature == "emissive":
        return any(material.emissive)
    if feature in ("normal_mapped", "occlusion_mapped"):
        return (material.normal_texture if feature == "normal_mapped" else material.occlusion_texture) is not None
    return bool(getattr(material, feature))


def _unseen(scene: Scene, seen: npt.NDArray[np.bool_]) -> Iterable[str]:
    """Features of the scene that no instance in view has."""
    used = [scene.meshes[i.mesh].material for i in scene.instances]
    visible = {material for material, shown in zip(used, seen, strict=True) if shown}
    for feature in _FEATURES:
        having = {material for material in set(used) if _has(scene.materials[material], feature)}
        if having and not having & visible:
            yield feature


def _casters(scene: Scene, corners: F64, seen: npt.NDArray[np.bool_]) -> bool:
    """Whether something solid may lie nearer to the sun than what is in view.

    How far a shadow filter reaches sideways depends on the map's size, so everything counts that is not farther from
    the sun than all that is in view: it may be beside the view.
    """
    if scene.sun is None or not seen.any():
        return False
    alphas = [scene.materials[scene.meshes[i.mesh].material].alpha for i in scene.instances]
    solid = np.array([alpha is not Alpha.BLENDED for alpha in alphas], dtype=bool)
    if not solid.any():
        return False
    if any(i.skin is not None for i in scene.instances):
        return True
    towards = -np.asarray(scene.sun.direction, dtype=np.float64)
    heights = corners @ (towards / np.linalg.norm(towards))
    margin = 1e-3 * float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    return bool(heights[solid].max() >= heights[seen].min() - margin)


def _octaves(near: float, far: float) -> tuple[float, float]:
    """Widened to powers of two."""
    return 2.0 ** math.floor(math.log2(near)), 2.0 ** math.ceil(math.log2(max(far, near)))
