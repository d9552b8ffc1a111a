"""The sub-pass builder a node's ``build`` is handed: declares internal targets; adds draws, dispatches, copies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from rendergraph.node.bindings import Attachment, Binding, Color4, attachment_access, bound_accesses
from rendergraph.plan.graph import (
    Access,
    BufferDesc,
    ClearResource,
    CopyBuffer,
    CopyTexture,
    Decision,
    Dispatch,
    DispatchIndirect,
    DrawIndirect,
    Frame,
    Fullscreen,
    GenerateMips,
    Position,
    Program,
    Resource,
    State,
    SubPass,
    Target,
    TextureDesc,
    UniformValue,
    Usage,
    Work,
)
from rendergraph.scene.features import SceneFeatures, ViewFeatures

SHADERS = Path(__file__).resolve().parent.parent / "shaders"

_FULLSCREEN, _STATE = Fullscreen(), State()


@dataclass
class Builder:
    """Collects one pass's sub-passes. ``inputs`` and ``outputs`` map connected port names to resources.

    ``features`` is what the scene holds; ask through :meth:`requires` so that the decision is recorded.
    """

    pass_name: str
    node_folder: Path
    graph_folder: Path
    frame: Frame
    features: SceneFeatures
    full: bool
    inputs: Mapping[str, Resource]
    outputs: Mapping[str, Resource]
    position: Position | None = None
    holds: Mapping[str, str] = field(default_factory=dict)  # input port -> what is sure to be in it (Port.holds)
    resources: dict[str, Resource] = field(default_factory=dict)
    subpasses: list[SubPass] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)
    narrowed: dict[str, str] = field(default_factory=dict)  # output resource -> a format that loses nothing
    _names: set[str] = field(default_factory=set)  # of the sub-passes

    # ---- what is connected

    def input(self, port: str) -> str:
        """The resource connected to an input port; a ``KeyError`` when an optional one is not connected."""
        return self.inputs[port].name

    def output(self, port: str) -> str:
        """The resource connected to an output port."""
        return self.outputs[port].name

    def texture_desc(self, resource: str) -> TextureDesc:
        """The description of a texture resource visible to this pass."""
        desc = self._find(resource).desc
        assert isinstance(desc, TextureDesc), f"{resource} is a buffer"
        return desc

    def size(self, resource: str) -> tuple[int, int]:
        """Width and height of a texture, in texels."""
        desc = self.texture_desc(resource)
        return desc.width, desc.height

    def _find(self, resource: str) -> Resource:
        if resource in self.resources:
            return self.resources[resource]
        for connected in (*self.inputs.values(), *self.outputs.values()):
            if connected.name == resource:
                return connected
        raise KeyError(resource)

    # ---- specialisation

    def requires(self, feature: str, step: str = "") -> bool:
        """Whether the scene has ``feature`` (always, under ``--full``). Records what was left out and why."""
        present = bool(getattr(self.features, feature))
        if not present and not self.full:
            self.leave_out("scene_lacks_feature", step, feature=feature)
        return present or self.full

    def sees(self, feature: str, step: str = "") -> bool:
        """As :meth:`requires`, of what the cameras see: for passes that draw or light the view, and nothing beside it.

        False too where the scene has ``feature`` and nothing of it can come into any view.
        """
        if not self.requires(feature, step):
            return False
        view = self.view
        if view is not None and feature in view.unseen:
            self.leave_out("none_in_view", step, feature=feature)
            return False
        return True

    @property
    def view(self) -> ViewFeatures | None:
        """What is certain of the view; None where nothing is, and under ``--full``."""
        return None if self.full else self.features.view

    def leave_out(self, reason: str, step: str = "", **evidence: Any) -> None:
        """Record that a part of this pass is left out or simplified, and why (plan/explain.py has the sentence)."""
        subject = f"{self.pass_name}.{step}" if step else self.pass_name
        decision = Decision("specialise", reason, subject, evidence)
        if decision not in self.decisions:
            self.decisions.append(decision)

    def narrow(self, port: str, format: str) -> None:
        """Declare that an output's content fits ``format`` without loss, whoever samples it. The resource gets it where
        it is transient, only this pass writes it, and all others sample it.
        """
        if not self.full:
            self.narrowed[self.output(port)] = format

    # ---- internal targets

    def texture(
        self,
        name: str,
        format: str,
        *,
        like: str | None = None,
        scale: float = 1.0,
        size: tuple[int, int] | None = None,
        layers: int = 1,
        mips: int = 1,
        samples: int = 1,
        target: Target | None = None,
    ) -> str:
        """Declare a transient texture, of ``size`` or ``scale`` times ``like`` (default: the frame), rounded up."""
        if size is None:
            base = self.size(like) if like else (self.frame.width, self.frame.height)
            size = (max(1, -int(-base[0] * scale // 1)), max(1, -int(-base[1] * scale // 1)))
        if target is None:
            target = Target.D2_ARRAY if layers > 1 else Target.D2
        return self._declare(name, TextureDesc(format, size[0], size[1], layers, mips, samples, target))

    def buffer(self, name: str, bytes: int) -> str:
        """Declare a transient buffer."""
        return self._declare(name, BufferDesc(bytes))

    def _declare(self, name: str, desc: TextureDesc | BufferDesc) -> str:
        full_name = f"{self.pass_name}.{name}"
        assert full_name not in self.resources, f"{full_name} is declared twice"
        self.resources[full_name] = Resource(full_name, desc, declared=False, position=self.position)
        return full_name

    # ---- programs

    def program(self, *files: str, defines: Mapping[str, Any] | None = None, user: bool = False) -> Program:
        """A program of the shader files named, the stage told by the suffix (.vert .frag .geom .tesc .tese .comp).

        Files lie in the node's folder, in the shared shader folder when the name starts with ``<``
        (``<fullscreen.vert>``), or in the graph's folder for ``user`` files. Defines: booleans become 0/1, numbers and
        words are written out.
        """
        stages = tuple(sorted((_stage(file), self._shader(file, user)) for file in files))
        variant = {"DEPTH_REVERSED": "1" if self.frame.depth == "reversed" else "0"}
        if defines:
            variant |= {k: str(int(v) if isinstance(v, bool) else v) for k, v in defines.items()}
        return _program(stages, tuple(sorted(variant.items())))

    def _shader(self, file: str, user: bool) -> Path:
        if file.startswith("<"):
            return _joined(SHADERS, file.strip("<>"))
        return _joined(self.graph_folder if user else self.node_folder, file)

    # ---- sub-passes

    def raster(
        self,
        step: str,
        program: Program,
        *,
        color: Sequence[Attachment] = (),
        depth: Attachment | None = None,
        bind: Mapping[str, Binding] | None = None,
        work: Work | None = None,
        state: State | None = None,
        uniforms: Mapping[str, UniformValue] | None = None,
    ) -> None:
        """A draw into attachments; a full-screen triangle unless ``work`` says otherwise.

        A program given without a vertex stage draws with the shared full-screen vertex shader.
        """
        work = work or _FULLSCREEN
        state = state or _STATE
        if isinstance(work, Fullscreen) and not any(stage == "vertex" for stage, _ in program.stages):
            program = _program((*program.stages, ("vertex", _joined(SHADERS, "fullscreen.vert"))), program.defines)
        accesses = [attachment_access(a, Usage.COLOR) for a in color]
        clears = {a.resource: a.clear for a in color if a.clear is not None}
        if depth is not None:
            writes = not depth.read_only
            accesses.append(attachment_access(depth, Usage.DEPTH if writes else Usage.DEPTH_READ))
            if not writes:
                state = replace(state, depth_write=False)
            if depth.clear is not None:
                far = depth.clear[0]
                clears[depth.resource] = (1.0 - far if self.frame.depth == "reversed" else far, 0.0, 0.0, 0.0)
        accesses += bound_accesses(bind)
        if isinstance(work, DrawIndirect):
            accesses.append(Access(work.buffer, Usage.INDIRECT))
        self._add(SubPass(
            self._step(step), self.pass_name, tuple(accesses), work, program, state,
            dict(uniforms or {}), clears, self.position,
        ))  # fmt: skip

    def compute(
        self,
        step: str,
        program: Program,
        groups: tuple[int, int, int] | DispatchIndirect,
        *,
        bind: Mapping[str, Binding] | None = None,
        uniforms: Mapping[str, UniformValue] | None = None,
    ) -> None:
        """A dispatch of ``groups`` work groups, or of as many as a buffer says."""
        work = groups if isinstance(groups, DispatchIndirect) else Dispatch(*groups)
        accesses = bound_accesses(bind)
        if isinstance(work, DispatchIndirect):
            accesses.append(Access(work.buffer, Usage.INDIRECT))
        self._add(SubPass(
            self._step(step), self.pass_name, tuple(accesses), work, program, State(), dict(uniforms or {}), {},
            self.position,
        ))  # fmt: skip

    def copy(
        self,
        step: str,
        source: str,
        destination: str,
        *,
        blit: bool = False,
        linear: bool = False,
        host: bool = False,
    ) -> None:
        """Copy a texture (or buffer) whole; ``blit`` scales, converts or resolves multisamples; ``host`` goes through
        the host's memory.
        """
        accesses = (Access(source, Usage.COPY_FROM), Access(destination, Usage.COPY_TO, load=False))
        found = self._find(source).desc
        work: Work
        if isinstance(found, BufferDesc):
            work = CopyBuffer(source, destination, found.bytes, host)
        else:
            work = CopyTexture(source, destination, blit, linear, host)
        self._add(SubPass(self._step(step), self.pass_name, accesses, work, position=self.position))

    def clear(self, step: str, resource: str, value: Color4 | int = (0.0, 0.0, 0.0, 0.0)) -> None:
        """Set a whole texture or buffer to one value."""
        accesses = (Access(resource, Usage.CLEAR, load=False),)
        self._add(
            SubPass(self._step(step), self.pass_name, accesses, ClearResource(resource, value), position=self.position)
        )

    def mips(self, step: str, resource: str) -> None:
        """Fill the lower mip levels of a texture from its first."""
        levels = range(1, self.texture_desc(resource).mips)
        filled = (Access(resource, Usage.COPY_TO, load=False, mip=level) for level in levels)
        accesses = (Access(resource, Usage.COPY_FROM, mip=0), *filled)
        self._add(SubPass(self._step(step), self.pass_name, accesses, GenerateMips(resource), position=self.position))

    def groups(self, resource: str, tile: tuple[int, int] = (8, 8), depth: int = 1) -> tuple[int, int, int]:
        """Work groups that cover a texture with tiles of the given size."""
        width, height = self.size(resource)
        return -(-width // tile[0]), -(-height // tile[1]), depth

    def _step(self, step: str) -> str:
        return f"{self.pass_name}.{step}"

    def _add(self, subpass: SubPass) -> None:
        assert subpass.name not in self._names, f"{subpass.name} is added twice"
        self._names.add(subpass.name)
        self.subpasses.append(subpass)


_SUFFIX = {
    ".vert": "vertex", ".frag": "fragment", ".geom": "geometry",
    ".tesc": "tess_control", ".tese": "tess_evaluation", ".comp": "compute",
}  # fmt: skip


@lru_cache(4096)  # many passes share a program
def _program(stages: tuple[tuple[str, Path], ...], defines: tuple[tuple[str, str], ...]) -> Program:
    return Program(stages, defines)


@cache  # paths are slow to make, and many passes share a shader
def _joined(folder: Path, file: str) -> Path:
    return folder / file


@cache
def _stage(file: str) -> str:
    suffix = Path(file.strip("<>")).suffix
    if suffix not in _SUFFIX:
        raise ValueError(f"{file}: a shader file ends in one of {', '.join(_SUFFIX)}")
    return _SUFFIX[suffix]
