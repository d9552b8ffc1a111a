"""What a scene contains, computed once: nodes specialise on it. Pure data, no numpy."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace


@dataclass(frozen=True, slots=True)
class ViewFeatures:
    """What is certain of what the cameras of a run see. All of it is conservative: what is not proven is not claimed.

    - ``unseen``: features that the scene has and that no instance in any view has, by their names in SceneFeatures.
    - ``lit``: whether a local light may reach a view.
    - ``casters``: whether anything solid may stand between the sun and what is in view.
    - ``depth_range``: view depths [m] between which all that is in view lies, in steps of a factor of two so that a
      moving camera keeps its plan; None when nothing is in view.
    - ``near``: the nearest near plane [m].
    - ``covered``: opaque triangles fill every view, without a hole.
    """

    unseen: frozenset[str] = frozenset()
    lit: bool = True
    casters: bool = True
    depth_range: tuple[float, float] | None = None
    near: float = 0.0
    covered: bool = False


@dataclass(frozen=True, slots=True)
class SceneFeatures:
    """The scene's feature set. Booleans name what a shader must handle; counts size what a pass must allocate.

    ``area_lights`` is 0: scenes have none yet. ``view`` is None where the cameras are not known.
    """

    opaque: bool = False
    masked: bool = False
    blended: bool = False
    double_sided: bool = False
    unlit: bool = False
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
    area_lights: int = 0
    triangles: int = 0
    draws: int = 0
    materials: int = 0
    texture_arrays: int = 0
    texture_slots: int = 0  # bit per slot of Material.textures (shaders/scene.glsl) that some drawn material fills
    view: ViewFeatures | None = None

    @property
    def local_lights(self) -> int:
        """Point and spot lights together."""
        return self.point_lights + self.spot_lights

    def full(self) -> SceneFeatures:
        """Everything switched on, counts kept, nothing known of the view: what a run without specialisation assumes."""
        on = {f.name: True for f in fields(self) if isinstance(getattr(self, f.name), bool)}
        return replace(self, **on, view=None)
