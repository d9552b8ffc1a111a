"""Alpha-masked patterns: a curtain with a cut-work hem, a broad leaf, a palm frond. Row 0 is the top of the image."""

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
    line = ((np.arange(size) + 0.5) / size).astype(np.float32)
    return line[None, :], line[:, None]


def curtain(rng: np.random.Generator, size: int) -> Maps:
    """Undyed brocade, its hem cut into scallops with eyelets. u repeats; v runs once from the rail to the hem."""
    x, y = _grid(size)
    scallop = np.abs((x * 8.0) % 1.0 - 0.5)
    hem = 0.985 - 0.035 * (1.0 - np.sqrt(np.maximum(0.0, 1.0 - (2.0 * scallop) ** 2)))
    cell_x, cell_y = (x * 8.0) % 1.0 - 0.5, (y - 0.948) * 18.0
    eyelets = smoothstep(0.16, 0.20, np.sqrt(cell_x**2 + cell_y**2).astype(np.float32))
    half_x = (x * 8.0 + 0.5) % 1.0 - 0.5
    pinholes = smoothstep(0.09, 0.12, np.sqrt(half_x**2 + ((y - 0.922) * 18.0) ** 2).astype(np.float32))
    alpha = smoothstep(0.006, -0.006, (y - hem).astype(np.float32)) * eyelets * pinholes
    # Ogee ornament: two mirrored waves that meet and part.
    phase = 2.0 * np.pi * y * 6.0
    wave = np.abs(((x * 4.0 + 0.5 * (np.floor(y * 6.0) % 2.0)) % 1.0) - 0.5) * 2.0 - (0.5 + 0.42 * np.cos(phase))
    ornament = smoothstep(0.14, 0.06, np.abs(wave).astype(np.float32))
    band = smoothstep(0.006, 0.0, np.abs(np.abs(y - 0.87) - 0.018) - 0.006) + 0.0 * x
    gold = np.clip(np.maximum(ornament * 0.55, band), 0.0, 1.0)
    thread = (0.5 + 0.5 * np.sin(2.0 * np.pi * x * 128.0)).astype(np.float32)
    fuzz = noise(rng, size, exponent=1.2, scale=12.0)
    color = blend((0.52, 0.51, 0.51), (0.76, 0.75, 0.75), 0.35 * thread + 0.65 * fuzz)
    color = blend(color, (1.0, 0.97, 0.90), gold)
    return Maps(
        base_image("curtain", color, alpha),
        normal_image("curtain", gold * 0.8 + 0.2 * fuzz + 0.12 * thread, 0.004),
        orm_image("curtain", 0.85 - 0.3 * gold + 0.1 * fuzz),
        tiles=False,
    )


def leaf(rng: np.random.Generator, size: int) -> Maps:
    """One broad leaf: stalk at the lower edge, tip at the upper."""
    x, y = _grid(size)
    along = 1.0 - y
    side = np.abs(x - 0.5) * 2.0
    width = 0.92 * np.sin(np.pi * np.clip(along, 0.0, 1.0) ** 0.8) ** 0.85 * (1.0 - 0.15 * along)
    inside = smoothstep(0.02, -0.02, (side - np.maximum(width, 0.03 * (along < 0.2))).astype(np.float32))
    veins_at = (along - 0.45 * side) * 11.0 % 1.0
    vein = np.maximum(
        smoothstep(0.05, 0.0, (side - 0.015).astype(np.float32)),
        0.6 * smoothstep(0.10, 0.0, np.abs(veins_at - 0.5).astype(np.float32)),
    )
    cloud = noise(rng, size, exponent=2.6, scale=3.0)
    color = blend(blend((0.16, 0.33, 0.10), (0.34, 0.52, 0.17), cloud), (0.58, 0.70, 0.34), vein * 0.6)
    return Maps(
        base_image("leaf", color, inside),
        normal_image("leaf", cloud * 0.3 - vein * 0.5, 0.02),
        orm_image("leaf", 0.45 + 0.25 * cloud),
        tiles=False,
    )


def frond(rng: np.random.Generator, size: int, leaflets: int = 22) -> Maps:
    """One feathered palm frond: leaflets leave the rib upwards at an angle and shorten towards the tip."""
    x, y = _grid(size)
    along = (1.0 - y) * 1.0
    side = np.abs(x - 0.5) * 2.0
    reach = 0.97 * np.sin(np.pi * np.clip(0.08 + 0.92 * along, 0.0, 1.0) ** 0.7) ** 0.6
    stagger = np.where(x < 0.5, 0.0, 0.5)
    across = ((along - 0.16 * side) * leaflets + stagger) % 1.0 - 0.5
    taper = 0.42 * np.clip(1.0 - (side / np.maximum(reach, 1e-3)) ** 2.5, 0.0, 1.0)
    blade = smoothstep(0.06, -0.06, (np.abs(across) - taper).astype(np.float32)) * (side < reach) * (along > 0.1)
    rib = smoothstep(0.012, -0.012, (side - 0.03 * (1.0 - 0.7 * along)).astype(np.float32))
    cloud = noise(rng, size, exponent=2.4, scale=4.0)
    color = blend((0.15, 0.34, 0.11), (0.40, 0.55, 0.19), (cloud * 0.6 + 0.4 * side).astype(np.float32))
    color = blend(color, (0.52, 0.50, 0.24), rib)
    return Maps(
        base_image("frond", color, np.maximum(blade, rib).astype(np.float32)),
        normal_image("frond", np.abs(across).astype(np.float32) * 0.7 + rib * 0.5, 0.012),
        orm_image("frond", 0.45 + 0.2 * cloud),
        tiles=False,
    )
