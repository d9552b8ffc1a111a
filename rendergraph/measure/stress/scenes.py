"""Scenes at the extremes, made from any scene: each takes a loaded scene and gives another, the first is untouched."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from rendergraph.measure.stress.degenerate import degenerate_triangles
from rendergraph.scene.load import LoadedScene
from rendergraph.scene.procedural.mesh_builder import placement
from rendergraph.scene.scatter import scatter_lights
from rendergraph.scene.scene import F64, Alpha, Ambient, Light, Material, Sun

Vector = tuple[float, float, float]

# ---- the camera


def depth_range(loaded: LoadedScene, *, near: float, far: float | None) -> LoadedScene:
    """Other clip planes, metres; ``far`` None for infinity."""
    return replace(loaded, camera=replace(loaded.camera, near=near, far=far))


def field_of_view(loaded: LoadedScene, *, degrees: float) -> LoadedScene:
    """Another vertical field of view."""
    return replace(loaded, camera=replace(loaded.camera, fov=math.radians(degrees)))


def inside_geometry(loaded: LoadedScene) -> LoadedScene:
    """The camera in the middle of the smallest solid thing that it is large enough to be in, looking along +x."""
    scene = loaded.scene
    best: tuple[float, Vector] | None = None
    for instance in scene.instances:
        mesh = scene.meshes[instance.mesh]
        low, high = np.array(mesh.bounds_min), np.array(mesh.bounds_max)
        size = np.abs(instance.world[:3, :3]) @ (high - low)
        if size.min() > 2.0 * loaded.camera.near and (best is None or size.max() < best[0]):
            x, y, z = (instance.world @ np.array([*(low + high) / 2.0, 1.0]))[:3].tolist()
            best = float(size.max()), (x, y, z)
    if best is None:
        low, high = scene.bounds()
        x, y, z = ((low + high) / 2.0).tolist()
        best = 0.0, (x, y, z)
    x, y, z = best[1]
    return replace(loaded, camera=replace(loaded.camera, position=(x, y, z), target=(x + 1.0, y, z)))


# ---- placement


def moved(loaded: LoadedScene, *, metres: float) -> LoadedScene:
    """Everything that far from the origin along x and z, the camera with it."""
    return _transformed(loaded, placement(metres, 0.0, metres), 1.0)


def scaled(loaded: LoadedScene, *, factor: float) -> LoadedScene:
    """Everything that many times as large, the camera's planes with it: the picture of the first."""
    return _transformed(loaded, placement(scale=factor), factor)


def _transformed(loaded: LoadedScene, matrix: F64, factor: float) -> LoadedScene:
    def at(point: Vector) -> Vector:
        x, y, z = (matrix @ np.array([*point, 1.0]))[:3].tolist()
        return x, y, z

    scene, camera = loaded.scene, loaded.camera
    lights = [
        replace(
            light,
            position=at(light.position),
            radius=light.radius * factor,
            circle=light.circle * factor,
            intensity=_times(light.intensity, factor * factor),  # the same irradiance at the scaled distance
        )
        for light in scene.lights
    ]
    return replace(
        loaded,
        scene=replace(
            scene, instances=[replace(i, world=matrix @ i.world) for i in scene.instances], lights=lights
        ),
        camera=replace(
            camera,
            position=at(camera.position),
            target=at(camera.target),
            near=camera.near * factor,
            far=None if camera.far is None else camera.far * factor,
        ),
    )  # fmt: skip


# ---- geometry


def with_degenerate_triangles(loaded: LoadedScene) -> LoadedScene:
    """Triangles without area and slivers before the camera, with and without normals."""
    camera, scene = loaded.camera, loaded.scene
    eye, target = np.array(camera.position), np.array(camera.target)
    distance = max(8.0 * camera.near, min(1.0, float(np.linalg.norm(target - eye))))
    x, y, z = (eye + (target - eye) / max(float(np.linalg.norm(target - eye)), 1e-9) * distance).tolist()
    return replace(loaded, scene=degenerate_triangles(scene, placement(x, y, z, scale=distance / 2.0)))


def empty(loaded: LoadedScene) -> LoadedScene:
    """Nothing to draw and no lights but sun and sky."""
    return replace(loaded, scene=replace(loaded.scene, instances=[], lights=[]))


# ---- materials


def _materials(loaded: LoadedScene, **changes: object) -> LoadedScene:
    materials = [replace(material, **changes) for material in loaded.scene.materials]  # type: ignore[arg-type]
    return replace(loaded, scene=replace(loaded.scene, materials=materials))


def roughness(loaded: LoadedScene, *, value: float) -> LoadedScene:
    """All surfaces as smooth or rough as they get."""
    return _materials(loaded, roughness=value, metallic_roughness_texture=None)


def all_masked(loaded: LoadedScene) -> LoadedScene:
    """Every material is alpha-tested; half of them, with a base colour below the cutoff, vanish."""
    materials = [
        replace(m, alpha=Alpha.MASKED, alpha_cutoff=0.5, base_color=(*m.base_color[:3], (1.0, 0.25)[index % 2]))
        for index, m in enumerate(loaded.scene.materials)
    ]  # fmt: skip
    return replace(loaded, scene=replace(loaded.scene, materials=materials))


def emission(loaded: LoadedScene, *, radiance: float) -> LoadedScene:
    """Every surface emits that much."""
    return _materials(loaded, emissive=(radiance,) * 3, emissive_texture=None)


# ---- lights


def no_sun(loaded: LoadedScene) -> LoadedScene:
    """Without the sun."""
    return replace(loaded, scene=replace(loaded.scene, sun=None))


def no_lights(loaded: LoadedScene) -> LoadedScene:
    """Without point and spot lights."""
    return replace(loaded, scene=replace(loaded.scene, lights=[]))


def many_lights(loaded: LoadedScene, *, count: int) -> LoadedScene:
    """That many point lights all over the scene in place of its own."""
    low, high = loaded.scene.bounds()
    lights = scatter_lights(count, low, high, seed=1, intensity=1.0, radius=1.0, cutoff=0.02, circle=0.0)
    return replace(loaded, scene=replace(loaded.scene, lights=lights))


def light_radius(loaded: LoadedScene, *, metres: float) -> LoadedScene:
    """Lights of another reach."""
    return replace(
        loaded,
        scene=replace(loaded.scene, lights=[replace(light, radius=metres) for light in _some_lights(loaded)]),
    )


def intensity(loaded: LoadedScene, *, value: float) -> LoadedScene:
    """Sun, sky and lights that bright."""
    scene = loaded.scene
    lights = [replace(light, intensity=(value,) * 3) for light in _some_lights(loaded)]
    sun = scene.sun and replace(scene.sun, irradiance=(value,) * 3)
    return replace(loaded, scene=replace(scene, lights=lights, sun=sun, ambient=Ambient((value,) * 3, (value,) * 3)))


def _some_lights(loaded: LoadedScene) -> list[Light]:
    low, high = loaded.scene.bounds()
    return loaded.scene.lights[:64] or scatter_lights(
        8, low, high, seed=1, intensity=1.0, radius=None, cutoff=0.02, circle=0.0
    )


# ---- what light can be counted in


def furnace(loaded: LoadedScene, *, roughness: float, metallic: float) -> LoadedScene:
    """White surfaces under white light from everywhere: no radiance may be above 1 (Hill et al., the furnace test)."""
    scene = loaded.scene
    materials = [
        Material(m.name, metallic=metallic, roughness=roughness, alpha=m.alpha, double_sided=m.double_sided)
        for m in scene.materials
    ]
    lit = replace(scene, materials=materials, colors=np.ones_like(scene.colors), lights=[], sun=None)
    return replace(loaded, scene=replace(lit, ambient=Ambient((1.0, 1.0, 1.0), (1.0, 1.0, 1.0))))


def darkness(loaded: LoadedScene) -> LoadedScene:
    """No light at all: radiance is zero everywhere."""
    scene = _materials(loaded, emissive=(0.0, 0.0, 0.0), unlit=False).scene
    return replace(loaded, scene=replace(scene, lights=[], sun=None, ambient=None))


def dark_sun(loaded: LoadedScene) -> LoadedScene:
    """A sun that sends nothing."""
    return replace(loaded, scene=replace(loaded.scene, sun=Sun((0.0, -1.0, 0.0), (0.0, 0.0, 0.0))))


def _times(color: Vector, factor: float) -> Vector:
    red, green, blue = color
    return red * factor, green * factor, blue * factor
