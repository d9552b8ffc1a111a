"""What surfaces look like: masonry, tiles, wood, cloth, leaves, water, as maps of a material. Sizes in texels."""

from __future__ import annotations

import numpy as np

from rendergraph.scene.procedural.textures import (
    F32,
    Maps,
    base_image,
    blend,
    noise,
    normal_image,
    orm_image,
    smoothstep,
)


def _grid(size: int) -> tuple[F32, F32]:
    """Texel centres: columns x float32[1, size], rows y float32[size, 1], 0..1, y down."""
    line = ((np.arange(size) + 0.5) / size).astype(np.float32)
    return line[None, :], line[:, None]


def limestone(rng: np.random.Generator, size: int) -> Maps:
    """Warm dressed stone with shallow pits; one metre."""
    cloud = noise(rng, size, exponent=3.0, scale=2.0)
    grain = noise(rng, size, exponent=1.2, scale=24.0)
    pits = smoothstep(0.26, 0.12, grain)
    color = blend((0.70, 0.63, 0.53), (0.83, 0.77, 0.67), cloud * 0.7 + grain * 0.3)
    color = blend(color, (0.50, 0.44, 0.36), pits * 0.6)
    height = cloud * 0.35 + grain * 0.25 - pits * 0.5
    return Maps(
        base_image("limestone", color),
        normal_image("limestone", height, 0.006),
        orm_image("limestone", 0.72 + 0.2 * grain, 1.0 - 0.5 * pits),
    )


def plaster(rng: np.random.Generator, size: int) -> Maps:
    """Trowelled lime plaster; two metres."""
    cloud = noise(rng, size, exponent=3.4, scale=2.0)
    grain = noise(rng, size, exponent=2.0, scale=12.0)
    color = blend((0.80, 0.70, 0.55), (0.90, 0.83, 0.70), cloud * 0.8 + grain * 0.2)
    return Maps(
        base_image("plaster", color),
        normal_image("plaster", grain, 0.004),
        orm_image("plaster", 0.85 + 0.1 * cloud),
    )


def brick(rng: np.random.Generator, size: int, rows: int = 12, columns: int = 4) -> Maps:
    """Running-bond brickwork with recessed mortar: ``rows`` courses of ``columns`` bricks; one metre."""
    x, y = _grid(size)
    row = np.floor(y * rows)
    across = x * columns + 0.5 * (row % 2.0)
    column = np.floor(across).astype(int) % columns
    aspect = rows / columns
    wobble = (noise(rng, size, exponent=2.4, scale=6.0) - 0.5) * 0.10
    # Distance to the nearest joint, in brick heights.
    to_side = (0.5 - np.abs(across - np.floor(across) - 0.5)) * aspect
    to_bed = 0.5 - np.abs(y * rows - row - 0.5)
    edge = np.minimum(to_side, to_bed) + wobble
    face = smoothstep(0.06, 0.17, edge)
    tint = rng.random((rows, columns), dtype=np.float32)[row.astype(int), column]
    warm = rng.random((rows, columns), dtype=np.float32)[row.astype(int), column]
    grain = noise(rng, size, exponent=1.6, scale=10.0)
    clay = blend((0.50, 0.27, 0.19), (0.72, 0.44, 0.31), tint * 0.65 + grain * 0.35)
    clay = blend(clay, (0.66, 0.50, 0.38), smoothstep(0.7, 1.0, warm) * 0.7)
    color = blend(blend((0.60, 0.55, 0.48), (0.72, 0.68, 0.60), grain), clay, face)
    height = face * (0.75 + 0.25 * tint) + grain * 0.22
    return Maps(
        base_image("brick", color),
        normal_image("brick", height, 0.014),
        orm_image("brick", 0.80 + 0.18 * grain, 0.55 + 0.45 * face),
    )


def marble_tiles(rng: np.random.Generator, size: int) -> Maps:
    """Polished chequered marble, two by two tiles with fine joints; veins run through each tile its own way."""
    x, y = _grid(size)
    tile = (np.floor(x * 2.0) + 2.0 * np.floor(y * 2.0)).astype(int)
    dark = ((np.floor(x * 2.0) + np.floor(y * 2.0)) % 2.0).astype(np.float32)
    cloud, fine = noise(rng, size, exponent=3.2, scale=1.5), noise(rng, size, exponent=2.2, scale=5.0)
    # Each tile is cut from another place of the slab.
    cloud, fine = (np.choose(tile, [np.roll(f, k * size // 3, axis=k % 2) for k in range(4)]) for f in (cloud, fine))
    vein = 1.0 - smoothstep(0.0, 0.05, np.abs(cloud + 0.25 * fine - 0.62))
    hair = 1.0 - smoothstep(0.0, 0.02, np.abs(fine + 0.3 * cloud - 0.66))
    veins = np.maximum(vein * 0.8, hair * 0.5)
    light = blend(blend((0.80, 0.76, 0.69), (0.90, 0.87, 0.81), cloud), (0.58, 0.52, 0.45), veins * 0.7)
    deep = blend(blend((0.40, 0.22, 0.17), (0.56, 0.34, 0.26), cloud), (0.80, 0.68, 0.58), veins * 0.55)
    to_joint = np.minimum(0.25 - np.abs(x * 1.0 % 0.5 - 0.25), 0.25 - np.abs(y * 1.0 % 0.5 - 0.25))
    face = smoothstep(0.002, 0.006, to_joint)
    color = blend((0.42, 0.38, 0.33), blend(light, deep, dark), face)
    polish = 0.10 + 0.10 * fine + 0.08 * veins
    return Maps(
        base_image("tiles", color),
        normal_image("tiles", face + 0.02 * cloud, 0.0025),
        orm_image("tiles", polish * face + 0.8 * (1.0 - face), 0.7 + 0.3 * face),
    )


def wood(rng: np.random.Generator, size: int) -> Maps:
    """Oak with the grain along u; one metre."""
    _, y = _grid(size)
    bend = noise(rng, size, exponent=3.4, scale=1.0).T
    fibre = noise(rng, size, exponent=1.4, scale=20.0, stretch=0.06).T
    ring = 0.5 + 0.5 * np.sin(2.0 * np.pi * (7.0 * y + 2.2 * bend))
    shade = np.clip(0.55 * ring**2 + 0.6 * fibre - 0.05, 0.0, 1.0).astype(np.float32)
    color = blend((0.46, 0.29, 0.16), (0.26, 0.15, 0.08), shade)
    return Maps(
        base_image("wood", color),
        normal_image("wood", 1.0 - shade, 0.004),
        orm_image("wood", 0.55 + 0.25 * shade),
    )


def weave(rng: np.random.Generator, size: int, threads: int = 48) -> Maps:
    """Plain weave of ``threads`` warp and weft threads, with a woven lozenge ornament; half a metre. Undyed."""
    x, y = _grid(size)
    over = ((np.floor(x * threads) + np.floor(y * threads)) % 2.0).astype(np.float32)
    warp = np.sqrt(np.abs(np.sin(np.pi * x * threads))) * (0.5 + 0.5 * over)
    weft = np.sqrt(np.abs(np.sin(np.pi * y * threads))) * (1.0 - 0.5 * over)
    thread = np.maximum(warp, weft).astype(np.float32)
    lozenge = np.abs(x * 2.0 % 1.0 - 0.5) + np.abs(y * 2.0 % 1.0 - 0.5)
    ornament = smoothstep(0.03, 0.0, np.abs(np.abs(np.abs(lozenge - 0.5) - 0.22) - 0.09) - 0.03)
    fuzz = noise(rng, size, exponent=1.0, scale=16.0)
    color = blend((0.46, 0.45, 0.44), (0.72, 0.71, 0.70), thread * 0.6 + fuzz * 0.4)
    color = blend(color, (1.0, 0.98, 0.92), ornament * 0.85)
    return Maps(
        base_image("weave", color),
        normal_image("weave", thread * 0.8 + fuzz * 0.2 + ornament * 0.5, 0.008),
        orm_image("weave", 0.88 + 0.1 * fuzz, 0.75 + 0.25 * thread),
    )


def hammered(rng: np.random.Generator, size: int) -> Maps:
    """Hammered bronze with darker hollows; one metre."""
    dents = noise(rng, size, exponent=4.0, scale=14.0)
    patina = smoothstep(0.5, 0.85, noise(rng, size, exponent=2.6, scale=3.0))
    color = blend((0.86, 0.68, 0.40), (0.50, 0.40, 0.26), patina)
    return Maps(
        base_image("bronze", color),
        normal_image("bronze", dents, 0.006),
        orm_image("bronze", 0.24 + 0.3 * patina, 1.0, 1.0 - 0.25 * patina),
    )


def ripples(rng: np.random.Generator, size: int) -> Maps:
    """Small waves; two metres. A normal map only."""
    return Maps(normal=normal_image("ripples", noise(rng, size, exponent=5.0, scale=7.0), 0.010))


def chequer(rng: np.random.Generator, size: int) -> Maps:
    """Matt grey two by two chequers: a ground that shows shadows and reflections' scale; two metres."""
    x, y = _grid(size)
    dark = ((np.floor(x * 2.0) + np.floor(y * 2.0)) % 2.0).astype(np.float32)
    grain = noise(rng, size, exponent=1.4, scale=12.0)
    color = blend((0.60, 0.60, 0.60), (0.44, 0.44, 0.45), dark) + (grain[..., None] - np.float32(0.5)) * np.float32(
        0.05
    )
    return Maps(base_image("chequer", color), orm=orm_image("chequer", 0.6 + 0.2 * grain))
