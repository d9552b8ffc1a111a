"""The extremes that every graph is tried at, as data."""

from __future__ import annotations

from functools import partial
from typing import Final

from rendergraph.measure.stress import formats, scenes
from rendergraph.measure.stress.case import Case
from rendergraph.node.reference import Extreme

_FURNACE_SIZE: Final = (48, 27)
#: Sixty-five thousand lights are evaluated at every texel: few texels are enough.
_FEW_TEXELS: Final = (8, 5)

HALF_LIMIT: Final = 65504.0


def _frame(name: str, width: int, height: int, help: str) -> Case:
    return Case(Extreme(name, help), size=(width, height))


COMMON: Final = (
    Case(Extreme("as_written", "The graph as it is, at the size of these runs.")),
    _frame("frame_1x1", 1, 1, "One texel: no neighbours, no derivatives, mip chains of one level."),
    _frame("frame_3x5", 3, 5, "Smaller than any tile or work group."),
    _frame("frame_8191x1", 8191, 1, "As wide as textures go, one texel high."),
    _frame("frame_1x8191", 1, 8191, "As high as textures go, one texel wide."),
    _frame("frame_odd", 37, 23, "Sizes that no tile, quad or half resolution divides."),
    Case(Extreme("near_far", "Near plane at 1 mm, far plane at 1000 km."),
         edit=partial(scenes.depth_range, near=1e-3, far=1e6)),
    Case(Extreme("near_infinite", "Near plane at 1 mm, no far plane."),
         edit=partial(scenes.depth_range, near=1e-3, far=None)),
    Case(Extreme("thin_range", "Near and far plane 1 mm apart."),
         edit=partial(scenes.depth_range, near=1.0, far=1.001)),
    Case(Extreme("fov_1", "Vertical field of view of 1 degree."), edit=partial(scenes.field_of_view, degrees=1.0)),
    Case(Extreme("fov_170", "Vertical field of view of 170 degrees."),
         edit=partial(scenes.field_of_view, degrees=170.0)),
    Case(Extreme("camera_inside", "The camera inside of a solid thing."), edit=scenes.inside_geometry),
    Case(Extreme("far_from_origin", "Everything, the camera too, 1000 km from the origin."),
         edit=partial(scenes.moved, metres=1e6)),
    Case(Extreme("scale_tiny", "Everything 10000 times as small, planes and lights too."),
         edit=partial(scenes.scaled, factor=1e-4)),
    Case(Extreme("scale_huge", "Everything 100000 times as large, planes and lights too."),
         edit=partial(scenes.scaled, factor=1e5)),
    Case(Extreme("degenerate", "Triangles without area, slivers, normals of length zero."),
         edit=scenes.with_degenerate_triangles),
    Case(Extreme("empty_scene", "Nothing to draw."), edit=scenes.empty),
    Case(Extreme("no_sun", "A scene without a sun."), edit=scenes.no_sun),
    Case(Extreme("black_sun", "A sun that sends no light, from straight above."), edit=scenes.dark_sun),
    Case(Extreme("all_masked", "Every material alpha-tested, half of them cut out whole."), edit=scenes.all_masked),
    Case(Extreme("lights_0", "No local lights."), edit=scenes.no_lights),
    Case(Extreme("lights_65536", "65,536 point lights."), size=_FEW_TEXELS,
         edit=partial(scenes.many_lights, count=65536)),
    Case(Extreme("radius_0", "Lights that reach nowhere."), edit=partial(scenes.light_radius, metres=0.0)),
    Case(Extreme("radius_1e6", "Lights that reach 1000 km."), edit=partial(scenes.light_radius, metres=1e6)),
    Case(Extreme("intensity_half", "Sun, sky and lights as bright as the largest half float."),
         edit=partial(scenes.intensity, value=HALF_LIMIT)),
    Case(Extreme("emission_half", "Surfaces that emit the largest half float."),
         edit=partial(scenes.emission, radiance=HALF_LIMIT)),
    Case(Extreme("roughness_0", "Mirrors."), edit=partial(scenes.roughness, value=0.0)),
    Case(Extreme("roughness_1", "Nothing but matt surfaces."), edit=partial(scenes.roughness, value=1.0)),
    Case(Extreme("furnace_rough", "White matt surfaces in white light from everywhere: nothing is above 1."),
         size=_FURNACE_SIZE, edit=partial(scenes.furnace, roughness=1.0, metallic=0.0), light=1.0),
    Case(Extreme("furnace_smooth", "White polished surfaces in white light from everywhere: nothing is above 1."),
         size=_FURNACE_SIZE, edit=partial(scenes.furnace, roughness=0.0, metallic=0.0), light=1.0),
    Case(Extreme("furnace_metal", "White metal in white light from everywhere: nothing is above 1."),
         size=_FURNACE_SIZE, edit=partial(scenes.furnace, roughness=0.5, metallic=1.0), light=1.0),
    Case(Extreme("darkness", "No light at all: nothing is above 0."), edit=scenes.darkness, light=0.0),
    Case(Extreme("standard_z", "Standard depth in place of reversed."),
         swap=partial(formats.depth_convention, depth="standard")),
    Case(Extreme("standard_z_d24", "Standard depth in 24 bits."),
         swap=partial(formats.depth_convention, depth="standard", format="d24")),
    Case(Extreme("reversed_z_d24", "Reversed depth in 24 bits."),
         swap=partial(formats.depth_convention, depth="reversed", format="d24")),
    Case(Extreme("depth_d16", "Depth in 16 bits."), swap=partial(formats.depth_format, format="d16")),
    Case(Extreme("depth_d32f", "Depth in floats."), swap=partial(formats.depth_format, format="d32f")),
    Case(Extreme("packed_targets", "Colour in floats of 11 and 10 bits."),
         swap=partial(formats.radiance_format, format="r11g11b10f")),
    Case(Extreme("half_targets", "Colour in half floats."), swap=partial(formats.radiance_format, format="rgba16f")),
    Case(Extreme("float_targets", "Colour in whole floats."), swap=partial(formats.radiance_format, format="rgba32f")),
    Case(Extreme("nan_texels", "Four texels of every float input are NaN."), inject=float("nan")),
    Case(Extreme("inf_texels", "Four texels of every float input are infinite."), inject=float("inf")),
)  # fmt: skip
