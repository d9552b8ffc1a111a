"""A user's fragment shader over the whole of its targets."""

from __future__ import annotations

from pydantic import field_validator

from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node
from rendergraph.node.params import GraphFile, knob
from rendergraph.node.reference import Extreme
from rendergraph.node.user_shader import UserRasterParams, require_suffix
from rendergraph.plan.graph import State

EXTREMES = (
    Extreme(
        "frame_8191x1",
        "Waves over thousands of frames' heights.",
        skips={"error": "the plasma's waves are taken at distances up to 12000, where float32 keeps three digits"},
    ),
    Extreme("flat", "A wave without a length.", ("passes.plasma.set.uniforms.u_scale=0.0",)),
    Extreme("standing", "Nothing moves.", ("passes.plasma.set.uniforms.u_speed=0.0",)),
    Extreme("whole_uniforms", "Whole numbers for floats.", ("passes.plasma.set.uniforms.u_scale=3",)),
    Extreme("half_float", "A target of half floats.", ("outputs.image.format=rgba16f", "outputs.image.file=image.npy")),
    Extreme("outside", "A shader from outside the folder.", ("passes.plasma.set.shader=../x.frag",), refused="RG222"),
)


class FullscreenParams(UserRasterParams):
    """The fragment shader and how it is fed."""

    shader: GraphFile = knob(..., "Fragment shader (.frag), with its own #version. It may read `in vec2 v_uv`.")

    @field_validator("shader")
    @classmethod
    def _fragment(cls, file: str) -> str:
        require_suffix(file, ".frag")
        return file


class Fullscreen(Node[FullscreenParams]):
    """Runs a user's fragment shader once for every texel of what it writes.

    Every texture read is a sampler of its port's name, every buffer read a storage block. Textures written are colour
    attachments in the order of the file; one with a depth format is the depth attachment, written by ``gl_FragDepth``.
    """

    open_ports = True
    exact = True  # of each output, where the user tells the truth of the shader
    extremes = EXTREMES

    def modifies(self, port: str) -> bool:
        """Outputs kept, or blended over."""
        return self.params.keeps(port)

    def build(self, b: Builder) -> None:
        """One full-screen triangle."""
        colors, blends, depth, buffers = self.params.attachments(b, start=False)
        state = State(depth_test="always" if depth else None, blend=blends)
        b.raster(
            "draw",
            b.program(self.params.shader, defines=self.params.defines, user=True),
            color=colors,
            depth=depth,
            bind=self.params.bind_reads(b, b.inputs) | buffers,
            state=state,
            uniforms=self.params.uniforms,
        )
