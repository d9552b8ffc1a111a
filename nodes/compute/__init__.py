"""A user's compute shader."""

from __future__ import annotations

import re
from typing import Annotated, Self

from pydantic import Field, field_validator, model_validator

from rendergraph.node.bindings import Binding, load_image, store_image, update_buffer, update_image, write_buffer
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node
from rendergraph.node.params import GraphFile, knob
from rendergraph.node.reference import Extreme
from rendergraph.node.user_shader import UserShaderParams, misuse, require_ports, require_suffix
from rendergraph.plan.graph import BufferDesc, DispatchIndirect, TextureDesc

Groups = Annotated[int, Field(ge=1, le=65535)]
Tile = Annotated[int, Field(ge=1, le=1024)]

_LOCAL_SIZE = re.compile(r"local_size_([xy])\s*=\s*(\d+)")


EXTREMES = (
    Extreme("first_frame", "History that is empty.", ("frame.count=1",)),
    Extreme("one_cell", "A torus of one cell, its own neighbour eight times.",
            ("resources.cells={format: r8ui, fixed: [1, 1]}",)),
    Extreme("line", "A torus of one row.", ("resources.cells={format: r8ui, fixed: [77, 1]}",)),
    Extreme("odd_groups", "Groups that overhang.", ("resources.cells={format: r8ui, fixed: [33, 17]}",)),
    Extreme("one_invocation", "Groups of one.", ("passes.step.set.per_texel=[1, 1]",)),
    Extreme("largest_group", "Groups of 1024.", ("passes.step.set.per_texel=[32, 32]",)),
    Extreme("too_large_group", "More invocations than a group has.", ("passes.step.set.per_texel=[64, 64]",),
            refused="RG205"),
)  # fmt: skip


class ComputeParams(UserShaderParams):
    """The compute shader, how it is fed, and how many work groups run."""

    shader: GraphFile = knob(..., "Compute shader (.comp), with its own #version and local size.")
    images: tuple[str, ...] = knob((), "Textures read with imageLoad instead of through a sampler, by port.")
    update: tuple[str, ...] = knob((), "Outputs that are read as well as written, or used with atomics.")
    groups: tuple[Groups, Groups, Groups] | None = knob(None, "Number of work groups, whatever the sizes.")
    per_texel: tuple[Tile, Tile] | None = knob(
        None,
        "Local size of a shader that runs once a texel, 8 x 8 unless told: groups cover the output `of`. "
        "The shader sees it as TILE_X and TILE_Y.",
        unit="texels",
    )
    of: str | None = knob(None, "The output (or input) whose texels are covered; the first texture written by default.")
    indirect: str | None = knob(None, "A buffer read that holds the number of work groups, three 32-bit words.")

    @field_validator("shader")
    @classmethod
    def _compute(cls, file: str) -> str:
        require_suffix(file, ".comp")
        return file

    @model_validator(mode="after")
    def _one_size(self) -> Self:
        given = [name for name in ("groups", "per_texel", "indirect") if getattr(self, name) is not None]
        if len(given) > 1:
            raise ValueError(f"{' and '.join(given)} exclude each other")
        if self.of is not None and (self.groups is not None or self.indirect is not None):
            raise ValueError("`of` goes with per_texel")
        if self.per_texel is not None and self.per_texel[0] * self.per_texel[1] > 1024:
            raise ValueError("a work group has at most 1024 invocations")
        return self


class Compute(Node[ComputeParams]):
    """Runs a user's compute shader.

    Textures read are samplers of their port's name, or images when listed in ``images``; textures written are images,
    buffers are storage blocks. An output is taken to be replaced whole unless listed in ``update``.
    """

    open_ports = True
    exact = True  # of each output, where the user tells the truth of the shader
    extremes = EXTREMES

    def modifies(self, port: str) -> bool:
        """Outputs that are updated."""
        return port in self.params.update

    def build(self, b: Builder) -> None:
        """One dispatch."""
        params = self.params
        require_ports(b, "images", params.images, b.inputs, "read")
        require_ports(b, "update", params.update, b.outputs, "write")
        if not b.outputs:
            raise misuse(b, "nothing is written", "connect a texture or buffer under write:")
        defines = dict(params.defines)
        work: tuple[int, int, int] | DispatchIndirect
        if params.indirect is not None:
            require_ports(b, "indirect", [params.indirect], b.inputs, "read")
            work = DispatchIndirect(b.input(params.indirect))
        elif params.groups is not None:
            work = params.groups
        else:
            tile = params.per_texel or (8, 8)
            self._check_local_size(b, tile)
            work = self._cover(b, tile)
            defines |= {"TILE_X": tile[0], "TILE_Y": tile[1]}
        program = b.program(params.shader, defines=defines, user=True)
        b.compute("dispatch", program, work, bind=self._bindings(b), uniforms=params.uniforms)

    def _bindings(self, b: Builder) -> dict[str, Binding]:
        params = self.params
        sampled = [port for port in b.inputs if port not in params.images and port != params.indirect]
        bind = params.bind_reads(b, sampled)
        bind |= {port: load_image(b.input(port)) for port in params.images}
        for port, resource in b.outputs.items():
            if port in bind:
                raise misuse(b, f"'{port}' names both a read and a write", "give them two names, as in the shader")
            update = port in params.update
            if isinstance(resource.desc, BufferDesc):
                bind[port] = update_buffer(resource.name) if update else write_buffer(resource.name)
            else:
                bind[port] = update_image(resource.name) if update else store_image(resource.name)
        return bind

    def _cover(self, b: Builder, tile: tuple[int, int]) -> tuple[int, int, int]:
        """Work groups over the texture `of`, one layer each in z."""
        connected = {**b.inputs, **b.outputs}
        if self.params.of is not None:
            require_ports(b, "of", [self.params.of], connected, "read or write")
            over = connected[self.params.of]
        else:
            textures = [r for r in b.outputs.values() if isinstance(r.desc, TextureDesc)]
            if not textures:
                raise misuse(b, "only buffers are written, so there are no texels to cover", "set groups: [x, y, z]")
            over = textures[0]
        if not isinstance(over.desc, TextureDesc):
            raise misuse(b, f"'{self.params.of}' is a buffer and has no texels", "name a texture, or set groups:")
        return b.groups(over.name, tile, over.desc.layers)

    def _check_local_size(self, b: Builder, tile: tuple[int, int]) -> None:
        """A local size written as numbers must be the tile: else texels are left out, or done twice."""
        try:
            source = (b.graph_folder / self.params.shader).read_text(encoding="utf-8", errors="replace")
        except OSError:
            return  # the device reports it, with the reason
        for axis, number in _LOCAL_SIZE.findall(source):
            if int(number) != tile["xy".index(axis)]:
                problem = f"per_texel is {list(tile)}, but {self.params.shader} has local_size_{axis} = {number}"
                raise misuse(b, problem, "make them agree: `layout(local_size_x = TILE_X, local_size_y = TILE_Y) in;`")
