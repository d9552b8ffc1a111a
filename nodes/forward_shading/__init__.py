"""Shades geometry as it is drawn: the whole scene, or the transparent part over an image that has the rest."""

from __future__ import annotations

from typing import Literal

from rendergraph.document.formats import DEPTH
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.node.bindings import Attachment, color, depth
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import knob
from rendergraph.nodes.deferred_lighting import RADIANCE_FORMATS
from rendergraph.nodes.deferred_lighting.light_model import SHADOW_PORTS, ShadowParams, light_model
from rendergraph.nodes.gbuffer.geometry import depth_prepass, scene_program, solid_queues
from rendergraph.plan.graph import PREMULTIPLIED, Blend, DrawScene, State

DEPTH_FORMATS = ("d32f", *sorted(DEPTH - {"d32f"}))
BLACK = (0.0, 0.0, 0.0, 1.0)


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
        "depth": Port("Depth of the solid surfaces.", formats=DEPTH_FORMATS, optional=True, like="color"),
    }
    needs_scene = True

    def modifies(self, port: str) -> bool:
        """The transparent queue alone is blended over what is there."""
        return port == "color" and self.params.queues == "transparent"

    def build(self, b: Builder) -> None:
        """Optional prepass, opaque and alpha-tested queues, then the blended one, back to front."""
        transparent_only = self.params.queues == "transparent"
        self._check_depth(b, transparent_only)
        solid = [] if transparent_only else solid_queues(b)
        blended = self.params.queues != "opaque" and b.requires("blended", "blended")
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
        normal_map = b.requires("normal_mapped", queues[0])
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
