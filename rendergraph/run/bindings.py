"""Binds what a shader names to what a sub-pass declares: textures, images, blocks, and the scene's own."""

from __future__ import annotations

from pathlib import Path

from rendergraph.device import enums
from rendergraph.device.buffers import Buffer
from rendergraph.device.context import Device
from rendergraph.device.programs import LinkedProgram
from rendergraph.device.reflection import Unit
from rendergraph.device.samplers import sampler
from rendergraph.device.textures import Texture, create_view, level_size
from rendergraph.document.formats import FORMATS
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.plan.graph import Access, DrawScene, SubPass, Target, TextureDesc, Usage
from rendergraph.plan.plan import Plan
from rendergraph.run.allocation import Allocation
from rendergraph.run.geometry import SceneGeometry
from rendergraph.run.state import Recorder

#: Uniform binding point of the ``Frame`` block in every program: above what a program's own blocks get, below the 84
#: that OpenGL 4.5 guarantees.
FRAME_BINDING = 80

_IMAGE_ACCESS = {
    Usage.IMAGE_READ: enums.READ_ONLY,
    Usage.IMAGE_WRITE: enums.WRITE_ONLY,
    Usage.IMAGE_UPDATE: enums.READ_WRITE,
}
#: In draws of the scene, a sampler for each slot of ``Material.textures``: a batch binds the arrays its materials use.
SCENE_TEXTURES = "u_textures"


class Bindings:
    """Records the binding calls of sub-passes, for one parity of a plan."""

    def __init__(
        self,
        device: Device,
        plan: Plan,
        storage: Allocation,
        geometry: SceneGeometry | None,
        recorder: Recorder,
        parity: int,
    ) -> None:
        self._device = device
        self._plan = plan
        self._storage = storage
        self._geometry = geometry
        self._recorder = recorder
        self._parity = parity
        self._views: dict[tuple[Texture, int | None, int | None, str], Texture] = {}

    def bind(self, subpass: SubPass, program: LinkedProgram) -> None:
        """Bind everything the program declares.

        :raises RenderGraphError: RG566 for a sampler, image or block that neither the sub-pass nor the scene provides.
            GL itself would read zeros without a word.
        """
        named = {a.name: a for a in subpass.accesses if a.name is not None}
        for name, sampled in program.samplers.items():
            if name == SCENE_TEXTURES and isinstance(subpass.work, DrawScene):
                self._scene_textures(sampled)
            else:
                self._sample(sampled.unit, self._of(named, name, "sampler", subpass))
        for name, image in program.images.items():
            self._image(image.unit, self._of(named, name, "image", subpass))
        for name, block in program.storage_blocks.items():
            if not self._scene_block(enums.SHADER_STORAGE_BUFFER, block.binding, name):
                buffer = self._buffer(self._of(named, name, "storage block", subpass))
                self._range(enums.SHADER_STORAGE_BUFFER, block.binding, buffer)
        for name, block in program.uniform_blocks.items():
            if name == "Frame":
                index = self._device.gl.glGetProgramResourceIndex(program.glo, enums.UNIFORM_BLOCK, b"Frame")
                self._device.gl.glUniformBlockBinding(program.glo, index, FRAME_BINDING)
            elif not self._scene_block(enums.UNIFORM_BUFFER, block.binding, name):
                buffer = self._buffer(self._of(named, name, "uniform block", subpass))
                self._range(enums.UNIFORM_BUFFER, block.binding, buffer)

    def _of(self, named: dict[str, Access], name: str, kind: str, subpass: SubPass) -> Access:
        if name in named:
            return named[name]
        assert subpass.program is not None
        shown = subpass.program.stages[0][1]
        raise RenderGraphError([
            diagnose("RG566", subpass.position, subpass=subpass.name, kind=kind, name=name, file=_short(shown))
        ])  # fmt: skip

    def _buffer(self, access: Access) -> Buffer:
        return self._storage.buffer(access.resource, self._parity)

    def _range(self, target: int, binding: int, buffer: Buffer) -> None:
        self._recorder.set(
            (target, binding), buffer, self._device.gl.glBindBufferRange,
            target, binding, buffer.glo, buffer.offset, buffer.bytes,
        )  # fmt: skip

    def _scene_block(self, target: int, binding: int, name: str) -> bool:
        """Bind one of the scene's own blocks, storage or uniform; false where it has none of this name."""
        if self._geometry is None or name not in self._geometry.blocks:
            return False
        if name == "Lights" and self._geometry.lights_move:
            self._recorder.forget((target, binding))
            self._recorder.call(self._geometry.bind_lights, target, binding)
        else:
            self._range(target, binding, self._geometry.blocks[name])
        return True

    def _scene_textures(self, slots: Unit) -> None:
        """Any array at first: a batch leaves the slots that its materials do not fill as they are."""
        assert self._geometry is not None
        filter_ = sampler(self._device, "mipmap", "repeat", False)
        any_array = self._geometry.textures[0].glo if self._geometry.textures else 0
        for unit in slots.units:
            self._texture(unit, any_array, filter_)

    def _sample(self, unit: int, access: Access) -> None:
        reversed_depth = self._plan.graph.frame.depth == "reversed"
        texture = self._narrowed(access)
        self._texture(unit, texture.glo, sampler(self._device, access.filter, access.wrap, reversed_depth))

    def _texture(self, unit: int, texture: int, sampler_: int) -> None:
        gl = self._device.gl
        self._recorder.set(("texture", unit), texture, gl.glBindTextureUnit, unit, texture)
        self._recorder.set(("sampler", unit), sampler_, gl.glBindSampler, unit, sampler_)

    def _image(self, unit: int, access: Access) -> None:
        texture = self._storage.texture(access.resource, self._parity)
        layered = texture.layered and access.layer is None
        arguments = (
            texture.glo, access.mip or 0, int(layered), access.layer or 0, _IMAGE_ACCESS[access.usage],
            FORMATS[texture.desc.format].internal_format,
        )  # fmt: skip
        self._recorder.set(("image", unit), arguments, self._device.gl.glBindImageTexture, unit, *arguments)

    def _narrowed(self, access: Access) -> Texture:
        """The texture, or a view of the one mip, layer or stencil aspect that the access names."""
        texture = self._storage.texture(access.resource, self._parity)
        stencil = access.aspect == "stencil"
        if access.mip is None and access.layer is None and not stencil:
            return texture
        key = texture, access.mip, access.layer, access.aspect
        if key not in self._views:
            desc, mip = texture.desc, access.mip or 0
            width, height, layers = level_size(desc, mip)
            whole = access.layer is None
            shape = TextureDesc(
                desc.format, width, height, layers if whole else 1, desc.mips if access.mip is None else 1,
                desc.samples, desc.target if whole else Target.D2,
            )  # fmt: skip
            label = f"{texture.label} mip {access.mip} layer {access.layer} {access.aspect}"
            self._views[key] = create_view(
                self._device, texture, shape, label, mip=mip, layer=access.layer or 0, stencil=stencil
            )
        return self._views[key]


def _short(path: Path) -> str:
    return f"{path.parent.name}/{path.name}"
