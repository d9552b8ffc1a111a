"""Raw OpenGL entry points: ctypes functions over glcontext's own loader, one row of types each.

moderngl covers contexts, programs, vertex arrays and draws; everything it lacks (immutable storage, views, layered and
mip attachments, integer clears, timestamps, debug output, count-buffer draws) is called through this table. The loader
of glvnd answers with a stub for any ``gl*`` name, so a feature is gated on ``DeviceInfo.version`` and ``extensions``,
never on a pointer.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from ctypes import (
    CFUNCTYPE,
    c_char_p,
    c_double,
    c_float,
    c_int,
    c_int64,
    c_ssize_t,
    c_ubyte,
    c_uint,
    c_uint64,
    c_void_p,
)
from typing import Any, Final, Protocol

#: ``void callback(source, type, id, severity, length, message, user)``
DEBUG_CALLBACK = CFUNCTYPE(None, c_uint, c_uint, c_uint, c_uint, c_int, c_char_p, c_void_p)

_TYPES: Final[dict[str, Any]] = {
    "v": None, "u": c_uint, "i": c_int, "f": c_float, "d": c_double, "b": c_ubyte, "p": c_void_p, "s": c_char_p,
    "z": c_ssize_t, "U": c_uint64, "I": c_int64, "c": DEBUG_CALLBACK,
}  # fmt: skip

#: Entry point -> result and arguments. u GLuint/GLenum/GLbitfield, i GLint/GLsizei, f GLfloat, d GLdouble, b GLboolean,
#: z GLintptr/GLsizeiptr, U GLuint64, I GLint64, p pointer, s string, c debug callback, v void.
SIGNATURES: Final[dict[str, str]] = {
    # ---- strings, limits, errors
    "glGetString": "s u",
    "glGetStringi": "s uu",
    "glGetIntegerv": "v up",
    "glGetInteger64v": "v up",
    "glGetIntegeri_v": "v uup",
    "glGetFloatv": "v up",
    "glGetError": "u",
    # ---- textures
    "glCreateTextures": "v uip",
    "glGenTextures": "v ip",
    "glDeleteTextures": "v ip",
    "glIsTexture": "b u",
    "glTextureStorage2D": "v uiuii",
    "glTextureStorage3D": "v uiuiii",
    "glTextureStorage2DMultisample": "v uiuiib",
    "glTextureStorage3DMultisample": "v uiuiiib",
    "glTextureView": "v uuuuuuuu",
    "glTextureSubImage2D": "v uiiiiiuup",
    "glTextureSubImage3D": "v uiiiiiiiuup",
    "glTextureParameteri": "v uui",
    "glGetTextureLevelParameteriv": "v uiup",
    "glGetTextureImage": "v uiuuip",
    "glGetTextureSubImage": "v uiiiiiiiuuip",
    "glGenerateTextureMipmap": "v u",
    "glBindTextureUnit": "v uu",
    "glBindImageTexture": "v uuibiuu",
    "glClearTexImage": "v uiuup",
    "glClearTexSubImage": "v uiiiiiiiuup",
    "glCopyImageSubData": "v uuiiiiuuiiiiiii",
    "glPixelStorei": "v ui",
    # ---- samplers
    "glCreateSamplers": "v ip",
    "glDeleteSamplers": "v ip",
    "glIsSampler": "b u",
    "glBindSampler": "v uu",
    "glSamplerParameteri": "v uui",
    "glSamplerParameterf": "v uuf",
    "glSamplerParameterfv": "v uup",
    # ---- framebuffers
    "glCreateFramebuffers": "v ip",
    "glDeleteFramebuffers": "v ip",
    "glIsFramebuffer": "b u",
    "glBindFramebuffer": "v uu",
    "glNamedFramebufferTexture": "v uuui",
    "glNamedFramebufferTextureLayer": "v uuuii",
    "glNamedFramebufferParameteri": "v uui",
    "glNamedFramebufferDrawBuffers": "v uip",
    "glNamedFramebufferReadBuffer": "v uu",
    "glCheckNamedFramebufferStatus": "u uu",
    "glClearNamedFramebufferfv": "v uuip",
    "glClearNamedFramebufferiv": "v uuip",
    "glClearNamedFramebufferuiv": "v uuip",
    "glClearNamedFramebufferfi": "v uuifi",
    "glBlitNamedFramebuffer": "v uuiiiiiiiiuu",
    "glInvalidateNamedFramebufferData": "v uip",
    "glReadPixels": "v iiiiuup",
    # ---- fixed-function state
    "glEnable": "v u",
    "glDisable": "v u",
    "glEnablei": "v uu",
    "glDisablei": "v uu",
    "glIsEnabled": "b u",
    "glViewport": "v iiii",
    "glViewportIndexedf": "v uffff",
    "glScissor": "v iiii",
    "glClipControl": "v uu",
    "glDepthRangef": "v ff",
    "glDepthFunc": "v u",
    "glDepthMask": "v b",
    "glColorMask": "v bbbb",
    "glColorMaski": "v ubbbb",
    "glStencilFunc": "v uiu",
    "glStencilFuncSeparate": "v uuiu",
    "glStencilOp": "v uuu",
    "glStencilOpSeparate": "v uuuu",
    "glStencilMask": "v u",
    "glCullFace": "v u",
    "glFrontFace": "v u",
    "glPolygonOffset": "v ff",
    "glPolygonOffsetClamp": "v fff",
    "glBlendFunci": "v uuu",
    "glBlendFuncSeparatei": "v uuuuu",
    "glBlendEquationi": "v uu",
    "glBlendEquationSeparatei": "v uuu",
    "glPatchParameteri": "v ui",
    "glMinSampleShading": "v f",
    "glSampleMaski": "v uu",
    # ---- buffers
    "glCreateBuffers": "v ip",
    "glDeleteBuffers": "v ip",
    "glIsBuffer": "b u",
    "glNamedBufferStorage": "v uzpu",
    "glNamedBufferSubData": "v uzzp",
    "glGetNamedBufferSubData": "v uzzp",
    "glCopyNamedBufferSubData": "v uuzzz",
    "glClearNamedBufferData": "v uuuup",
    "glClearNamedBufferSubData": "v uuzzuup",
    "glBindBuffer": "v uu",
    "glBindBufferBase": "v uuu",
    "glBindBufferRange": "v uuuzz",
    # ---- vertex arrays
    "glCreateVertexArrays": "v ip",
    "glDeleteVertexArrays": "v ip",
    "glIsVertexArray": "b u",
    "glBindVertexArray": "v u",
    "glVertexArrayElementBuffer": "v uu",
    "glVertexArrayVertexBuffer": "v uuuzi",
    "glVertexArrayAttribFormat": "v uuiubu",
    "glVertexArrayAttribIFormat": "v uuiuu",
    "glVertexArrayAttribBinding": "v uuu",
    "glVertexArrayBindingDivisor": "v uuu",
    "glEnableVertexArrayAttrib": "v uu",
    "glDisableVertexArrayAttrib": "v uu",
    # ---- draws and dispatches
    "glUseProgram": "v u",
    "glDrawArrays": "v uii",
    "glDrawArraysInstanced": "v uiii",
    "glDrawArraysInstancedBaseInstance": "v uiiiu",
    "glDrawElementsInstancedBaseVertexBaseInstance": "v uiupiiu",
    "glDrawArraysIndirect": "v up",
    "glDrawElementsIndirect": "v uup",
    "glMultiDrawArraysIndirect": "v upii",
    "glMultiDrawElementsIndirect": "v uupii",
    "glMultiDrawArraysIndirectCountARB": "v upzii",
    "glMultiDrawElementsIndirectCountARB": "v uupzii",
    "glDispatchCompute": "v uuu",
    "glDispatchComputeIndirect": "v z",
    "glMemoryBarrier": "v u",
    "glMemoryBarrierByRegion": "v u",
    "glTextureBarrier": "v",
    # ---- programs
    "glIsProgram": "b u",
    "glGetProgramiv": "v uup",
    "glGetProgramInterfaceiv": "v uuup",
    "glGetProgramResourceiv": "v uuuipipp",
    "glGetProgramResourceName": "v uuuipp",
    "glGetProgramResourceIndex": "u uus",
    "glUniformBlockBinding": "v uuu",
    "glShaderStorageBlockBinding": "v uuu",
    "glProgramUniform1fv": "v uiip",
    "glProgramUniform2fv": "v uiip",
    "glProgramUniform3fv": "v uiip",
    "glProgramUniform4fv": "v uiip",
    "glProgramUniform1iv": "v uiip",
    "glProgramUniform2iv": "v uiip",
    "glProgramUniform3iv": "v uiip",
    "glProgramUniform4iv": "v uiip",
    "glProgramUniform1uiv": "v uiip",
    "glProgramUniform2uiv": "v uiip",
    "glProgramUniform3uiv": "v uiip",
    "glProgramUniform4uiv": "v uiip",
    "glProgramUniformMatrix2fv": "v uiibp",
    "glProgramUniformMatrix3fv": "v uiibp",
    "glProgramUniformMatrix4fv": "v uiibp",
    # ---- queries and sync
    "glGenQueries": "v ip",
    "glCreateQueries": "v uip",
    "glDeleteQueries": "v ip",
    "glIsQuery": "b u",
    "glBeginQuery": "v uu",
    "glEndQuery": "v u",
    "glQueryCounter": "v uu",
    "glGetQueryiv": "v uup",
    "glGetQueryObjectiv": "v uup",
    "glGetQueryObjectui64v": "v uup",
    "glFenceSync": "p uu",
    "glClientWaitSync": "u puU",
    "glDeleteSync": "v p",
    "glFlush": "v",
    "glFinish": "v",
    # ---- debug output and labels
    "glDebugMessageCallback": "v cp",
    "glDebugMessageControl": "v uuuipb",
    "glPushDebugGroup": "v uuis",
    "glPopDebugGroup": "v",
    "glObjectLabel": "v uuis",
    "glGetObjectLabel": "v uuipp",
}  # fmt: skip


#: A function and its arguments, to be called later as ``function(*arguments)``.
Call = tuple[Callable[..., Any], tuple[Any, ...]]


class Loader(Protocol):
    """What glcontext's backend object offers: the address of an entry point of the current context."""

    def load(self, name: str) -> int: ...


class GL:
    """The entry points of :data:`SIGNATURES` as attributes. Calls release the GIL and check argument types."""

    def __init__(self, loader: Loader) -> None:
        # By identity: ctypes functions have no hash. Each row keeps its own function alive.
        self._repeated: dict[int, tuple[Callable[..., Any], Callable[..., Any], str]] = {}
        for name, signature in SIGNATURES.items():
            result, _, arguments = signature.partition(" ")
            address = loader.load(name)
            function = CFUNCTYPE(_TYPES[result], *(_TYPES[letter] for letter in arguments))(address)
            setattr(self, name, function)
            if result == "v":
                self._repeated[id(function)] = function, CFUNCTYPE(None)(address), arguments

    def __getattr__(self, name: str) -> Callable[..., Any]:
        raise AttributeError(f"{name} has no row in rendergraph.device.gl.SIGNATURES")

    def repeated(self, function: Callable[..., Any], arguments: tuple[Any, ...] = ()) -> Call:
        """A call to be made again and again: its arguments are checked and converted now and never after, which more
        than halves what a call costs. Functions that are not of this table, or give something back, stay as they are.
        """
        if id(function) not in self._repeated:
            return function, arguments
        _, bare, letters = self._repeated[id(function)]
        if len(arguments) != len(letters) and arguments:
            raise TypeError(f"{len(arguments)} arguments given, {len(letters)} expected")
        return bare, tuple(_converted(*pair) for pair in zip(letters, arguments, strict=False))

    def create(self, create: str, *target: int) -> int:
        """One new object by a ``glCreate*`` or ``glGen*`` entry point; its name."""
        name = c_uint()
        getattr(self, create)(*target, 1, ctypes.byref(name))
        return name.value

    def delete(self, delete: str, name: int) -> None:
        """Delete one object by a ``glDelete*`` entry point."""
        getattr(self, delete)(1, ctypes.byref(c_uint(name)))

    def integer(self, parameter: int, index: int | None = None) -> int:
        """A (possibly indexed) integer of the context's state."""
        value = ctypes.c_int64()
        if index is None:
            self.glGetInteger64v(parameter, ctypes.byref(value))
        else:
            narrow = c_int()
            self.glGetIntegeri_v(parameter, index, ctypes.byref(narrow))
            value.value = narrow.value
        return value.value


def _converted(letter: str, value: Any) -> Any:
    """An argument that ctypes passes right without being told its type: C integers, strings and null as they are."""
    kind = _TYPES[letter]
    if letter in "uib":
        return kind(value).value
    if letter == "s" or value is None:
        return value
    return value if isinstance(value, ctypes.Array) else kind(value)
