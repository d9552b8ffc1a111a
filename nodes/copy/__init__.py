"""Copies a texture or buffer: as it is, scaled and converted, or resolved from several samples."""

from __future__ import annotations

from typing import Literal

from rendergraph.document.formats import FORMATS
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Extreme, Measure, Quantity, Reference
from rendergraph.node.user_shader import misuse
from rendergraph.plan.graph import BufferDesc, TextureDesc

ANY_SAMPLES = (1, 2, 4, 8)
ANY_FORMAT = ("rgba8", *sorted(FORMATS.keys() - {"rgba8"}))


EXTREMES = (
    Extreme("nan_texels", "Bits are kept.", skips={"finite": "a copy keeps what it is given"}),
    Extreme("inf_texels", "Bits are kept.", skips={"finite": "a copy keeps what it is given"}),
    Extreme("one_texel", "A source of one texel and one level.",
            ("resources.tiles.fixed=[1, 1]", "resources.pyramid.mips=1", "passes.chain.set.mips=false")),
    Extreme("odd_size", "Levels whose filter OpenGL does not say.", ("resources.tiles.fixed=[37, 13]",)),
    Extreme("through_the_host", "Read back and uploaded.", ("passes.chain.set.path=host",)),
    Extreme("blitted", "Scaled and converted.", ("resources.pyramid={format: rgba16f, fixed: [100, 300], mips: 0}",
            "passes.chain.set.blit=true", "passes.chain.set.linear=true")),
    Extreme("half_float", "Levels of half floats.", ("resources.tiles.format=rgba16f",)),
    Extreme("levels_left_over", "Levels nobody would fill.", ("passes.chain.set.mips=false",), refused="RG225"),
    Extreme("another_layout", "Bits that do not fit.", ("resources.pyramid={format: r8, fixed: [512, 512], mips: 0}",),
            refused="RG225"),
)  # fmt: skip


class CopyParams(Params):
    """How much the copy may change."""

    blit: bool = knob(False, "Scale to the destination's size, convert the format, or resolve samples.")
    linear: bool = knob(False, "Interpolate when a blit scales, instead of taking the nearest texel.")
    mips: bool = knob(False, "Then fill the destination's lower mip levels by averaging.")
    path: Literal["device", "host"] = knob(
        "device", "host: through the host's memory, waiting for the device every frame; to measure what that costs."
    )


class Copy(Node[CopyParams]):
    """Copies one resource into another.

    Without ``blit`` sizes are equal and formats belong to one view class (GL 4.5, table 8.22), and bits are kept.
    """

    inputs = {"source": Port("What is copied.", ANY_FORMAT, buffer=True, samples=ANY_SAMPLES, layers=None)}
    outputs = {"destination": Port("Where it goes.", ANY_FORMAT, buffer=True, samples=ANY_SAMPLES, layers=None)}
    exact = True
    reference = Reference(
        "float64",
        {
            "destination": Measure(
                Quantity.SCALAR, "max", 0.0, "The source's bits; with blit its values, scaled and converted; below it "
                "the means of four texels. In shares of what a conversion may round.",
            ),
        },
        source="OpenGL 4.5, 18.3.1 and 8.14.4",
    )  # fmt: skip
    extremes = EXTREMES

    def build(self, b: Builder) -> None:
        """A copy, and mip levels when asked for."""
        source, destination = b.input("source"), b.output("destination")
        one, two = b.inputs["source"].desc, b.outputs["destination"].desc
        if isinstance(one, TextureDesc) and isinstance(two, TextureDesc):
            problem = self._blit_problem(one, two) if self.params.blit else self._copy_problem(one, two)
            hint = "" if self.params.blit else "set blit: true to scale, convert or resolve"
        elif isinstance(one, BufferDesc) and isinstance(two, BufferDesc):
            problem, hint = f"{one.bytes} bytes do not fit into {two.bytes}", "make the destination as large"
            problem = "" if one.bytes == two.bytes else problem
        else:
            problem, hint = "a texture and a buffer cannot be copied into each other", "use the compute node"
        if not problem and self.params.path == "host":
            problem, hint = self._host_problem(one, two), "use path: device"
        if problem:
            raise misuse(b, problem, hint or "choose matching resources")
        host = self.params.path == "host"
        b.copy("copy", source, destination, blit=self.params.blit, linear=self.params.linear, host=host)
        if self.params.mips and isinstance(two, TextureDesc):
            b.mips("mips", destination)

    def _copy_problem(self, one: TextureDesc, two: TextureDesc) -> str:
        if (one.width, one.height) != (two.width, two.height):
            return f"the source is {one.width} x {one.height}, the destination {two.width} x {two.height}"
        if FORMATS[one.format].view_class != FORMATS[two.format].view_class:
            return f"{one.format} and {two.format} are laid out differently"
        if one.layers != two.layers:
            return f"the source has {one.layers} layers, the destination {two.layers}"
        if one.samples != two.samples:
            return f"the source has {one.samples} samples a texel, the destination {two.samples}"
        return self._mip_problem(one, two)

    def _blit_problem(self, one: TextureDesc, two: TextureDesc) -> str:
        """The rules of glBlitNamedFramebuffer (GL 4.5, 18.3.1)."""
        first, second = FORMATS[one.format], FORMATS[two.format]
        same_size = (one.width, one.height) == (two.width, two.height)
        if first.depth != second.depth:
            return "depth and colour are never converted into each other"
        if first.depth and one.format != two.format:
            return f"depth of different formats ({one.format}, {two.format}) is never converted"
        if first.sampler != second.sampler:
            return f"{one.format} and {two.format} are never converted into each other"
        if self.params.linear and (first.depth or first.sampler):
            return f"{one.format} is never interpolated"
        if one.samples > 1 and not same_size:
            return "samples are resolved at one size only"
        if two.samples > 1 and one.samples != two.samples:
            return f"{one.samples} samples cannot be spread over {two.samples}"
        if one.layers != two.layers:
            return f"the source has {one.layers} layers, the destination {two.layers}"
        return self._mip_problem(one, two, same=False)

    def _host_problem(self, one: TextureDesc | BufferDesc, two: TextureDesc | BufferDesc) -> str:
        if isinstance(one, BufferDesc) or isinstance(two, BufferDesc):
            return ""
        if self.params.blit or one.format != two.format:
            return "texels that pass through the host are neither scaled nor converted"
        if one.samples > 1 or FORMATS[one.format].stencil:
            return "several samples a texel, or depth with stencil, do not pass through the host"
        return ""

    def _mip_problem(self, one: TextureDesc, two: TextureDesc, same: bool = True) -> str:
        if self.params.mips and (two.mips == 1 or FORMATS[two.format].sampler or FORMATS[two.format].depth):
            return "mips: the destination must have several levels and a colour format that can be averaged"
        if two.mips > 1 and not self.params.mips and (one.mips != two.mips or not same):
            return "the destination's lower mip levels would stay undefined; set mips: true"
        if one.mips > two.mips and same:
            return f"the source has {one.mips} mip levels, the destination {two.mips}"
        return ""
