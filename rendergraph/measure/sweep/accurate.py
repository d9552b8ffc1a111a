"""The most accurate setting of a pass: each of its quality knobs at the end that its node calls accurate."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.sweep.axes import Axis
from rendergraph.node.discovery import find_node
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import plan_for_scene
from rendergraph.scene.load import LoadedScene

Size = tuple[int, int] | None


def quality_knobs(document: Document, name: str) -> tuple[str, ...]:
    """The knobs of a pass whose node says which way they are accurate."""
    return tuple(knob for knob, entry in _entries(document, name).items() if entry.get("accurate"))


def accurate_settings(document: Document, name: str, largest: Iterable[Axis] = ()) -> dict[str, str]:
    """The most accurate value of each quality knob of a pass that has one, as ``--set`` takes it: the last of its
    choices, or its bound. A knob without a bound gets the most accurate value among ``largest``, or is left out.
    """
    found: dict[str, str] = {}
    for knob, entry in _entries(document, name).items():
        accurate = entry.get("accurate")
        if not accurate:
            continue
        path = f"passes.{name}.set.{knob}"
        value: Any = accurate[-1] if isinstance(accurate, list) else None
        if accurate == "up":
            value = entry.get("maximum")
        elif accurate == "down":
            value = entry.get("minimum")
        swept = [axis.values[-1] for axis in largest if axis.path == path and axis.quality]
        if value is not None:
            whole = entry.get("type") == "integer" and isinstance(value, float)
            found[path] = str(value).lower() if isinstance(value, bool) else str(int(value) if whole else value)
        elif swept:
            found[path] = swept[0]
    return found


def possible(
    reload: Any, base: tuple[str, ...], wanted: dict[str, str], loaded: LoadedScene | None, size: Size = None
) -> tuple[str, ...]:
    """As many of the ``wanted`` settings (path to value) as can be had together, as overrides after ``base``: one that
    the graph refuses, such as more cascades than its map has layers, is stepped back towards what it was.

    ``reload`` loads the document under overrides.
    """
    taken = base
    for path, value in wanted.items():
        for candidate in _stepping_back(reload(base), path, value):
            tried = (*taken, f"{path}={candidate}")
            try:
                plan_for_scene(reload(tried), loaded, PlanOptions(), size=size)
            except RenderGraphError:
                continue
            taken = tried
            break
    return taken


def _stepping_back(document: Document, path: str, value: str) -> list[str]:
    """The value, then for whole numbers those towards the one the document has."""
    _, name, _, knob = path.split(".")
    now = getattr(document.params[name], knob)
    if isinstance(now, int) and not isinstance(now, bool) and value.lstrip("-").isdecimal():
        step = 1 if int(value) < now else -1
        return [str(number) for number in range(int(value), now, step)][:64]
    return [value]


def _entries(document: Document, name: str) -> dict[str, dict[str, Any]]:
    node = find_node(document.model.passes[name].node)
    entries: dict[str, dict[str, Any]] = node.params_type.model_json_schema().get("properties", {})
    return entries
