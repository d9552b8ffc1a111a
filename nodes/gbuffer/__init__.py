"""Draws the scene's solid geometry once and stores what later passes need of every visible surface."""

from __future__ import annotations

from typing import Literal

from rendergraph.document.formats import DEPTH
from rendergraph.node.bindings import Attachment, color, depth
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Extreme, Measure, Quantity, Reference
from rendergraph.nodes.gbuffer.geometry import depth_prepass, scene_program, solid_queues
from rendergraph.nodes.gbuffer.packing import NORMAL_ERROR, NORMAL_FORMATS, normal_defines
from rendergraph.plan.graph import DrawScene, State

DEPTH_FORMATS = ("d32f", *sorted(DEPTH - {"d32f"}))
BASE_COLOR_FORMATS = ("srgb8_a8", "rgba8", "rgba16", "rgba16f", "rgba32f")
MATERIAL_FORMATS = ("rgb10_a2", "rgba8", "rgba16", "rgba16f", "rgba32f")
EMISSIVE_FORMATS = ("r11g11b10f", "rgba16f", "rgba32f")

#: Why the error of depth is not held to account there: the rasteriser's arithmetic, whatever is drawn.
_INTERPOLATED = (
    "depth is interpolated over triangles thousands of times as large as the frame, whose slopes float32 holds to six "
    "digits: a view distance is off by 2e-6 at 170 degrees, by 6e-5 in a frame of one row"
)

EXTREMES = (
    Extreme("fov_170", "Clipped triangles, millions of texels large.", skips={"error": _INTERPOLATED}),
    Extreme("frame_8191x1", "Triangles thousands of frames high.", skips={"error": _INTERPOLATED}),
    Extreme("frame_1x8191", "Triangles thousands of frames wide.", skips={"error": _INTERPOLATED}),
    Extreme("prepass", "Behind a depth prepass, tested with equal.", ("passes.gbuffer.set.prepass=full",)),
    Extreme("standard_depth", "The other depth convention.", ("frame.depth=standard",)),
    Extreme("d16", "The coarsest depth.", ("resources.depth.format=d16",)),
    Extreme("coarse_normals", "Octahedral normals of eight bits.", ("resources.normal.format=rg8",)),
    Extreme("half_float", "Half-float targets: truncated where the driver does.",
            ("resources.normal.format=rgba16f", "resources.base_color.format=rgba16f",
             "resources.material.format=rgba16f")),
    Extreme("no_surface", "A camera that looks away from everything.",
            ("scene.source=spheres", "scene.camera.position=[0, 50, 0]", "scene.camera.target=[0, 100, 1]")),
)  # fmt: skip


class GbufferParams(Params):
    """How visibility is resolved. How much is stored is the targets' formats' business."""

    prepass: Literal["off", "full"] = knob(
        "off", "full: draw depth alone first, so that every pixel's material is fetched once."
    )


class Gbuffer(Node[GbufferParams]):
    """Stores depth, normal, base colour, material and emission of the visible surfaces."""

    inputs = {}
    outputs = {
        "depth": Port("Depth of the nearest surface.", formats=DEPTH_FORMATS, holds="scene_depth"),
        "normal": Port("World-space shading normal (packing.glsl).", formats=NORMAL_FORMATS, like="depth"),
        "base_color": Port("Linear base colour.", formats=BASE_COLOR_FORMATS, like="depth"),
        "material": Port(
            "Perceptual roughness, metallic, occlusion; alpha 1 marks unlit surfaces.",
            formats=MATERIAL_FORMATS, like="depth", holds="materials",
        ),
        "emissive": Port(
            "Emitted radiance; black, and not drawn into, when nothing in the scene emits.",
            formats=EMISSIVE_FORMATS, like="depth", optional=True, holds="emission",
        ),
    }  # fmt: skip
    needs_scene = True
    reference = Reference(
        method="rays",
        measures={
            "depth": Measure(Quantity.DEPTH, "p99_ulp", 32.0, "Stored depth of the nearest surface.", "depth", "ulp"),
            "distance": Measure(
                Quantity.SCALAR, "p99_relative", 2e-6, "View-space z that the stored depth stands for, relative."
            ),
            "normal": Measure(
                Quantity.NORMAL, "p99", NORMAL_ERROR["rg16_snorm"], "Angle to the shading normal.", "normal", "degrees"
            ),
            "base_color": Measure(Quantity.SHARE, "max", 0.0131, "Linear base colour.", "base_color"),
            "material": Measure(
                Quantity.SHARE, "max", 8.4e-3, "Roughness, metallic, occlusion and the unlit mark.", "material"
            ),
            "emissive": Measure(Quantity.RADIANCE, "rel_mse", 1.6e-3, "Emitted radiance.", "emissive"),
        },
        source="Rays through the pixels' centres in float64; Cigolle et al., JCGT 3(2), 2014, for the packings.",
    )
    bounds = {
        "depth": (0.0, 1.0), "normal": (-1.0, 1.0), "base_color": (0.0, 65504.0), "material": (0.0, 1.0),
        "emissive": (0.0, 65024.0),
    }  # fmt: skip
    extremes = EXTREMES
    accuracy_axes = {
        "resources.normal.format=rg8|rgb10_a2|rg16_snorm": "normal",
        "resources.depth.format=d16|d24|d32f": "distance",
        "resources.base_color.format=rgba8|rgba16": "base_color",
    }

    def build(self, b: Builder) -> None:
        """Optional prepass, then the opaque queue, then the alpha-tested one; at equal depth the last draw wins."""
        queues = solid_queues(b)
        ports = ["normal", "base_color", "material"]
        if "emissive" in b.outputs:
            if b.sees("emissive", "emissive") and queues:
                ports.append("emissive")
            else:
                b.clear("no_emission", b.output("emissive"))
                b.narrow("emissive", "r8")  # black, and opaque to whoever samples it
        if not queues:
            self._nothing(b, ports)
            return
        prepass = self.params.prepass == "full"
        if prepass:
            depth_prepass(b, b.output("depth"), queues)
        normal = b.texture_desc(b.output("normal")).format
        defines = {**normal_defines(normal), "EMISSIVE": int("emissive" in ports)}
        normal_map = b.sees("normal_mapped", queues[0])
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
