"""The atrium's building: floor, walls, columns, arches, vaults, galleries and roof beams."""

from __future__ import annotations

import math
from math import pi

import numpy as np

from rendergraph.scene.procedural import arcade
from rendergraph.scene.procedural.arcade import BAY, THICKNESS
from rendergraph.scene.procedural.atrium_materials import AtriumMaterials
from rendergraph.scene.procedural.atrium_plan import (
    ARCH_TOP,
    ARCHES,
    CEILING,
    CELLS,
    COLUMNS,
    GALLERY,
    GALLERY_SPRING,
    HALF_X,
    HALF_Z,
    OUTER_X,
    OUTER_Z,
    RIBS,
    ROOF,
    SPRING,
)
from rendergraph.scene.procedural.block import block
from rendergraph.scene.procedural.geometry import Geometry, merge
from rendergraph.scene.procedural.mesh_builder import SceneBuilder, placement
from rendergraph.scene.procedural.shapes import sheet

_TILES = 1.0 / 1.2  # texture repeats a metre: four tiles of 0.6 m
_WALL = 0.3
#: Turns x into y, so that wood's grain runs upwards.
_UPRIGHT = np.array([[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])


def build_masonry(builder: SceneBuilder, materials: AtriumMaterials, detail: float) -> None:
    """Place everything that is built, in stone, brick, plaster and oak."""
    bevel = 0.015 if detail > 0.15 else 0.0
    _shell(builder, materials)
    _arcades(builder, materials, detail)
    _stonework(builder, materials, bevel)
    _timber(builder, materials, bevel)
    _doors(builder, materials, detail, bevel)


def _ring(width: float, y0: float, y1: float, inner_x: float, inner_z: float, bevel: float = 0.0) -> Geometry:
    """Four blocks around a ``2 inner_x`` by ``2 inner_z`` rectangle; the long ones reach the corners."""
    high, y = y1 - y0, (y0 + y1) / 2.0
    long_size, short_size = (2.0 * (inner_x + width), high, width), (width, high, 2.0 * inner_z)
    x, z = inner_x + width / 2.0, inner_z + width / 2.0
    return merge(
        [block(long_size, (0.0, y, side * z), bevel) for side in (-1.0, 1.0)]
        + [block(short_size, (side * x, y, 0.0), bevel) for side in (-1.0, 1.0)]
    )


def _shell(builder: SceneBuilder, materials: AtriumMaterials) -> None:
    """Ground, outer walls, gallery floor, ceiling."""
    ground = sheet((-OUTER_X, 0.0, OUTER_Z), (2 * OUTER_X, 0.0, 0.0), (0.0, 0.0, -2 * OUTER_Z), (18, 10))
    builder.place(builder.mesh(ground.mapped(_TILES), materials.floor), name="floor")
    middle = GALLERY - 0.2
    builder.place(builder.mesh(_ring(_WALL, 0.0, middle, OUTER_X, OUTER_Z), materials.brick), name="brick walls")
    upper = _ring(_WALL, middle, ROOF, OUTER_X, OUTER_Z).mapped(0.5)
    builder.place(builder.mesh(upper, materials.plaster), name="plaster walls")
    gallery = _ring(BAY, GALLERY - 0.3, GALLERY, HALF_X, HALF_Z).mapped(_TILES)
    builder.place(builder.mesh(gallery, materials.floor), name="gallery floor")
    builder.place(builder.mesh(_ring(BAY, CEILING, ROOF - 0.02, HALF_X, HALF_Z), materials.wood), name="ceiling")


def _arcades(builder: SceneBuilder, materials: AtriumMaterials, detail: float) -> None:
    stone = materials.stone
    lower = builder.mesh(arcade.column(SPRING, 0.24, detail, fluted=True), stone)
    upper = builder.mesh(arcade.column(GALLERY_SPRING - GALLERY, 0.17, detail * 0.6, fluted=False), stone)
    ring = builder.mesh(arcade.arch_ring(detail), stone)
    spandrels = builder.mesh(arcade.spandrels(ARCH_TOP, detail).mapped(0.5), materials.plaster)
    rib = builder.mesh(arcade.rib(detail), stone)
    vault = builder.mesh(arcade.vault(1.42, detail).mapped(0.5), materials.plaster)
    for x, z in COLUMNS:
        builder.place(lower, placement(x, 0.0, z), "column")
        builder.place(upper, placement(x, GALLERY, z), "gallery column")
    for place in ARCHES:
        for spring in (SPRING, GALLERY_SPRING):
            world = placement(place.x, spring, place.z, turn=place.turn)
            builder.place(ring, world, "arch")
            builder.place(spandrels, world, "spandrels")
    for place in RIBS:
        builder.place(rib, placement(place.x, SPRING, place.z, turn=place.turn), "rib")
    for x, z in CELLS:
        builder.place(vault, placement(x, SPRING, z), "vault")


def _stonework(builder: SceneBuilder, materials: AtriumMaterials, bevel: float) -> None:
    """Corner piers, cornices, skirting, pilasters."""
    stone = materials.stone
    pier = builder.mesh(
        block((THICKNESS + 0.02, ARCH_TOP, THICKNESS + 0.02), (0.0, ARCH_TOP / 2.0, 0.0)).mapped(0.5), materials.plaster
    )
    for x in (-HALF_X, HALF_X):
        for z in (-HALF_Z, HALF_Z):
            for spring in (SPRING, GALLERY_SPRING):
                builder.place(pier, placement(x, spring, z), "corner pier")
    mouldings = []
    for top, steps in ((GALLERY + 0.02, (0.08, 0.13, 0.20)), (ROOF + 0.02, (0.08, 0.14, 0.22))):
        heights = (top - 0.24, top - 0.17, top - 0.10, top)
        if top > GALLERY + 1.0:
            heights = (GALLERY_SPRING + ARCH_TOP - 0.02, top - 0.25, top - 0.14, top)
        for step, y0, y1 in zip(steps, heights[:-1], heights[1:], strict=True):
            reach = THICKNESS / 2.0 + step
            mouldings.append(_ring(2.0 * reach, y0, y1, HALF_X - reach, HALF_Z - reach, bevel))
    builder.place(builder.mesh(merge(mouldings), stone), name="cornices")
    skirting = [
        _ring(0.06, 0.0, 0.42, OUTER_X - 0.06, OUTER_Z - 0.06, bevel),
        _ring(0.09, 0.42, 0.50, OUTER_X - 0.09, OUTER_Z - 0.09, bevel),
    ]
    builder.place(builder.mesh(merge(skirting), stone), name="skirting")
    deep = BAY / 2.0 - arcade.ARCH_RADIUS
    pilaster = merge(
        [
            block((0.46, 0.24, deep + 0.10), (0.0, 0.12, deep / 2.0), bevel),
            block((0.40, SPRING - 0.36, deep), (0.0, 0.24 + (SPRING - 0.36) / 2.0, deep / 2.0), bevel),
            block((0.52, 0.12, deep + 0.10), (0.0, SPRING - 0.06, deep / 2.0), bevel),
        ]
    )
    mesh = builder.mesh(pilaster.moved(0.0, 0.0, -BAY / 2.0), stone)
    for place in RIBS:
        builder.place(mesh, placement(place.x, 0.0, place.z, turn=place.turn), "pilaster")


def _timber(builder: SceneBuilder, materials: AtriumMaterials, bevel: float) -> None:
    """Joists under the gallery's ceiling, and beams across the courtyard."""
    joist = builder.mesh(block((BAY - 0.1, 0.20, 0.13), bevel=bevel), materials.wood)
    y, side_z, side_x = CEILING - 0.10, HALF_Z + BAY / 2.0 + 0.05, HALF_X + BAY / 2.0 + 0.05
    for k in range(-13, 14):
        for z in (-side_z, side_z):
            builder.place(joist, placement(float(k), y, z, turn=pi / 2.0), "joist")
    for k in range(-4, 5):
        for x in (-side_x, side_x):
            builder.place(joist, placement(x, y, float(k)), "joist")
    beam = builder.mesh(block((2.0 * HALF_Z + 1.0, 0.34, 0.22), bevel=bevel), materials.wood)
    for k in range(1, 7):
        builder.place(beam, placement(-HALF_X + BAY * k, ROOF + 0.19, 0.0, turn=pi / 2.0), "beam")


def _doors(builder: SceneBuilder, materials: AtriumMaterials, detail: float, bevel: float) -> None:
    """A round-headed oak door in the middle of both short walls."""
    scale, spring = 0.62, 1.75
    radius = arcade.ARCH_RADIUS * scale
    jamb_width = arcade.RING * scale
    frame = [
        block((jamb_width, spring, 0.34), (side * (radius + jamb_width / 2.0), spring / 2.0, 0.0), bevel)
        for side in (-1.0, 1.0)
    ]
    jambs = builder.mesh(merge(frame), materials.stone)
    ring = builder.mesh(arcade.arch_ring(detail), materials.stone)
    # Upright planks, each as tall as the round head where it is highest; the ring hides their square corners.
    planks = []
    for k in range(6):
        x = (k - 2.5) * 0.25
        tall = spring + math.sqrt(radius**2 - max(0.0, abs(x) - 0.12) ** 2)
        planks.append(block((tall, 0.246, 0.06), (tall / 2.0, -x, 0.08), bevel).placed(_UPRIGHT))
    leaf = builder.mesh(merge(planks), materials.wood)
    for side, turn in ((-1.0, pi / 2.0), (1.0, -pi / 2.0)):
        world = placement(side * OUTER_X, 0.0, 0.0, turn=turn)
        builder.place(jambs, world, "door jambs")
        builder.place(ring, placement(side * OUTER_X, spring, 0.0, turn=turn, scale=scale), "door arch")
        builder.place(leaf, world, "door")
