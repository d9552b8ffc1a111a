"""What the nodes for users' own shaders share: uniforms, defines, sampling of reads, start and blend of targets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import PurePosixPath
from typing import Annotated, Any, Final, Literal

from pydantic import Field

from rendergraph.document.formats import FORMATS
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.suggest import did_you_mean
from rendergraph.node.bindings import Attachment, Binding, read_buffer, sample, update_buffer
from rendergraph.node.builder import Builder
from rendergraph.node.params import Params, knob
from rendergraph.plan.graph import ADDITIVE, PREMULTIPLIED, Blend, BufferDesc, TextureDesc

Identifier = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=64)]
Vector = Annotated[tuple[int, ...] | tuple[float, ...], Field(min_length=2, max_length=64)]
Uniform = int | float | Vector
Define = bool | int | float | Annotated[str, Field(pattern=r"^[A-Za-z0-9_.+\-*/() ]*$", max_length=200)]
Filter = Literal["nearest", "linear", "mipmap", "compare"]
Wrap = Literal["clamp", "repeat", "border"]
Color = tuple[float, float, float, float]
Start = float | Color
BlendMode = Literal["none", "add", "alpha", "premultiplied", "multiply", "min", "max"]

BLENDS: Final[Mapping[str, Blend | None]] = {
    "none": None,
    "add": ADDITIVE,
    "alpha": Blend("src_alpha", "one_minus_src_alpha", "one", "one_minus_src_alpha"),
    "premultiplied": PREMULTIPLIED,
    "multiply": Blend("dst_color", "zero"),
    "min": Blend("one", "one", equation="min"),
    "max": Blend("one", "one", equation="max"),
}


class UserShaderParams(Params):
    """What every user shader may be given. Names of ports are names in the shader."""

    uniforms: dict[Identifier, Uniform] = knob({}, "Values of the shader's uniforms: a number, or a list for a vector.")
    defines: dict[Identifier, Define] = knob(
        {}, "Macros defined in front of the shader; true and false become 1 and 0."
    )
    filter: Filter | dict[str, Filter] = knob(
        "nearest",
        "Filter of textures read, for all or by port: mipmap is trilinear, compare is for shadows.",
    )
    wrap: Wrap | dict[str, Wrap] = knob("clamp", "Addressing outside 0..1: one for all or one by port.")
    stencil: tuple[str, ...] = knob(
        (), "Reads that sample the stencil of a depth-stencil texture instead of its depth."
    )

    def bind_reads(self, b: Builder, ports: Iterable[str]) -> dict[str, Binding]:
        """Samplers, and read-only storage blocks for buffers, named as the ports. RG225 for ports not connected."""
        named = {"filter": self.filter, "wrap": self.wrap, "stencil": dict.fromkeys(self.stencil)}
        for field, by_port in named.items():
            if isinstance(by_port, dict):
                require_ports(b, field, by_port, b.inputs, "read")
        bind: dict[str, Binding] = {}
        for port in ports:
            desc = b.inputs[port].desc
            if isinstance(desc, BufferDesc):
                bind[port] = read_buffer(b.input(port))
                continue
            filter = self.filter if isinstance(self.filter, str) else self.filter.get(port, "nearest")
            wrap = self.wrap if isinstance(self.wrap, str) else self.wrap.get(port, "clamp")
            if isinstance(self.filter, str) and (FORMATS[desc.format].sampler or desc.samples > 1):
                filter = "nearest"  # a choice for all inputs means those that can be filtered
            bind[port] = sample(b.input(port), filter, wrap=wrap, aspect=self._aspect(b, port, desc))
        return bind

    def _aspect(self, b: Builder, port: str, desc: TextureDesc) -> str:
        if port in self.stencil and not FORMATS[desc.format].stencil:
            raise misuse(b, f"stencil names '{port}', whose format {desc.format} has none", "use d24s8 or d32fs8")
        if port in self.stencil:
            return "stencil"
        return "depth" if FORMATS[desc.format].depth else "color"


class UserRasterParams(UserShaderParams):
    """A user shader that draws into attachments: every texture written, colours in the order of the file."""

    blend: BlendMode | dict[str, BlendMode] = knob("none", "Blending: one for all colour outputs or one by output.")
    clear: dict[str, Start] = knob(
        {},
        "Value an output starts from: four numbers, or one for all channels; for depth a distance, 0 near to 1 far.",
    )
    keep: tuple[str, ...] = knob((), "Outputs that keep what they hold and are drawn over.")

    def blend_of(self, port: str) -> str:
        """The blend mode of an output."""
        return self.blend if isinstance(self.blend, str) else self.blend.get(port, "none")

    def keeps(self, port: str) -> bool:
        """Whether an output's earlier content is needed: stated, or because it is blended over and not cleared."""
        return port in self.keep or (self.blend_of(port) != "none" and port not in self.clear)

    def attachments(
        self, b: Builder, start: bool
    ) -> tuple[list[Attachment], tuple[Blend | None, ...], Attachment | None, dict[str, Binding]]:
        """(colours, their blends, depth, buffers by name) of what is written.

        ``start``: whether an output that is neither kept nor cleared by the user is cleared to zero (depth: to far),
        which draws that leave texels untouched need.
        """
        for field, ports in (("clear", self.clear), ("keep", self.keep), ("blend", self.blend)):
            if not isinstance(ports, str):
                require_ports(b, field, ports, b.outputs, "write")
        both = sorted(set(self.keep) & set(self.clear))
        if both:
            raise misuse(b, f"output '{both[0]}' is both kept and cleared", "remove it from keep: or from clear:")
        colors: list[Attachment] = []
        blends: list[Blend | None] = []
        depths: list[Attachment] = []
        buffers: dict[str, Binding] = {}
        for port, resource in b.outputs.items():
            if isinstance(resource.desc, BufferDesc):
                buffers[port] = update_buffer(resource.name)
            elif FORMATS[resource.desc.format].depth:
                depths.append(Attachment(resource.name, self._start(b, port, start, 1.0), port in self.keep))
            else:
                colors.append(Attachment(resource.name, self._start(b, port, start, 0.0), self.keeps(port)))
                blends.append(BLENDS[self.blend_of(port)])
        if len(depths) > 1:
            raise misuse(b, "two depth textures are written", "write one depth texture a pass")
        if not colors and not depths:
            raise misuse(
                b, "no texture is written", "connect one under write:, or use the compute node for buffers alone"
            )
        if len(colors) > 8:
            raise misuse(b, f"{len(colors)} colour textures are written", "OpenGL draws into at most 8 at once")
        return colors, tuple(blends) if any(blends) else (), depths[0] if depths else None, buffers

    def _start(self, b: Builder, port: str, start: bool, default: float) -> Color | None:
        value = self.clear.get(port, default if start and not self.keeps(port) else None)
        return (value, value, value, value) if isinstance(value, (int, float)) else value


def require_ports(b: Builder, field: str, names: Iterable[str], ports: Mapping[str, Any], section: str) -> None:
    """Raise RG225 when a parameter names a port that is not connected."""
    for name in names:
        if name not in ports:
            raise misuse(b, f"{field}: '{name}' is not connected under {section}:", did_you_mean(name, ports))


def misuse(b: Builder, problem: str, hint: str) -> RenderGraphError:
    """A user's mistake that only this pass's connections and parameters together show (RG225)."""
    return RenderGraphError([diagnose("RG225", b.position, name=b.pass_name, problem=problem, hint=hint)])


def require_suffix(file: str | None, suffix: str) -> str | None:
    """For pydantic validators: the stage of a shader is told by its file's suffix. Raises ``ValueError``."""
    if file is not None and PurePosixPath(file).suffix != suffix:
        raise ValueError(f"'{file}' must end in {suffix}")
    return file
