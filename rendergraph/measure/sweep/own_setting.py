"""Where the document's own setting lies on the axes of a sweep, and which of their values it takes at all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rendergraph.document.load import Document
from rendergraph.document.messages import Diagnostic, RenderGraphError
from rendergraph.measure.sweep.axes import Axis, amount_held
from rendergraph.measure.sweep.bench import Settings


def own_indices(settings: Settings, axes: Sequence[Axis]) -> tuple[int | None, ...]:
    """The index of the value that the document has itself on each axis, None where it is not among them.

    :raises RenderGraphError: where the document refuses a value of an axis, all of them at once; exit code 2.
    """
    own = settings.document(())
    found: list[int | None] = []
    errors: list[Diagnostic] = []
    for axis in axes:
        same: int | None = None
        for index, value in enumerate(axis.values):
            try:
                if _same(settings.document((f"{axis.path}={value}",)), own):
                    same = index
            except RenderGraphError as error:
                errors += [d for d in error.diagnostics if d.severity == "error"]
        found.append(same)
    if errors:
        raise RenderGraphError(errors, exit_code=2)
    return tuple(found)


def _same(a: Document, b: Document) -> bool:
    """Whether two documents ask for the same, whatever of it they leave to defaults."""
    every_set = {"passes": {"__all__": {"set"}}}
    return a.params == b.params and a.model.model_dump(exclude=every_set) == b.model.model_dump(exclude=every_set)


def held_at(settings: Settings, axes: Sequence[Axis], own: Sequence[int | None]) -> tuple[int, ...]:
    """The index of each axis's value that is the document's own, else nearest to it, else the last."""
    return tuple(
        index if index is not None else _nearest(settings, axis) for axis, index in zip(axes, own, strict=True)
    )  # fmt: skip


def _nearest(settings: Settings, axis: Axis) -> int:
    now = _number(axis, _value(settings, axis))
    known = [_number(axis, value) for value in axis.values]
    if now is None or None in known:
        return len(axis.values) - 1
    return min(range(len(known)), key=lambda index: abs((known[index] or 0.0) - now))


def _value(settings: Settings, axis: Axis) -> Any:
    """What the document has at an axis's path, defaults included; None where that is nothing."""
    document = settings.document(())
    if axis.path.startswith("passes."):
        _, name, _, knob = axis.path.split(".")
        return getattr(document.params.get(name), knob, None)
    value: Any = document.model
    for part in axis.path.split("."):
        value = value.get(part) if isinstance(value, dict) else getattr(value, part, None)
    return value


def _number(axis: Axis, value: Any) -> float | None:
    text = str(list(value)) if isinstance(value, tuple | list) else str(value)
    held = amount_held(axis.path.rpartition(".")[2], text)
    if held is not None:
        return held
    try:
        return float(text)
    except ValueError:
        return None
