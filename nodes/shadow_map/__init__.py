"""Shadow map of the sun: cascades that follow the camera without shimmering."""

from __future__ import annotations

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.node.bindings import depth, read_buffer, write_buffer
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Extreme, Measure, Quantity, Reference
from rendergraph.nodes.gbuffer.geometry import scene_program, solid_queues
from rendergraph.plan.graph import BufferDesc, DrawScene, State

CASCADES_BYTES = 320  # shaders/cascades.glsl
MAX_CASCADES = 4

EXTREMES = (
    Extreme("no_bias", "Neither bias: acne, which stays within the bounds.",
            ("passes.shadows.set.slope_bias=0", "passes.shadows.set.normal_bias=0"),
            skips={"error": "without a bias lit surfaces shadow themselves"}),
    Extreme("largest_bias", "Both biases at their ends.",
            ("passes.shadows.set.slope_bias=16", "passes.shadows.set.normal_bias=8")),
    Extreme("one_cascade", "One cascade over everything.", ("passes.shadows.set.cascades=1",)),
    Extreme("tiny_distance", "Shadows that end right in front of the camera.", ("passes.shadows.set.distance=1e-3",)),
    Extreme("huge_distance", "Shadows without an end.", ("passes.shadows.set.distance=1e9",)),
    Extreme("tiny_map", "One texel more than the filter's margins.", ("resources.shadow.fixed=[16, 16]",),
            skips={"error": "four texels of shadow hold no outline"}),
    Extreme("d16", "The coarsest depth.", ("resources.shadow.format=d16",)),
    Extreme("standard_depth", "The other depth convention.", ("frame.depth=standard",)),
    Extreme("sun_overhead", "The light along an axis.", ("scene.lights.sun.direction=[0, -1, 0]",),
            skips={"error": "outlines of casters fall on those of what they shadow"}),
    Extreme("sun_at_horizon", "Light that grazes the ground.", ("scene.lights.sun.direction=[1, -1e-4, 0]",),
            skips={"error": "a texel covers metres of ground"}),
)  # fmt: skip


class ShadowMapParams(Params):
    """Where shadows end, how the range is split, and what keeps lit surfaces from shadowing themselves."""

    cascades: int = knob(
        MAX_CASCADES, "Cascades drawn; at most the layers of the map.", ge=1, le=MAX_CASCADES, accurate="up"
    )
    distance: float = knob(
        60.0,
        "View depth at which shadows end; ends with the scene if that is nearer.",
        unit="m",
        gt=0,
        accurate="neither",
    )
    split: float = knob(
        0.7,
        "Split of the range: 0 into equal lengths, 1 into equal ratios of depth.",
        ge=0.0,
        le=1.0,
        accurate="neither",
    )
    slope_bias: float = knob(
        1.5,
        "Depth added to casters, per texel of depth slope: hides acne, detaches shadows.",
        unit="texel",
        ge=0,
        le=16,
        accurate="neither",
    )
    normal_bias: float = knob(
        1.0,
        "How far receivers move out along their normals; 1 clears the filter exactly.",
        unit="filter radius",
        ge=0,
        le=8,
        accurate="neither",
    )


class ShadowMap(Node[ShadowMapParams]):
    """Draws cascaded shadow maps of the sun, stabilised, into the layers of one depth array."""

    inputs = {}
    outputs = {
        "map": Port(
            "Square depth texture seen from the sun, one layer a cascade.",
            formats=("d32f", "d24", "d16"), layers=None, holds="sun_shadow",
        ),
        "cascades": Port("Matrices, ranges and texel sizes: 320 bytes (cascades.glsl).", buffer=True),
    }  # fmt: skip
    needs_scene = True
    reference = Reference(
        method="rays",
        measures={
            "visibility": Measure(
                Quantity.SHARE, "mean", 0.05,
                "Share of the sun's light on visible surfaces, through a filter of three taps: its mean error is the "
                "share of them that is lit wrongly.",
            ),
            "map": Measure(
                Quantity.DEPTH, "p99", 2e-6, "Stored depth of the casters, slope bias included.", ideal=False
            ),
        },
        source="Rays along the light and towards the sun in float64; Reeves et al. 1987 for the lookup.",
    )  # fmt: skip
    bounds = {"map": (0.0, 1.0)}
    extremes = EXTREMES
    accuracy_axes = {"resources.shadow.fixed=[256, 256]|[512, 512]|[1024, 1024]": "visibility"}

    def build(self, b: Builder) -> None:
        """Fit the cascades on the device, then draw all of them at once, one instance of each draw a layer."""
        p = self.params
        target, cascades = b.output("map"), b.output("cascades")
        desc = b.texture_desc(target)
        self._check(b, desc.width, desc.height, desc.layers)
        queues = solid_queues(b, in_view=False) if b.requires("sun", "draw") and self._in_view(b) else []
        if not queues:
            b.narrow("map", "d16")  # one distance, which every format holds
            far = 0.0 if b.frame.depth == "reversed" else 1.0
            b.clear("lit", target, (far, 0.0, 0.0, 0.0))
            b.clear("no_cascades", cascades, 0)
            return
        count = min(p.cascades, desc.layers)
        b.compute(
            "fit",
            b.program("cascades.comp"),
            (1, 1, 1),
            bind={"Cascades": write_buffer(cascades)},
            uniforms={
                "u_count": count,
                "u_distance": p.distance,
                "u_split": p.split,
                "u_resolution": float(desc.width),
                "u_normal_bias": p.normal_bias,
            },
        )
        for queue in queues:
            b.raster(
                queue,
                scene_program(b, "<depth_only.frag>", alpha_test=queue == "masked", depth_only=True, layered=True),
                depth=depth(target, clear=1.0) if queue == queues[0] else depth(target, load=True),
                bind={"Cascades": read_buffer(cascades)},
                # Both faces cast: light must not enter a room through the back of its walls. Casters in front of a
                # cascade's volume are flattened onto it.
                work=DrawScene((queue,), instances=count, cull="none"),
                state=State(depth_test="closer", depth_clamp=True, depth_bias=(p.slope_bias, 0.0)),
            )

    def _in_view(self, b: Builder) -> bool:
        """Whether some shadow may fall on what the cameras see."""
        view = b.view
        if view is None:
            return True
        if not view.casters:
            b.leave_out("nothing_casts_into_view", "draw")
            return False
        distance = self.params.distance
        # The distance at which a surface is lit comes from stored depth: twice as far, and where 16 bits tell the two
        # apart, no rounding brings it back.
        if view.depth_range and view.depth_range[0] >= 2.0 * distance and distance < 30000.0 * view.near:
            b.leave_out("shadows_end_before_the_view", "draw", distance=distance, nearest=view.depth_range[0])
            return False
        return True

    def _check(self, b: Builder, width: int, height: int, layers: int) -> None:
        buffer = b.outputs["cascades"].desc
        assert isinstance(buffer, BufferDesc)
        problems = []
        if width != height:
            problems.append((f"map is {width} x {height} texels, not square", "give it `fixed: [2048, 2048]`"))
        if layers > MAX_CASCADES:
            problems.append((f"map has {layers} layers", f"there are at most {MAX_CASCADES} cascades"))
        if buffer.bytes < CASCADES_BYTES:
            problems.append((f"cascades has {buffer.bytes} bytes", f"give it `bytes: {CASCADES_BYTES}`"))
        if problems:
            raise RenderGraphError([
                diagnose("RG225", b.position, name=b.pass_name, problem=what, hint=hint) for what, hint in problems
            ])  # fmt: skip
