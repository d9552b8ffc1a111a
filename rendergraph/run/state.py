"""Records GL calls once and replays them every frame. State already set is not set again: the order is static."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any

from rendergraph.device import enums
from rendergraph.device.gl import GL, Call
from rendergraph.plan.graph import Blend, State

_FACTORS = {
    "zero": 0, "one": 1, "src_color": 0x0300, "one_minus_src_color": 0x0301, "src_alpha": 0x0302,
    "one_minus_src_alpha": 0x0303, "dst_alpha": 0x0304, "one_minus_dst_alpha": 0x0305, "dst_color": 0x0306,
    "one_minus_dst_color": 0x0307, "constant_color": 0x8001, "src1_color": 0x88F9, "src1_alpha": 0x8589,
}  # fmt: skip
_EQUATIONS = {"add": 0x8006, "min": 0x8007, "max": 0x8008, "subtract": 0x800A, "reverse_subtract": 0x800B}

#: Depth tests by what they mean to the reader, under (reversed, standard) depth.
_DEPTH_FUNCS = {
    "closer": (0x0204, 0x0201),  # GREATER, LESS
    "closer_equal": (0x0206, 0x0203),
    "farther": (0x0201, 0x0204),
    "farther_equal": (0x0203, 0x0206),
    "equal": (0x0202, 0x0202),
    "not_equal": (0x0205, 0x0205),
    "always": (0x0207, 0x0207),
}
_MAX_TARGETS = 8


class Recorder:
    """Collects the calls of one sub-pass after another, remembering state across them.

    One recorder serves one frame's commands; the first sub-pass sets everything it needs, so that a frame does not
    depend on what ran before it.
    """

    def __init__(self, gl: GL, reversed_depth: bool) -> None:
        self.gl = gl
        self.calls: list[Call] = []
        self._depth_column = 0 if reversed_depth else 1
        self._state: dict[Hashable, Any] = {}

    def call(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Record a call that is made every frame."""
        self.calls.append(self.gl.repeated(function, arguments))

    def set(self, key: Hashable, value: Any, function: Callable[..., Any], *arguments: Any) -> None:
        """Record a call that sets ``key`` to ``value``, unless it is so already."""
        if self._state.get(key, self) != value:
            self._state[key] = value
            self.calls.append(self.gl.repeated(function, arguments))

    def forget(self, key: Hashable) -> None:
        """What ``key`` is set to changes from frame to frame: the next ``set`` must not trust it."""
        self._state.pop(key, None)

    def forget_draws(self, texture_units: range) -> None:
        """A draw of the scene sets culling, winding and these texture units by itself."""
        units = (("texture", unit) for unit in texture_units)
        for key in (("cap", enums.CULL_FACE), "cull_face", "front_face", *units):
            self.forget(key)

    def take(self) -> tuple[Call, ...]:
        """The calls since the last time."""
        taken, self.calls = tuple(self.calls), []
        return taken

    # ---- groups of state

    def enable(self, capability: int, on: bool) -> None:
        """Switch a capability."""
        self.set(("cap", capability), on, self.gl.glEnable if on else self.gl.glDisable, capability)

    def write_all(self) -> None:
        """Open every write mask: clears obey them."""
        self.set("depth_mask", True, self.gl.glDepthMask, 1)
        self.set("color_mask", True, self.gl.glColorMask, 1, 1, 1, 1)

    def depth(self, state: State, has_depth: bool) -> None:
        """Depth test, write mask, bias and clamp."""
        gl = self.gl
        # GL writes depth only while the test is on: "no test" with writing is an always-passing test.
        test = state.depth_test or ("always" if state.depth_write else None)
        active = has_depth and test is not None
        self.enable(enums.DEPTH_TEST, active)
        if active:
            assert test is not None
            function = _DEPTH_FUNCS[test][self._depth_column]
            self.set("depth_func", function, gl.glDepthFunc, function)
            self.set("depth_mask", state.depth_write, gl.glDepthMask, int(state.depth_write))
        factor, units = state.depth_bias
        biased = bool(factor or units)
        self.enable(enums.POLYGON_OFFSET_FILL, biased)
        if biased:
            away = -1.0 if self._depth_column == 0 else 1.0
            offset = away * factor, away * units
            self.set("bias", offset, gl.glPolygonOffset, *offset)
        self.enable(enums.DEPTH_CLAMP, state.depth_clamp)

    def cull(self, mode: str) -> None:
        """``none``, ``back`` or ``front``."""
        self.enable(enums.CULL_FACE, mode != "none")
        if mode != "none":
            face = enums.BACK if mode == "back" else enums.FRONT
            self.set("cull_face", face, self.gl.glCullFace, face)

    def front_face(self, mirrored: bool) -> None:
        """A mirroring transform turns triangles round; so must the test."""
        face = enums.CW if mirrored else enums.CCW
        self.set("front_face", face, self.gl.glFrontFace, face)

    def blend(self, blends: tuple[Blend | None, ...]) -> None:
        """Blending of each colour target."""
        gl = self.gl
        for target in range(_MAX_TARGETS):
            blend = blends[target] if target < len(blends) else None
            self.set(
                ("blend", target), blend is not None, gl.glEnablei if blend else gl.glDisablei, enums.BLEND, target
            )
            if blend is None:
                continue
            source, destination = _FACTORS[blend.source], _FACTORS[blend.destination]
            source_alpha = _FACTORS[blend.source_alpha] if blend.source_alpha else source
            destination_alpha = _FACTORS[blend.destination_alpha] if blend.destination_alpha else destination
            factors = source, destination, source_alpha, destination_alpha
            self.set(("factors", target), factors, gl.glBlendFuncSeparatei, target, *factors)
            equation = _EQUATIONS[blend.equation]
            self.set(("equation", target), equation, gl.glBlendEquationi, target, equation)


def restore_defaults(gl: GL) -> None:
    """Leave the fixed-function state as the device opened it, for whoever uses the context next."""
    for capability in (enums.DEPTH_TEST, enums.CULL_FACE, enums.POLYGON_OFFSET_FILL, enums.DEPTH_CLAMP):
        gl.glDisable(capability)
    for target in range(_MAX_TARGETS):
        gl.glDisablei(enums.BLEND, target)
    gl.glDepthMask(1)
    gl.glColorMask(1, 1, 1, 1)
    gl.glFrontFace(enums.CCW)
    gl.glUseProgram(0)
    gl.glBindVertexArray(0)
    gl.glBindFramebuffer(enums.DRAW_FRAMEBUFFER, 0)
