"""The one OpenGL context: opened on EGL without a display or libGL, with the state every pass may rely on.

One context per process: objects of a context that is not current silently act on the one that is.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import moderngl
from glcontext import egl

from rendergraph.device import enums as e
from rendergraph.device.debug import DebugLog, Scope
from rendergraph.device.gl import GL
from rendergraph.device.info import Counters, DeviceInfo, describe
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.plan.graph import Position

if TYPE_CHECKING:
    from rendergraph.device.clock_proof import ClockProof

APT_LINE: Final = "sudo apt-get install -y --no-install-recommends libegl1 libgl1-mesa-dri"
REQUIRED_VERSION: Final = 450
#: Beyond core 4.5: gl_DrawID and gl_BaseInstance for scene draws, draw counts in a buffer, layers from vertex shaders.
REQUIRED_EXTENSIONS: Final = frozenset({
    "GL_ARB_shader_draw_parameters", "GL_ARB_indirect_parameters", "GL_ARB_shader_viewport_layer_array",
})  # fmt: skip
_MOST_DEVICES: Final = 64


@dataclass(eq=False, slots=True)
class Device:
    """The open context: entry points, facts, counters, and every object made through the device layer.

    ``owned`` maps ``(delete entry point, name)`` to the label; ``close`` deletes what is left. ``samplers`` and
    ``programs`` are the caches of their modules.
    """

    gl: GL
    ctx: Any
    info: DeviceInfo
    debug: DebugLog
    counters: Counters = field(default_factory=Counters)
    owned: dict[tuple[str, int], str] = field(default_factory=dict)
    samplers: dict[Any, int] = field(default_factory=dict)
    programs: dict[Any, Any] = field(default_factory=dict)
    clock_proof: ClockProof | None = None

    def scope(self, label: str, position: Position | None = None) -> Scope:
        """A reusable debug group; errors inside it name ``label`` and ``position``, and are raised when it is left."""
        return Scope(self.debug, label, position)

    def check(self) -> None:
        """Raise ``RenderGraphError`` (RG500) for every driver error since the last time."""
        if not self.debug.synchronous:
            self.debug.poll()
        if self.debug.errors:
            self.debug.raise_errors()

    def finish(self) -> None:
        """Wait until all submitted work is done, without holding the GIL."""
        self.gl.glFinish()

    def create_object(self, create: str, *target: int, label: str = "") -> int:
        """A new object by a ``glCreate*`` (or ``glGen*``) entry point: its name.

        Counted, and deleted by ``close`` at the latest.
        """
        name = self.gl.create(create, *target)
        self.counters.objects_created += 1
        self.owned[create.replace("glCreate", "glDelete").replace("glGen", "glDelete"), name] = label
        return name

    def delete_object(self, delete: str, name: int) -> None:
        """Delete an object of :meth:`create_object` by its ``glDelete*``; nothing happens where it is gone already."""
        if self.owned.pop((delete, name), None) is not None:
            self.gl.delete(delete, name)

    def name(self, identifier: int, name: int, label: str) -> None:
        """Give an object its label for debuggers and the driver's messages."""
        if label:
            self.gl.glObjectLabel(identifier, name, -1, label.encode()[:255])

    def close(self) -> None:
        """Delete every object and the context. The device must not be used afterwards; a new one may be opened."""
        global _open
        if _open is not self:
            return
        self.finish()
        for delete, name in list(self.owned):
            self.gl.delete(delete, name)
        for cache in (self.owned, self.samplers, self.programs):
            cache.clear()
        self.gl.glDisable(e.DEBUG_OUTPUT)
        self.ctx.gc()
        self.ctx.release()
        _open = None


_open: Device | None = None


def open_device(index: int | None = None) -> Device:
    """The process's device, opened on first use; ``index`` picks an EGL device, ``None`` takes the first that works.

    :raises RenderGraphError: exit code 3; RG501 no libEGL, RG502 no driver, RG503 no such device, RG504 OpenGL too
        old, RG505 a missing extension, RG506 another device is already open.
    """
    global _open
    if _open is not None:
        if index is not None and index != _open.info.index:
            raise _environment("RG506", index=index, open=_open.info.index)
        return _open
    _open = _open_context(index)
    return _open


def enumerate_devices() -> Iterator[tuple[int, Device | RenderGraphError]]:
    """Open each EGL device in turn and close it again when the caller asks for the next; for ``rg doctor``.

    An open device is yielded alone and left open: there can be no second context beside it.
    """
    global _open
    if _open is not None:
        yield _open.info.index, _open
        return
    for index in range(_MOST_DEVICES):
        try:
            device = _open = _open_context(index)
        except RenderGraphError as error:
            if index > 0 and error.diagnostics[0].code == "RG503":
                return
            yield index, error
            if error.diagnostics[0].code in ("RG501", "RG503"):
                return
            continue
        try:
            yield index, device
        finally:
            device.close()


def _open_context(index: int | None) -> Device:
    wanted = os.environ.get("GLCONTEXT_DEVICE_INDEX", "")
    first = index if index is not None else int(wanted) if wanted.isdecimal() else None
    if first is not None:
        return _prepare(first, _backend(first))
    failures: list[RenderGraphError] = []
    for candidate in range(_MOST_DEVICES):
        try:
            return _prepare(candidate, _backend(candidate))
        except RenderGraphError as error:
            failures.append(error)
            if error.diagnostics[0].code in ("RG501", "RG503"):
                break
    raise failures[0]


def _backend(index: int) -> Any:
    """The EGL context of one device; its bare exceptions become RG501..RG504."""
    if index < 0:
        raise _environment("RG503", index=index, detail="devices count from 0")
    # The EGL library answers for core entry points too, so no libGL (and no X11) is loaded.
    library = os.environ.get("GLCONTEXT_LINUX_LIBEGL", "libEGL.so.1")
    try:
        ctypes.CDLL(library)
    except OSError as error:
        raise _environment("RG501", library=library, detail=error, apt=APT_LINE) from None
    try:
        # The module behind get_backend_by_name, which would let GLCONTEXT_DEVICE_INDEX overrule the index asked for.
        return egl.create_context(
            mode="standalone",
            glversion=REQUIRED_VERSION,
            device_index=index,
            libegl=library,
            libgl=os.environ.get("GLCONTEXT_LINUX_LIBGL", library),
        )
    except Exception as error:  # glcontext raises nothing more precise
        text = str(error)
    if "requested device index" in text and "found 0 " not in text:
        raise _environment("RG503", index=index, detail=text)
    if "eglCreateContext" in text:
        raise _environment("RG504", index=index, required="4.5", found=text, apt=APT_LINE)
    raise _environment("RG502", index=index, detail=text, apt=APT_LINE)


def _prepare(index: int, backend: Any) -> Device:
    try:
        ctx = moderngl.create_context(require=REQUIRED_VERSION, standalone=True, context=backend)
    except Exception as error:  # moderngl.Error and ValueError, by version
        raise _environment("RG504", index=index, required="4.5", found=error, apt=APT_LINE) from None
    ctx.gc_mode = "context_gc"
    gl = GL(backend)
    info = describe(index, gl, int(ctx.version_code))
    missing = sorted(REQUIRED_EXTENSIONS - info.extensions)
    if info.version < REQUIRED_VERSION or missing:
        ctx.release()
        if missing:
            raise _environment("RG505", renderer=info.renderer, missing=", ".join(missing))
        raise _environment("RG504", index=index, required="4.5", found=info.driver, apt=APT_LINE)
    gl.glClipControl(e.LOWER_LEFT, e.ZERO_TO_ONE)
    gl.glFrontFace(e.CCW)
    gl.glDisable(e.PRIMITIVE_RESTART)
    gl.glDisable(e.DITHER)
    gl.glEnable(e.FRAMEBUFFER_SRGB)  # acts on srgb8_a8 targets alone
    gl.glEnable(e.TEXTURE_CUBE_MAP_SEAMLESS)
    gl.glEnable(e.PROGRAM_POINT_SIZE)
    gl.glPixelStorei(e.PACK_ALIGNMENT, 1)
    gl.glPixelStorei(e.UNPACK_ALIGNMENT, 1)
    return Device(gl, ctx, info, DebugLog(gl))


def _environment(code: str, **data: Any) -> RenderGraphError:
    return RenderGraphError([diagnose(code, **data)], exit_code=3)
