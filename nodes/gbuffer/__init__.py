"""Draws the scene's solid geometry once and stores what later passes need of every visible surface."""

from __future__ import annotations

from typing import Literal

from rendergraph.document.formats import DEPTH
from rendergraph.node.bindings import Attachment, color, depth
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.nodes.gbuffer.geometry import depth_prepass, scene_program, solid_queues
from rendergraph.nodes.gbuffer.packing import NORMAL_FORMATS, normal_defines
from rendergraph.plan.graph import DrawScene, State

DEPTH_FORMATS = ("d32f", *sorted(DEPTH - {"d32f"}))
BASE_COLOR_FORMATS = ("srgb8_a8", "rgba8", "rgba16", "rgba16f", "rgba32f")
MATERIAL_FORMATS = ("rgb10_a2", "rgba8", "rgba16", "rgba16f", "rgba32f")
EMISSIVE_FORMATS = ("r11g11b10f", "rgba16f", "rgba32f")


class GbufferParams(Params):
    """How visibility is resolved. How much is stored is the targets' formats' business."""

    prepass: Literal["off", "full"] = knob(
        "off", "full: draw depth alone first, so that every pixel's material is fetched once."
    )


class Gbuffer(Node[GbufferParams]):
    """Stores depth, normal, base colour, material and emission of the visible surfaces."""

    inputs = {}
    outputs = {
        "depth": Port("Depth of the nearest surface.", formats=DEPTH_FORMATS),
        "normal": Port("World-space shading normal (packing.glsl).", formats=NORMAL_FORMATS, like="depth"),
        "base_color": Port("Linear base colour.", formats=BASE_COLOR_FORMATS, like="depth"),
        "material": Port(
            "Perceptual roughness, metallic, occlusion; alpha 1 marks unlit surfaces.",
            formats=MATERIAL_FORMATS, like="depth",
        ),
        "emissive": Port(
            "Emitted radiance; black, and not drawn into, when nothing in the scene emits.",
            formats=EMISSIVE_FORMATS, like="depth", optional=True,
        ),
    }  # fmt: skip
    needs_scene = True

    def build(self, b: Builder) -> None:
        """Optional prepass, then the opaque queue, then the alpha-tested one; at equal depth the last draw wins."""
        queues = solid_queues(b)
        ports = ["normal", "base_color", "material"]
        if "emissive" in b.outputs:
            if b.requires("emissive", "emissive") and queues:
                ports.append("emissive")
            else:
                b.clear("no_emission", b.output("emissive"))
        if not queues:
            self._nothing(b, ports)
            return
        prepass = self.params.prepass == "full"
        if prepass:
            depth_prepass(b, b.output("depth"), queues)
        normal = b.texture_desc(b.output("normal")).format
        defines = {**normal_defines(normal), "EMISSIVE": int("emissive" in ports)}
        normal_map = b.requires("normal_mapped", queues[0])
        for queue in queues:
            first = queue == queues[0]
            b.raster(
                queue,
                scene_program(b, "gbuffer.frag", alpha_test=queue == "masked", normal_map=normal_map, defines=defines),
                color=[
                    color(b.output(port), clear=(0.0, 0.0, 0.0, 0.0)) if first else color(b.output(port), load=True)
                    for port in ports
                ],
                depth=_depth(b.output("depth"), prepass, first),
                work=DrawScene((queue,)),
                state=State(depth_test="equal" if prepass else "closer_equal"),
            )

    def _nothing(self, b: Builder, ports: list[str]) -> None:
        """A scene without solid geometry: everything is background."""
        far = 0.0 if b.frame.depth == "reversed" else 1.0
        b.clear("no_depth", b.output("depth"), (far, 0.0, 0.0, 0.0))
        for port in ports:
            b.clear(f"no_{port}", b.output(port))


def _depth(target: str, prepass: bool, first: bool) -> Attachment:
    if prepass:
        return depth(target, read_only=True)
    return depth(target, clear=1.0) if first else depth(target, load=True)
