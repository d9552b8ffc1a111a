"""Runs of passes made up for tests, without a device."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.node.contract import Node
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Measure, PassRun, Quantity, Reference, Truth
from rendergraph.plan.graph import Frame, TextureDesc

F64 = npt.NDArray[np.float64]
Judge = Callable[[PassRun], Mapping[str, Truth]]


class Settings(Params):
    """Of the node below."""

    gain: float = knob(1.0, "Any number.")


def image(value: float = 0.0, shape: tuple[int, ...] = (4, 6, 1)) -> F64:
    return np.full(shape, value, np.float64)


def run(outputs: Mapping[str, Any], *, format: str = "r32f", gain: float = 1.0, **more: Any) -> PassRun:
    descs = {
        port: TextureDesc(format, content.shape[-2], content.shape[-3])
        for port, content in outputs.items()
        if content.ndim >= 3
    }
    given = {"inputs": {}, "descs": descs, "frame": Frame(6, 4), **more}
    return PassRun(params=Settings(gain=gain), outputs=outputs, **given)


def measure(
    metric: str = "max", tolerance: float = 0.1, quantity: Quantity = Quantity.SCALAR, port: str = "out", **more: Any
) -> Measure:
    return Measure(quantity, metric, tolerance, "A test.", port, **more)


def make_node(
    judge: Judge | None, measures: Mapping[str, Measure] | None = None, *, exact: bool = False, **reference: Any
) -> type[Node[Any]]:
    """A node whose reference module holds ``judge``."""
    module = ModuleType("made_up_node")
    module.__path__ = []
    sys.modules["made_up_node"] = module
    sys.modules.pop("made_up_node.reference", None)
    if judge is not None:
        inside = ModuleType("made_up_node.reference")
        inside.judge = judge  # type: ignore[attr-defined]
        sys.modules["made_up_node.reference"] = inside

    class MadeUp(Node[Settings]):
        """For tests."""

        def build(self, b: Any) -> None:
            """Nothing."""

    MadeUp.__module__ = "made_up_node"
    MadeUp.name = "made_up"
    MadeUp.exact = exact
    MadeUp.reference = Reference("analytic", measures, **reference) if measures is not None else None
    return MadeUp
