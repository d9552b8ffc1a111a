"""What a scene contains, computed once: nodes specialise on it. Pure data, no numpy."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace


@dataclass(frozen=True, slots=True)
class SceneFeatures:
    """The scene's feature set. Booleans name what a shader must handle; counts size what a pass must allocate."""

    opaque: bool = False
    masked: bool = False
    blended: bool = False
    double_sided: bool = False
    emissive: bool = False
    normal_mapped: bool = False
    occlusion_mapped: bool = False
    textured: bool = False
    texture_transforms: bool = False  # a texture is moved, turned or scaled
    texture_wraps: bool = False  # a texture is clamped or mirrored
    second_uv: bool = False  # a texture uses the second texture coordinates
    vertex_colors: bool = False  # a vertex is not white
    skinned: bool = False
    sun: bool = False
    ambient: bool = False
    point_lights: int = 0
    spot_lights: int = 0
    triangles: int = 0
    draws: int = 0
    materials: int = 0
    texture_arrays: int = 0
    texture_slots: int = 0  # bit per slot of Material.textures (shaders/scene.glsl) that some drawn material fills

    @property
    def local_lights(self) -> int:
        """Point and spot lights together."""
        return self.point_lights + self.spot_lights

    def full(self) -> SceneFeatures:
        """Everything switched on, counts kept: what a run without specialisation assumes."""
        return replace(self, **{f.name: True for f in fields(self) if isinstance(getattr(self, f.name), bool)})
