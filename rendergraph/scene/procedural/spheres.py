"""A grid of spheres: metallic grows upwards, roughness to the right, on a matt ground."""

from __future__ import annotations

import numpy as np

from rendergraph.scene.procedural.geometry import Geometry
from rendergraph.scene.procedural.mesh_builder import SceneBuilder, placement
from rendergraph.scene.procedural.patterns import chequer
from rendergraph.scene.procedural.shapes import sheet, sphere
from rendergraph.scene.procedural.tessellation import even_segments
from rendergraph.scene.scene import Ambient, Camera, Light, Material, Scene, Sun

COLUMNS, ROWS = 7, 5
_RADIUS, _PITCH = 0.45, 1.05


def spheres(detail: float, seed: int) -> Scene:
    """7 x 5 spheres of one colour, roughness 0.05..1 to the right, metallic 0..1 upwards.

    Nothing in it is random but the ground's grain.
    """
    rng = np.random.default_rng(seed)
    builder = SceneBuilder("spheres")
    around = even_segments(detail, 12, 72)
    ball: Geometry = sphere(_RADIUS, around, around // 2)
    height = _RADIUS + 0.05
    first: int | None = None
    for row in range(ROWS):
        for column in range(COLUMNS):
            metallic, roughness = row / (ROWS - 1), 0.05 + 0.95 * column / (COLUMNS - 1)
            name = f"metallic {metallic:.2f} roughness {roughness:.2f}"
            material = builder.material(Material(name, (0.93, 0.42, 0.25, 1.0), metallic=metallic, roughness=roughness))
            mesh = builder.mesh(ball, material) if first is None else builder.recoloured(first, material)
            first = mesh if first is None else first
            builder.place(mesh, placement((column - (COLUMNS - 1) / 2) * _PITCH, height + row * _PITCH), name)

    ground = builder.material(Material("ground", metallic=0.0), chequer(rng, 512 if detail > 0.5 else 256))
    plane = sheet((-8.0, 0.0, 8.0), (16.0, 0.0, 0.0), (0.0, 0.0, -16.0), (8, 8)).mapped(0.5)
    builder.place(builder.mesh(plane, ground), name="ground")

    scene = builder.build()
    middle = height + (ROWS - 1) / 2 * _PITCH
    scene.cameras.append(
        Camera((0.0, middle + 0.4, 8.6), (0.0, middle - 0.15, 0.0), fov=float(np.radians(42.0)), name="main")
    )
    direction = np.array([-0.5, -0.75, -0.65])
    x, y, z = direction / np.linalg.norm(direction)
    scene.sun = Sun((float(x), float(y), float(z)), (4.0, 3.85, 3.6))
    scene.ambient = Ambient((0.30, 0.36, 0.45), (0.14, 0.13, 0.12))
    scene.lights += [
        Light((-4.5, 4.5, 3.5), (6.0, 9.0, 14.0), radius=14.0),
        Light((4.5, 1.0, 4.0), (9.0, 5.0, 3.0), radius=12.0),
    ]
    return scene
