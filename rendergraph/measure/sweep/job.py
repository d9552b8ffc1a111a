"""What a sweep is asked to do, in a form that travels to its worker processes."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from rendergraph.measure.sweep.axes import Axis
from rendergraph.measure.sweep.error_choice import ErrorChoice


@dataclass(frozen=True, slots=True)
class SweepJob:
    """A graph file (or shipped graph's name) under ``overrides``, the ``axes`` varied, and how each setting is
    measured: ``rounds`` rounds of ``frames`` timed frames, after at most ``most_warm_up`` frames of warming up.
    """

    graph: str
    axes: tuple[Axis, ...]
    error: ErrorChoice
    overrides: tuple[str, ...] = ()
    frames: int = 2
    rounds: int = 8
    size: tuple[int, int] | None = None
    scene: str | None = None
    seed: int = 0
    most_warm_up: int = 30

    def to_json(self) -> dict[str, Any]:
        """Plain data; :meth:`from_json` is its inverse."""
        return asdict(self)

    @staticmethod
    def from_json(data: dict[str, Any]) -> SweepJob:
        """The job of :meth:`to_json`'s data."""
        axes = tuple(Axis(**{**axis, "values": tuple(axis["values"])}) for axis in data["axes"])
        size = tuple(data["size"]) if data["size"] else None
        error, overrides = ErrorChoice(**data["error"]), tuple(data["overrides"])
        return SweepJob(**{**data, "axes": axes, "size": size, "error": error, "overrides": overrides})
