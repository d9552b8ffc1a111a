"""Errors of the driver as Python errors: a synchronous KHR_debug callback that knows which pass is running.

The callback only collects (an exception inside a ctypes callback would be swallowed); leaving a :class:`Scope`, or
``Device.check``, raises. A scope is also a debug group, so RenderDoc and apitrace show the graph's names.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import TracebackType
from typing import Final

from rendergraph.device import enums as e
from rendergraph.device.gl import DEBUG_CALLBACK, GL, Call
from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.plan.graph import Position

#: GL 4.5 guarantees at least 256 bytes a label or message; longer ones are an error.
_LONGEST_LABEL: Final = 255
_ERROR_NAMES: Final = {
    e.INVALID_ENUM: "GL_INVALID_ENUM", e.INVALID_VALUE: "GL_INVALID_VALUE",
    e.INVALID_OPERATION: "GL_INVALID_OPERATION", 0x0503: "GL_STACK_OVERFLOW", 0x0504: "GL_STACK_UNDERFLOW",
    e.OUT_OF_MEMORY: "GL_OUT_OF_MEMORY", 0x0506: "GL_INVALID_FRAMEBUFFER_OPERATION", 0x0507: "GL_CONTEXT_LOST",
}  # fmt: skip
_REMEMBERED_WARNINGS: Final = 100


@dataclass(frozen=True, slots=True)
class DebugMessage:
    """One message of the driver: its text, and the scopes and resource it came in."""

    text: str
    scope: str
    subject: str
    position: Position | None


class Scope:
    """A debug group while entered; make it once and enter it every frame. Leaving it raises what was collected."""

    __slots__ = ("_debug", "_pop", "_push", "label", "position")

    def __init__(self, debug: DebugLog, label: str, position: Position | None) -> None:
        self._debug = debug
        text = label.encode()[:_LONGEST_LABEL]
        self._push = debug.gl.repeated(debug.gl.glPushDebugGroup, (e.DEBUG_SOURCE_APPLICATION, 0, -1, text))
        self._pop, _ = debug.gl.repeated(debug.gl.glPopDebugGroup)
        self.label = label
        self.position = position

    def __enter__(self) -> Scope:
        self._debug.stack.append(self)
        push, arguments = self._push
        push(*arguments)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._pop()
        self._debug.stack.pop()
        if self._debug.errors and kind is None:
            self._debug.raise_errors()

    def run(self, calls: tuple[Call, ...]) -> None:
        """Make calls inside the scope: what entering and leaving would do, without the cost of a ``with``."""
        debug = self._debug
        debug.stack.append(self)
        push, arguments = self._push
        push(*arguments)
        try:
            for function, arguments in calls:
                function(*arguments)
        finally:
            self._pop()
            debug.stack.pop()
        if debug.errors:
            debug.raise_errors()


class DebugLog:
    """Collects the driver's messages. ``subject`` is the resource being worked on: the device's functions set it."""

    def __init__(self, gl: GL) -> None:
        self.gl = gl
        self.stack: list[Scope] = []
        self.errors: list[DebugMessage] = []
        self.warnings: list[DebugMessage] = []  # undefined behaviour the driver noticed
        self.subject = ""
        self._callback = DEBUG_CALLBACK(self._collect)  # kept: the driver holds only the address
        gl.glEnable(e.DEBUG_OUTPUT)
        gl.glEnable(e.DEBUG_OUTPUT_SYNCHRONOUS)
        # Group pushes and performance chatter would cost a Python call each.
        gl.glDebugMessageControl(e.DONT_CARE, e.DONT_CARE, e.DONT_CARE, 0, None, 0)
        for kind in (e.DEBUG_TYPE_ERROR, e.DEBUG_TYPE_UNDEFINED_BEHAVIOR):
            gl.glDebugMessageControl(e.DEBUG_SOURCE_API, kind, e.DONT_CARE, 0, None, 1)
        gl.glDebugMessageCallback(self._callback, None)
        self.synchronous = self._proven()

    def _proven(self) -> bool:
        """Provoke one error: a context without the debug flag may stay silent, and then ``check`` polls glGetError."""
        while self.gl.glGetError():
            pass
        self.gl.glEnable(0xFFFF)
        heard = bool(self.errors)
        self.errors.clear()
        self.gl.glGetError()
        return heard

    def _collect(
        self, source: int, kind: int, identity: int, severity: int, length: int, message: bytes, user: int
    ) -> None:
        heard = self._message(message.decode(errors="replace").strip())
        if kind == e.DEBUG_TYPE_ERROR:
            self.errors.append(heard)
        elif len(self.warnings) < _REMEMBERED_WARNINGS and heard not in self.warnings:
            self.warnings.append(heard)

    def _message(self, text: str) -> DebugMessage:
        position = next((s.position for s in reversed(self.stack) if s.position), None)
        return DebugMessage(text, "/".join(s.label for s in self.stack), self.subject, position)

    def poll(self) -> None:
        """Ask the driver for errors that no callback reported."""
        while code := self.gl.glGetError():
            if not self.errors:
                self.errors.append(self._message(_ERROR_NAMES.get(code, hex(code))))

    def raise_errors(self) -> None:
        """Raise all collected errors as one :class:`RenderGraphError`, each said once."""
        found = list(dict.fromkeys(self.errors))
        self.errors.clear()
        while self.gl.glGetError():  # the callback has reported it; a stale code would be blamed on the next call
            pass
        if found:
            raise RenderGraphError(_diagnose(message, "RG500") for message in found)

    def take_warnings(self) -> tuple[Diagnostic, ...]:
        """The undefined behaviour that the driver noticed since the last time, each said once: RG507."""
        found = tuple(_diagnose(message, "RG507") for message in self.warnings)
        self.warnings.clear()
        return found

    def take_errors(self) -> list[str]:
        """The texts collected so far, forgotten here: for a caller that has a better message of its own."""
        texts = [message.text for message in self.errors]
        self.errors.clear()
        while self.gl.glGetError():
            pass
        return texts


def _diagnose(message: DebugMessage, code: str) -> Diagnostic:
    where = f" in {message.scope}" if message.scope else ""
    what = f" on '{message.subject}'" if message.subject else ""
    return diagnose(
        code, message.position, where=where, what=what, detail=message.text,
        scope=message.scope, resource=message.subject,
    )  # fmt: skip
