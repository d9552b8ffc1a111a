"""What `rg bench` is asked to do, in a form that travels to its worker processes."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Side:
    """One of the things compared: a graph file (or shipped graph's name) under overrides (``--set``), built in ``full``
    or for what its scene requires.
    """

    graph: str
    overrides: tuple[str, ...] = ()
    full: bool = False


@dataclass(frozen=True, slots=True)
class BenchJob:
    """``processes`` fresh processes, each with ``blocks`` blocks of ``frames`` frames of every side.

    Sides are ``A`` and, to compare, ``B``. ``most_warm_up`` frames are run at the most before a side counts as steady.
    ``bound`` adds perturbed runs that tell what a side is bound by. Many processes of few blocks, and not the other way
    round: processes differ by more than the blocks of one do, and how much they differ is known only from them.
    """

    sides: dict[str, Side] = field(default_factory=dict)
    processes: int = 10
    blocks: int = 3
    frames: int = 5
    size: tuple[int, int] | None = None
    scene: str | None = None
    full: bool = False
    device: int | None = None
    most_warm_up: int = 60
    bound: bool = False

    def order(self, process: int, block: int) -> str:
        """Which side goes first: turns with every block, and begins anew with every process."""
        if len(self.sides) == 1:
            return "A"
        return "AB" if (process + block) % 2 == 0 else "BA"

    def to_json(self) -> dict[str, Any]:
        """Plain data; :meth:`from_json` is its inverse."""
        return asdict(self)

    @staticmethod
    def from_json(data: dict[str, Any]) -> BenchJob:
        """The job of :meth:`to_json`'s data."""
        sides = {
            name: Side(side["graph"], tuple(side["overrides"]), side["full"]) for name, side in data["sides"].items()
        }
        size = tuple(data["size"]) if data["size"] else None
        return BenchJob(**{**data, "sides": sides, "size": size})
