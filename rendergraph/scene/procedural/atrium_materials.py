"""The atrium's materials: indices into the scene's materials."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rendergraph.scene.procedural import cutouts, patterns
from rendergraph.scene.procedural.mesh_builder import SceneBuilder
from rendergraph.scene.scene import Alpha, Material


@dataclass(frozen=True, slots=True)
class AtriumMaterials:
    """Indices of materials; ``curtains`` and ``hangings`` share their images and differ by dye."""

    stone: int
    plaster: int
    brick: int
    floor: int
    wood: int
    bronze: int
    terracotta: int
    soil: int
    leaf: int
    frond: int
    glow: int
    glass: int
    water: int
    curtains: tuple[int, ...]
    hangings: tuple[int, ...]


#: Linear dyes: madder red, indigo, weld yellow, verdigris.
_DYES = ((0.72, 0.075, 0.05), (0.07, 0.13, 0.46), (0.95, 0.52, 0.10), (0.07, 0.36, 0.27))


def texture_size(detail: float) -> int:
    """Texels a side of every image: one size, so that few texture arrays hold them."""
    return 512 if detail >= 0.5 else 256


def add_materials(builder: SceneBuilder, rng: np.random.Generator, detail: float) -> AtriumMaterials:
    """Add every material of the atrium."""
    size = texture_size(detail)
    solid = Material(metallic=0.0)
    stone = builder.material(replace(solid, name="limestone"), patterns.limestone(rng, size))
    curtain = builder.material(
        replace(solid, name="curtain", alpha=Alpha.MASKED, double_sided=True), cutouts.curtain(rng, size)
    )
    hanging = builder.material(replace(solid, name="hanging"), patterns.weave(rng, size))

    def dyed(material: int, name: str) -> tuple[int, ...]:
        return tuple(builder.dyed(material, f"{name} {k}", (*dye, 1.0)) for k, dye in enumerate(_DYES))

    leafy = replace(solid, alpha=Alpha.MASKED, double_sided=True, alpha_cutoff=0.4)
    return AtriumMaterials(
        stone=stone,
        plaster=builder.material(replace(solid, name="plaster"), patterns.plaster(rng, size)),
        brick=builder.material(replace(solid, name="brick"), patterns.brick(rng, size)),
        floor=builder.material(replace(solid, name="marble tiles"), patterns.marble_tiles(rng, size)),
        wood=builder.material(replace(solid, name="oak"), patterns.wood(rng, size)),
        bronze=builder.material(Material("bronze"), patterns.hammered(rng, size)),
        terracotta=builder.dyed(stone, "terracotta", (0.85, 0.36, 0.20, 1.0)),
        soil=builder.material(replace(solid, name="soil", base_color=(0.05, 0.033, 0.022, 1.0))),
        leaf=builder.material(replace(leafy, name="leaf"), cutouts.leaf(rng, size)),
        frond=builder.material(replace(leafy, name="frond"), cutouts.frond(rng, size)),
        glow=builder.material(
            replace(solid, name="lamp glass", base_color=(1.0, 0.85, 0.6, 1.0), roughness=0.4, emissive=(9.0, 5.0, 2.0))
        ),
        glass=builder.material(
            replace(solid, name="glass", base_color=(0.72, 0.86, 0.84, 0.22), roughness=0.05, alpha=Alpha.BLENDED)
        ),
        water=builder.material(
            replace(solid, name="water", base_color=(0.05, 0.16, 0.17, 0.62), roughness=0.06, alpha=Alpha.BLENDED),
            patterns.ripples(rng, size),
        ),
        curtains=dyed(curtain, "curtain"),
        hangings=dyed(hanging, "hanging"),
    )
