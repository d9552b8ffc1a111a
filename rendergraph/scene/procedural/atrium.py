"""The atrium: a two-storey arcaded courtyard, open to the sky, 27 x 15 x 9 m, made to show off lighting techniques.

A grid of 9 x 5 bays of 3 m; the outer ring of bays is the arcade, the inner 7 x 3 the courtyard. x runs along it, the
floor is ``y = 0``, the origin lies under the fountain in the middle.
"""

from __future__ import annotations

import numpy as np

from rendergraph.scene.procedural.atrium_furniture import furnish
from rendergraph.scene.procedural.atrium_masonry import build_masonry
from rendergraph.scene.procedural.atrium_materials import add_materials
from rendergraph.scene.procedural.mesh_builder import SceneBuilder
from rendergraph.scene.scene import Ambient, Camera, Scene, Sun


def atrium(detail: float, seed: int) -> Scene:
    """Build the atrium: at least 200,000 triangles at ``detail`` 1, about 22,000 at 0.

    ``seed`` varies textures, cloth, plants and their places; the building stays.
    """
    # Separate streams: what one part draws, at whatever detail, moves nothing in another.
    paint, things = np.random.default_rng(seed).spawn(2)
    builder = SceneBuilder("atrium")
    materials = add_materials(builder, paint, detail)
    build_masonry(builder, materials, detail)
    lights = furnish(builder, materials, things, detail)
    scene = builder.build()
    scene.lights = lights
    scene.cameras += [
        Camera((-9.3, 1.75, 2.6), (2.0, 2.5, -2.2), fov=float(np.radians(62.0)), name="main"),
        Camera((-9.7, 1.7, -6.3), (2.0, 1.9, -5.3), fov=float(np.radians(58.0)), name="arcade"),
        Camera((9.6, 6.5, 5.6), (-3.0, 2.2, -2.5), fov=float(np.radians(60.0)), name="gallery"),
    ]
    direction = np.array([0.40, -1.0, -0.42])
    x, y, z = (direction / np.linalg.norm(direction)).tolist()
    scene.sun = Sun((x, y, z), (10.0, 9.0, 7.5))
    scene.ambient = Ambient((0.16, 0.20, 0.27), (0.15, 0.125, 0.10))
    return scene
