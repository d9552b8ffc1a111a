"""A user's vertex and fragment shaders over the scene's geometry, or over vertices the shader makes itself."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import model_validator

from rendergraph.node.bindings import Attachment, depth
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node
from rendergraph.node.params import GraphFile, knob
from rendergraph.node.reference import Extreme
from rendergraph.node.user_shader import UserRasterParams, misuse, require_ports, require_suffix
from rendergraph.plan.graph import DrawArrays, DrawIndirect, DrawScene, State

_SUFFIXES = {
    "vertex": ".vert", "fragment": ".frag", "geometry": ".geom", "tess_control": ".tesc", "tess_evaluation": ".tese",
}  # fmt: skip
_MOST_SEPARATE = 65536  # every call is recorded


EXTREMES = (
    Extreme("one_instance", "A single cube.", ("passes.cubes.set.instances=1",)),
    Extreme("separate", "A draw call a cube.", ("passes.cubes.set.instances=1", "passes.cubes.set.separate=true")),
    Extreme("crowded", "Cubes that cut each other.",
            ("passes.cubes.set.instances=400", "passes.cubes.set.uniforms.u_count=400")),
    Extreme("one_sample", "A sample a pixel.", ("resources.ring.samples=1", "resources.depth.samples=1")),
    Extreme("two_samples", "Two samples a pixel.", ("resources.ring.samples=2", "resources.depth.samples=2")),
    Extreme("standard_depth", "The other depth convention.", ("frame.depth=standard",)),
    Extreme("sixteen_bits_of_depth", "The coarsest depth.", ("resources.depth.format=d16",)),
    Extreme("no_instance", "Nothing to draw.", ("passes.cubes.set.instances=0",), refused="RG205"),
)  # fmt: skip


class DrawParams(UserRasterParams):
    """The shaders, what they draw, and the fixed-function state."""

    vertex: GraphFile | None = knob(
        None, "Vertex shader (.vert), with its own #version; none draws the scene with the library's."
    )
    fragment: GraphFile | None = knob(None, "Fragment shader (.frag); none when only depth is written.")
    geometry: GraphFile | None = knob(None, "Geometry shader (.geom).")
    tess_control: GraphFile | None = knob(None, "Tessellation control shader (.tesc).")
    tess_evaluation: GraphFile | None = knob(None, "Tessellation evaluation shader (.tese).")
    queues: tuple[Literal["opaque", "masked", "blended"], ...] = knob(
        (), "Draw the scene's geometry: these queues, in order."
    )
    vertices: int = knob(
        0,
        "Draw this many vertices without attributes; the shader makes them from gl_VertexID.",
        ge=0,
        accurate="neither",
    )
    indirect: str | None = knob(None, "A buffer read that holds draw arguments, four 32-bit words a draw.")
    draws: int = knob(1, "Draws in the `indirect` buffer.", ge=1, le=65536, accurate="neither")
    instances: int = knob(1, "Instances of each draw.", ge=1, le=1 << 24, accurate="neither")
    separate: bool = knob(
        False,
        "With `vertices`: a draw call an instance, in place of one instanced call; the shader tells instances apart by "
        "`gl_BaseInstanceARB + gl_InstanceID`. To measure what draw calls cost.",
    )
    topology: Literal["triangles", "triangle_strip", "lines", "line_strip", "points"] = knob(
        "triangles", "How vertices make primitives; tessellation shaders take triangles as patches of three."
    )
    depth_test: Literal["closer", "closer_equal", "equal", "always", "farther", "none"] = knob(
        "closer", "Which fragments pass, by distance from the camera, where depth is connected."
    )
    depth_write: bool = knob(True, "Whether fragments that pass write depth.")
    depth_read: str | None = knob(None, "A depth texture read that is tested against and not written.")
    cull: Literal["none", "back", "front"] = knob("none", "Faces left out; fronts are counter-clockwise.")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        for field, suffix in _SUFFIXES.items():
            require_suffix(getattr(self, field), suffix)
        if sum((bool(self.queues), self.vertices > 0, self.indirect is not None)) != 1:
            raise ValueError(
                "set one of queues (the scene's geometry), vertices (a number of them) and indirect (a buffer)"
            )
        if self.separate and (self.vertices == 0 or self.instances > _MOST_SEPARATE):
            raise ValueError(f"separate draws take vertices, and at most {_MOST_SEPARATE} instances")
        if self.vertex is None and (not self.queues or self.tess_evaluation is not None):
            raise ValueError("only the scene's geometry, without tessellation, is drawn without a vertex shader")
        if self.tess_control is not None and self.tess_evaluation is None:
            raise ValueError("tess_control needs tess_evaluation")
        if self.tess_evaluation is not None and self.topology != "triangles":
            raise ValueError("tessellation shaders take triangles, as patches of three vertices")
        return self


class Draw(Node[DrawParams]):
    """Draws the scene's geometry, or vertices made in the shader, with a user's own shaders.

    Ports are named as the shader names them. Outputs that are neither kept nor given a value to start from start at
    zero, depth at far.
    """

    open_ports = True
    exact = True  # of each output, where the user tells the truth of the shader
    extremes = EXTREMES

    def modifies(self, port: str) -> bool:
        """Outputs kept, or blended over."""
        return self.params.keeps(port)

    def build(self, b: Builder) -> None:
        """One draw."""
        params = self.params
        colors, blends, target, buffers = params.attachments(b, start=True)
        if colors and params.fragment is None:
            raise misuse(b, "colour is written without a fragment shader", "set fragment:")
        files = [file for field in _SUFFIXES if (file := getattr(params, field)) is not None]
        defines = dict(params.defines)
        if params.vertex is None:
            files.append("<scene.vert>")
            defines |= {"DEPTH_ONLY": params.fragment is None, "ALPHA_TEST": False, "LAYERED": False}
        target = self._depth(b, target)
        state = State(
            depth_test=None if target is None or params.depth_test == "none" else params.depth_test,
            depth_write=params.depth_write,
            cull=params.cull,
            blend=blends,
        )
        unbound = {params.depth_read, params.indirect}
        b.raster(
            "draw",
            b.program(*files, defines=defines, user=True),
            color=colors,
            depth=target,
            bind=params.bind_reads(b, [port for port in b.inputs if port not in unbound]) | buffers,
            work=self._work(b),
            state=state,
            uniforms=params.uniforms,
        )

    def _depth(self, b: Builder, written: Attachment | None) -> Attachment | None:
        port = self.params.depth_read
        if port is None:
            return None if written is None else depth(
                written.resource, clear=written.clear[0] if written.clear else None, load=written.load
            )  # fmt: skip
        require_ports(b, "depth_read", [port], b.inputs, "read")
        if written is not None:
            raise misuse(
                b, "depth is both written and read-only", "remove depth_read:, or the depth texture from write:"
            )
        return depth(b.input(port), read_only=True)

    def _work(self, b: Builder) -> DrawScene | DrawArrays | DrawIndirect:
        params = self.params
        if params.queues:
            return DrawScene(params.queues, params.instances, params.cull)
        topology = "patches" if params.tess_evaluation is not None else params.topology
        if params.indirect is not None:
            require_ports(b, "indirect", [params.indirect], b.inputs, "read")
            return DrawIndirect(b.input(params.indirect), count=params.draws, topology=topology)
        return DrawArrays(params.vertices, params.instances, topology, params.separate)
