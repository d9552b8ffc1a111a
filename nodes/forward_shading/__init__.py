"""Shades geometry as it is drawn: the whole scene, or the transparent part over an image that has the rest."""

from __future__ import annotations

from typing import Literal

from rendergraph.document.formats import DEPTH
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.node.bindings import Attachment, color, depth
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import knob
from rendergraph.node.reference import Extreme, Measure, Quantity, Reference
from rendergraph.nodes.deferred_lighting import RADIANCE_FORMATS
from rendergraph.nodes.deferred_lighting.light_model import SHADOW_PORTS, ShadowParams, light_model
from rendergraph.nodes.gbuffer.geometry import depth_prepass, scene_program, solid_queues
from rendergraph.plan.graph import PREMULTIPLIED, Blend, DrawScene, State

DEPTH_FORMATS = ("d32f", *sorted(DEPTH - {"d32f"}))
BLACK = (0.0, 0.0, 0.0, 1.0)

EXTREMES = (
    Extreme("frame_1x8191", "Triangles thousands of frames wide.",
            skips={"error": "normals and depth are interpolated over them, whose slopes float32 holds to six digits"}),
    Extreme("without_prepass", "Hidden fragments are shaded, too.", ("passes.solid.set.prepass=off",)),
    Extreme("vast_lights", "Lights that reach everywhere.",
            ("scene.lights.points.count=500", "scene.lights.points.radius=1e6")),
    Extreme("blinding", "Intensities beyond the largest half float: clamped, not infinite.",
            ("scene.lights.points.count=8", "scene.lights.points.intensity=1e7")),
    Extreme("packed_float", "The smallest radiance format.", ("resources.hdr.format=r11g11b10f",)),
    Extreme("d16", "Depth too coarse to tell near layers apart.", ("resources.depth.format=d16",)),
    Extreme("standard_depth", "The other depth convention.", ("frame.depth=standard",)),
    Extreme("widest_filter", "The widest shadow filter.", ("passes.solid.set.shadow_taps=9",)),
)  # fmt: skip


class ForwardShadingParams(ShadowParams):
    """What is drawn, how visibility is resolved, and how the sun's shadow is filtered."""

    queues: Literal["opaque", "transparent", "all"] = knob(
        "all",
        "opaque (with alpha-tested), transparent (over an existing image and depth), or all: one after the other.",
    )
    prepass: Literal["off", "full"] = knob("off", "full: draw depth alone first, so that every pixel is shaded once.")


class ForwardShading(Node[ForwardShadingParams]):
    """Draws the scene and lights every fragment by every light, with or without a depth prepass."""

    inputs = {
        "depth": Port(
            "Depth of the solid surfaces: tested, not written, by the transparent queue alone.",
            formats=DEPTH_FORMATS, optional=True, like="color",
        ),
        **SHADOW_PORTS,
    }  # fmt: skip
    outputs = {
        "color": Port("Scene-linear radiance; the transparent queue alone adds to it.", formats=RADIANCE_FORMATS),
        "depth": Port(
            "Depth of the solid surfaces.", formats=DEPTH_FORMATS, optional=True, like="color", holds="scene_depth"
        ),
    }
    needs_scene = True
    reference = Reference(
        method="rays",
        measures={
            "traced": Measure(
                Quantity.RADIANCE, "rel_mse", 0.5,
                "Radiance with the sun's shadows traced instead of looked up: what the shadow map costs the image.",
            ),
            "color": Measure(
                Quantity.RADIANCE, "rel_mse", 1.2e-5, "Radiance by the light model in float64 at what rays hit.",
                "color", ideal=False,
            ),
        },
        source="Rays through the pixels' centres; Walter et al. 2007; Heitz, JCGT 3(2), 2014; Porter and Duff 1984.",
    )  # fmt: skip
    bounds = {"color": (0.0, 65504.0), "depth": (0.0, 1.0)}
    extremes = EXTREMES
    accuracy_axes = {
        "resources.hdr.format=r11g11b10f|rgba16f|rgba32f": "color",
        "resources.shadow.fixed=[256, 256]|[1024, 1024]": "traced",
    }

    def modifies(self, port: str) -> bool:
        """The transparent queue alone is blended over what is there."""
        return port == "color" and self.params.queues == "transparent"

    def build(self, b: Builder) -> None:
        """Optional prepass, opaque and alpha-tested queues, then the blended one, back to front."""
        transparent_only = self.params.queues == "transparent"
        self._check_depth(b, transparent_only)
        solid = [] if transparent_only else solid_queues(b)
        blended = self.params.queues != "opaque" and b.sees("blended", "blended")
        if transparent_only:
            target = b.input("depth")
        elif "depth" in b.outputs:
            target = b.output("depth")
        else:
            target = b.texture("depth", "d32f", like=b.output("color"))
        if not transparent_only and not solid:
            far = 0.0 if b.frame.depth == "reversed" else 1.0
            b.clear("no_depth", target, (far, 0.0, 0.0, 0.0))
            b.clear("no_color", b.output("color"), BLACK)
        prepass = self.params.prepass == "full" and not transparent_only
        if prepass:
            depth_prepass(b, target, solid)
        queues = [*solid, *(["blended"] if blended else [])]
        self._draw(b, queues, target, prepass)

    def _draw(self, b: Builder, queues: list[str], target: str, prepass: bool) -> None:
        if not queues:
            return
        defines, bind = light_model(b, queues[0], self.params.shadow_taps)
        normal_map = b.sees("normal_mapped", queues[0])
        width, height = b.size(b.output("color"))
        for queue in queues:
            first = queue == queues[0] and queue != "blended"
            blend: tuple[Blend | None, ...] = (PREMULTIPLIED,) if queue == "blended" else ()
            # At equal depth the last draw wins, as it does after a prepass and in a G-buffer.
            test = "equal" if prepass and queue != "blended" else "closer_equal"
            b.raster(
                queue,
                scene_program(
                    b,
                    "forward_shading.frag",
                    alpha_test=queue == "masked",
                    normal_map=normal_map,
                    defines={**defines, "BLENDED_QUEUE": int(queue == "blended")},
                ),
                color=[color(b.output("color"), clear=BLACK) if first else color(b.output("color"), load=True)],
                depth=_depth(target, first, read_only=prepass or queue == "blended"),
                bind=bind,
                work=DrawScene((queue,)),
                state=State(depth_test=test, blend=blend),
                uniforms={"u_size": (float(width), float(height))},
            )

    def _check_depth(self, b: Builder, transparent_only: bool) -> None:
        problem = ""
        if transparent_only and ("depth" in b.outputs or "depth" not in b.inputs):
            problem, hint = "the transparent queue tests depth and never writes it", "connect depth under read:"
        elif not transparent_only and "depth" in b.inputs:
            problem, hint = "solid geometry starts from an empty depth", "connect depth under write:, or not at all"
        if problem:
            raise RenderGraphError([diagnose("RG225", b.position, name=b.pass_name, problem=problem, hint=hint)])


def _depth(target: str, first: bool, *, read_only: bool) -> Attachment:
    if read_only:
        return depth(target, read_only=True)
    return depth(target, clear=1.0) if first else depth(target, load=True)
