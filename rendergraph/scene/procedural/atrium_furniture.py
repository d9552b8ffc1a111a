"""The atrium's movable things: curtains, hangings, plants, lanterns, balustrades, the fountain; and their lights."""

from __future__ import annotations

from math import pi

import numpy as np

from rendergraph.scene.procedural import furnishings
from rendergraph.scene.procedural.arcade import BAY
from rendergraph.scene.procedural.atrium_materials import AtriumMaterials
from rendergraph.scene.procedural.atrium_plan import (
    ARCHES,
    CEILING,
    GALLERY,
    GALLERY_SPRING,
    HALF_X,
    HALF_Z,
    OUTER_Z,
    ROOF,
    SPRING,
)
from rendergraph.scene.procedural.block import block
from rendergraph.scene.procedural.geometry import Geometry, merge, surface
from rendergraph.scene.procedural.mesh_builder import SceneBuilder, placement
from rendergraph.scene.procedural.tessellation import segments
from rendergraph.scene.scene import Light

_RAIL = SPRING - 0.60  # curtain rail of the lower arches
_TIE = 1.35  # where a curtain is gathered, below its rail
_LAMPLIGHT = (2.6, 1.5, 0.65)


def furnish(builder: SceneBuilder, materials: AtriumMaterials, rng: np.random.Generator, detail: float) -> list[Light]:
    """Place all furniture; returns the lanterns' lights."""
    cloth, dyes, leaves, places = rng.spawn(4)
    _curtains(builder, materials, cloth, detail)
    _hangings(builder, materials, dyes, detail)
    _balustrades(builder, materials, detail)
    _plants(builder, materials, leaves, places, detail)
    builder.place(builder.mesh(furnishings.fountain(detail), materials.stone), name="fountain")
    builder.place(builder.mesh(furnishings.fountain_water(detail).mapped(0.5), materials.water), name="water")
    return _lanterns(builder, materials, detail)


def _curtains(builder: SceneBuilder, materials: AtriumMaterials, rng: np.random.Generator, detail: float) -> None:
    """Tied-back pairs in every other lower arch of the long sides, straight ones in some arches of the gallery."""
    reach = BAY / 2.0 - 0.23
    tied = [builder.mesh(furnishings.drape(rng, reach, 2.32, _TIE, detail), materials.curtains[0]) for _ in range(2)]
    straight = builder.mesh(furnishings.drape(rng, 1.15, 1.66, None, detail * 0.7), materials.curtains[0])
    rail = builder.mesh(furnishings.curtain_rail(BAY - 0.3, detail), materials.bronze)
    clasp = builder.mesh(furnishings.tie_band(detail), materials.bronze)
    dyed = {
        (m, d): m if d == materials.curtains[0] else builder.recoloured(m, d)
        for m in (*tied, straight)
        for d in materials.curtains
    }
    dyes = rng.permutation(len(materials.curtains))
    for number, arch in enumerate(ARCHES[:14]):
        dye = materials.curtains[dyes[number // 2 % len(dyes)]]
        if number % 2 == 1:
            y = _RAIL
            left, right = (dyed[mesh, dye] for mesh in tied)
        else:
            y = GALLERY_SPRING - 0.62
            left = right = dyed[straight, dye]
        along = np.array([np.cos(arch.turn), -np.sin(arch.turn)]) * reach
        # Behind the columns' axis: the balustrade stands before it.
        back = -0.10 * np.array([np.sin(arch.turn), np.cos(arch.turn)])
        builder.place(rail, placement(arch.x + back[0], y, arch.z + back[1], turn=arch.turn), "curtain rail")
        builder.place(
            left, placement(arch.x + back[0] - along[0], y, arch.z + back[1] - along[1], turn=arch.turn), "curtain"
        )
        builder.place(
            right,
            placement(arch.x + back[0] + along[0], y, arch.z + back[1] + along[1], turn=arch.turn + pi),
            "curtain",
        )
        if number % 2 == 1:
            gathered = along * (1.0 - 0.13 / reach)
            for side in (-1.0, 1.0):
                x, z = arch.x + back[0] + side * gathered[0], arch.z + back[1] + side * gathered[1]
                builder.place(clasp, placement(x, y - _TIE, z), "curtain clasp")


def _hangings(builder: SceneBuilder, materials: AtriumMaterials, rng: np.random.Generator, detail: float) -> None:
    """Woven hangings on the brick of the long walls, one a bay."""
    cells = (segments(detail, 2, 18), segments(detail, 2, 22))
    cloth = _cloth((-0.75, 0.75), (-2.1, 0.0), cells, 0.0)
    strips = (
        ((-0.75, -0.61), (-2.1, 0.0)),
        ((0.61, 0.75), (-2.1, 0.0)),
        ((-0.61, 0.61), (-2.1, -1.96)),
        ((-0.61, 0.61), (-0.14, 0.0)),
    )
    border = merge([_cloth(x, y, (cells[0] // 6 + 1, cells[1] if x[1] - x[0] < 1.0 else 1), 0.006) for x, y in strips])
    trim = builder.mesh(border, materials.hangings[2])
    first = builder.mesh(cloth, materials.hangings[0])
    meshes = [first, *(builder.recoloured(first, dye) for dye in materials.hangings[1:])]
    rod = builder.mesh(furnishings.curtain_rail(1.75, detail), materials.wood)
    order = rng.permutation(len(meshes))
    for number, arch in enumerate(ARCHES[:14]):
        z = np.sign(arch.z) * (OUTER_Z - 0.045)
        mesh = meshes[order[number % len(meshes)]]
        builder.place(mesh, placement(arch.x, 2.95, float(z), turn=arch.turn), "hanging")
        builder.place(trim, placement(arch.x, 2.95, float(z), turn=arch.turn), "hanging border")
        builder.place(rod, placement(arch.x, 2.95, float(z), turn=arch.turn), "hanging rod")


def _cloth(x: tuple[float, float], y: tuple[float, float], cells: tuple[int, int], lift: float) -> Geometry:
    """A piece of a hanging: a rectangle of a gently waving cloth, ``lift`` in front of it."""
    s, t = np.meshgrid(np.linspace(*x, cells[0] + 1), np.linspace(*y, cells[1] + 1))
    wave = 0.035 + lift - 0.008 * np.sin(4.0 * s) * t + 0.010 * np.sin(3.0 * t + 2.5 * s)
    return surface(np.stack([s, t, wave], axis=-1), np.stack([2.0 * s, -2.0 * t], axis=-1))


def _balustrades(builder: SceneBuilder, materials: AtriumMaterials, detail: float) -> None:
    """Glass panes between bronze rails along the gallery."""
    width = BAY - 0.36
    pane = builder.mesh(block((width, 0.74, 0.024), (0.0, 0.0, 0.10)), materials.glass)
    bars = [furnishings.curtain_rail(BAY - 0.2, detail).moved(0.0, y, 0.10) for y in (-0.40, 0.40)]
    rails = builder.mesh(merge(bars), materials.bronze)
    for arch in ARCHES:
        world = placement(arch.x, GALLERY + 0.55, arch.z, turn=arch.turn)
        builder.place(pane, world, "glass pane")
        builder.place(rails, world, "balustrade rails")


def _plants(
    builder: SceneBuilder,
    materials: AtriumMaterials,
    leaves: np.random.Generator,
    spots: np.random.Generator,
    detail: float,
) -> None:
    """Palms in the arcade's corners and around the fountain, shrubs before the columns."""
    pot = builder.mesh(furnishings.pot(detail), materials.terracotta)
    soil = builder.mesh(furnishings.soil(detail), materials.soil)
    palms = [builder.mesh(furnishings.palm(leaves, detail), materials.frond) for _ in range(2)]
    shrubs = [builder.mesh(furnishings.shrub(leaves, detail), materials.leaf) for _ in range(2)]
    x, z = HALF_X + 1.2, HALF_Z + 1.2
    palm_places = [(i * x, j * z) for i in (-1, 1) for j in (-1, 1)] + [
        (i * 3.0, j * 1.9) for i in (-1, 1) for j in (-1, 1)
    ]
    shrub_places = [(-HALF_X + BAY * k, side * (HALF_Z - 0.75)) for k in range(1, 7) for side in (-1, 1)]
    for places, plants, large in ((palm_places, palms, 1.0), (shrub_places, shrubs, 0.85)):
        for number, (px, pz) in enumerate(places):
            by_fountain = plants is palms and number >= 4
            scale = large * (0.85 if by_fountain else 1.0) * float(spots.uniform(0.9, 1.1))
            jitter = spots.uniform(-0.12, 0.12, 2)
            world = placement(
                px + jitter[0], 0.0, pz + jitter[1], turn=float(spots.uniform(0.0, 2.0 * pi)), scale=scale
            )
            builder.place(pot, world, "pot")
            builder.place(soil, world, "soil")
            builder.place(plants[number % len(plants)], world, "plant")


def _lanterns(builder: SceneBuilder, materials: AtriumMaterials, detail: float) -> list[Light]:
    """Lanterns under every vault of the long sides, in the gallery, and from the beams; a light in each."""
    glass = builder.mesh(furnishings.lantern_glass(detail), materials.glow)
    lights: list[Light] = []

    def hang(frame: int, x: float, y: float, z: float, scale: float) -> None:
        world = placement(x, y, z, scale=scale)
        builder.place(frame, world, "lantern")
        builder.place(glass, world, "lantern glass")
        power = scale * scale
        red, green, blue = (channel * power for channel in _LAMPLIGHT)
        lights.append(Light((x, y, z), (red, green, blue), radius=6.0 * scale))

    arcade_side, middle = HALF_Z + BAY / 2.0, CEILING - 1.15
    low = builder.mesh(furnishings.lantern_frame(SPRING + 1.41 - 3.25, detail), materials.bronze)
    high = builder.mesh(furnishings.lantern_frame(CEILING - middle, detail), materials.bronze)
    great = builder.mesh(furnishings.lantern_frame((ROOF + 0.1 - 6.1) / 1.9, detail), materials.bronze)
    for k in range(7):
        x = -HALF_X + BAY * (k + 0.5)
        for side in (-1.0, 1.0):
            if k % 2 == 0:
                hang(low, x, 3.25, side * arcade_side, 1.0)
            else:
                hang(high, x, middle, side * arcade_side, 1.0)
    for k in (1, 3, 4, 6):
        hang(great, -HALF_X + BAY * k, 6.1, 0.0, 1.9)
    return lights
