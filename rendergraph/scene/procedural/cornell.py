"""The Cornell box, in metres: 5.55 m wide, its open side towards +z.

Geometry and walls after the measured data of the Cornell University Program of Computer Graphics (Goral, Torrance,
Greenberg and Battaile 1984; box dimensions as published with the measured spectra, 1998).
"""

from __future__ import annotations

import numpy as np

from rendergraph.scene.procedural.block import block
from rendergraph.scene.procedural.mesh_builder import SceneBuilder, placement
from rendergraph.scene.procedural.shapes import sheet
from rendergraph.scene.procedural.tessellation import segments
from rendergraph.scene.scene import Ambient, Camera, Light, Material, Scene

SIDE = 5.55
_LAMP = (1.30, 1.05)  # width and depth of the emissive quad
_RADIANCE = (17.0, 12.0, 4.0)


def cornell(detail: float, seed: int) -> Scene:
    """The box: five walls, two boxes, an emissive quad and below it the spot light that stands in for it.

    Nothing in it is random; ``seed`` is accepted and ignored. Faces point into the room. Only suns cast shadows, and
    there is none here: the boxes seem to float.
    """
    builder = SceneBuilder("cornell")
    white = builder.material(Material("white", (0.73, 0.73, 0.73, 1.0), metallic=0.0))
    red = builder.material(Material("red", (0.63, 0.065, 0.05, 1.0), metallic=0.0))
    green = builder.material(Material("green", (0.14, 0.45, 0.091, 1.0), metallic=0.0))
    lamp = builder.material(Material("lamp", (0.78, 0.78, 0.78, 1.0), metallic=0.0, emissive=_RADIANCE))

    half = SIDE / 2.0
    cells = segments(detail, 1, 16)
    grid = (cells, cells)
    walls = {
        "floor": (white, (-half, 0.0, half), (SIDE, 0.0, 0.0), (0.0, 0.0, -SIDE)),
        "ceiling": (white, (-half, SIDE, -half), (SIDE, 0.0, 0.0), (0.0, 0.0, SIDE)),
        "back": (white, (-half, 0.0, -half), (SIDE, 0.0, 0.0), (0.0, SIDE, 0.0)),
        "left": (red, (-half, 0.0, half), (0.0, 0.0, -SIDE), (0.0, SIDE, 0.0)),
        "right": (green, (half, 0.0, -half), (0.0, 0.0, SIDE), (0.0, SIDE, 0.0)),
    }
    for name, (material, corner, right, up) in walls.items():
        builder.place(builder.mesh(sheet(corner, right, up, grid), material), name=name)
    width, depth = _LAMP
    quad = sheet((-width / 2.0, SIDE - 0.01, -depth / 2.0), (width, 0.0, 0.0), (0.0, 0.0, depth))
    builder.place(builder.mesh(quad, lamp), name="lamp")
    bevel = 0.01 if detail > 0.5 else 0.0
    short = builder.mesh(block((1.65, 1.65, 1.65), bevel=bevel), white)
    tall = builder.mesh(block((1.65, 3.30, 1.65), bevel=bevel), white)
    builder.place(short, placement(0.92, 0.825, 1.09, turn=-0.29), "short box")
    builder.place(tall, placement(-0.92, 1.65, -0.74, turn=0.30), "tall box")

    scene = builder.build()
    scene.cameras.append(
        Camera((0.0, half, half + 8.0), (0.0, half, 0.0), fov=float(np.radians(38.5)), near=0.1, name="main")
    )
    # A Lambert emitter of radiance L and area A sends L A cos: on its axis, radiant intensity L A.
    area = width * depth
    red_i, green_i, blue_i = (radiance * area for radiance in _RADIANCE)
    scene.lights.append(
        Light(
            (0.0, SIDE - 0.02, 0.0),
            (red_i, green_i, blue_i),
            radius=4.0 * SIDE,
            inner=0.5,
            outer=float(np.radians(89.0)),
        )
    )
    scene.ambient = Ambient((0.10, 0.09, 0.08), (0.12, 0.10, 0.08))
    return scene
