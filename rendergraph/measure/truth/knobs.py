"""Which of a pass's knobs would make it more accurate, from the ``accurate`` of its parameters. No numpy here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rendergraph.node.params import Params


@dataclass(frozen=True, slots=True)
class AccuracyKnob:
    """A quality knob that has room: its value now, and what is more accurate: ``larger``, ``smaller``, or values."""

    name: str
    now: Any
    better: str


def accuracy_knobs(params: Params) -> list[AccuracyKnob]:
    """The quality knobs that are not at their most accurate yet, as declared."""
    found = []
    for name, entry in type(params).model_json_schema().get("properties", {}).items():
        accurate, now = entry.get("accurate"), getattr(params, name)
        if accurate == "up" and now != entry.get("maximum"):
            found.append(AccuracyKnob(name, now, "larger"))
        elif accurate == "down" and now != entry.get("minimum"):
            found.append(AccuracyKnob(name, now, "smaller"))
        elif isinstance(accurate, list):
            better = accurate[accurate.index(now) + 1 :] if now in accurate else accurate
            if better:
                found.append(AccuracyKnob(name, now, ", ".join(str(value) for value in better)))
    return found


def accuracy_hint(pass_name: str, node: str, params: Params) -> str:
    """A help line that names them as ``--set`` takes them."""
    knobs = accuracy_knobs(params)
    if not knobs:
        return f"no knob of {node} makes it more accurate: look at the error map (--html), its shader and its reference"
    listed = "; ".join(f"--set passes.{pass_name}.set.{k.name}=... ({k.better} than {k.now})" for k in knobs)
    return f"raise accuracy with {listed}"
