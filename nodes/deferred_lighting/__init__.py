"""Lights a G-buffer: sun with shadows, ambient light, and every local light at every pixel."""

from __future__ import annotations

from rendergraph.document.formats import DEPTH
from rendergraph.node.bindings import color, sample
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.reference import Extreme, Measure, Quantity, Reference
from rendergraph.nodes.deferred_lighting.light_model import SHADOW_PORTS, ShadowParams, light_model
from rendergraph.nodes.gbuffer import BASE_COLOR_FORMATS, EMISSIVE_FORMATS, MATERIAL_FORMATS
from rendergraph.nodes.gbuffer.packing import NORMAL_FORMATS, normal_defines

RADIANCE_FORMATS = ("rgba16f", "rgba32f", "r11g11b10f")

EXTREMES = (
    Extreme("thousands_of_lights", "Many lights reach every pixel.",
            ("scene.lights.points.count=2000", "scene.lights.points.radius=50")),
    Extreme("no_reach", "Lights whose reach is nothing light nothing.", ("scene.lights.points.radius=1e-6",)),
    Extreme("vast_reach", "Lights that reach everywhere.", ("scene.lights.points.radius=1e6",)),
    Extreme("blinding", "Intensities beyond the largest half float: clamped, not infinite.",
            ("scene.lights.points.intensity=1e7",)),
    Extreme("packed_float", "The smallest radiance format.", ("resources.hdr.format=r11g11b10f",)),
    Extreme("coarse_gbuffer", "The coarsest depth and normals.",
            ("resources.depth.format=d16", "resources.normal.format=rg8")),
    Extreme("standard_depth", "The other depth convention.", ("frame.depth=standard",)),
)  # fmt: skip


class DeferredLighting(Node[ShadowParams]):
    """Lights every pixel of a G-buffer by every light: the exact reference for light culling."""

    inputs = {
        "depth": Port("Depth of the surfaces.", formats=("d32f", *sorted(DEPTH - {"d32f"}))),
        "normal": Port("World-space normals.", formats=NORMAL_FORMATS, like="depth"),
        "base_color": Port("Linear base colour.", formats=BASE_COLOR_FORMATS, like="depth"),
        "material": Port("Roughness, metallic, occlusion, unlit.", formats=MATERIAL_FORMATS, like="depth"),
        "emissive": Port("Emitted radiance.", formats=EMISSIVE_FORMATS, like="depth", optional=True),
        "occlusion": Port(
            "Share of the ambient light that arrives, at any resolution.",
            formats=("r8", "r16", "r16f", "r32f", "rg8", "rg16f", "rgba8", "rgba16f"), optional=True,
        ),
        **SHADOW_PORTS,
    }  # fmt: skip
    outputs = {"color": Port("Scene-linear radiance; zero where there is no surface.", formats=RADIANCE_FORMATS)}
    needs_scene = True
    reference = Reference(
        method="float64",
        measures={
            "traced": Measure(
                Quantity.RADIANCE, "rel_mse", 0.5,
                "Radiance with the sun's shadows traced instead of looked up: what the shadow map costs the image.",
            ),
            "color": Measure(
                Quantity.RADIANCE, "rel_mse", 1.2e-5, "Radiance by the float64 light model at the G-buffer's points.",
                "color", ideal=False,
            ),
        },
        source="Walter et al. 2007; Heitz, JCGT 3(2), 2014; Schlick 1994; Karis 2013; traced shadows.",
    )  # fmt: skip
    bounds = {"color": (0.0, 65504.0)}
    extremes = EXTREMES
    accuracy_axes = {"resources.hdr.format=r11g11b10f|rgba16f|rgba32f": "color"}

    def build(self, b: Builder) -> None:
        """One full-screen triangle."""
        defines, bind = light_model(b, "light", self.params.shadow_taps)
        # What another pass than a G-buffer's puts there, nobody knows.
        needed = b.sees if b.holds.get("emissive") == "emission" else b.requires
        emissive = "emissive" in b.inputs and needed("emissive", "light")
        occlusion = "occlusion" in b.inputs and bool(defines["AMBIENT"])
        defines |= normal_defines(b.texture_desc(b.input("normal")).format)
        defines |= {"EMISSIVE": int(emissive), "OCCLUSION": int(occlusion)}
        defines["UNLIT_SURFACES"] = int(b.holds.get("material") != "materials" or b.sees("unlit", "light"))
        for port in ("depth", "normal", "base_color", "material"):
            bind[f"u_{port}"] = sample(b.input(port), aspect="depth" if port == "depth" else "color")
        if emissive:
            bind["u_emissive"] = sample(b.input("emissive"))
        if occlusion:
            bind["u_occlusion"] = sample(b.input("occlusion"), "linear")
        b.raster(
            "light",
            b.program("deferred_lighting.frag", defines=defines),
            color=[color(b.output("color"))],
            bind=bind,
        )
