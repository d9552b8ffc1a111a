"""What stress found: per extreme, per pass, per check; plain data that crosses process borders as JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

PassStatus = Literal["pass", "fail", "inherited", "not_run"]
CaseState = Literal["ran", "refused", "not_refused", "not_applicable", "failed", "crashed", "timed_out"]

#: States in which the whole extreme counts as failed.
BROKEN: tuple[CaseState, ...] = ("not_refused", "failed", "crashed", "timed_out")


@dataclass(frozen=True, slots=True)
class BadTexel:
    """The first texel (rows from the bottom) that fails a check: its value, and what the inputs hold there, by port."""

    port: str
    x: int
    y: int
    layer: int
    value: tuple[float, ...]
    inputs: Mapping[str, tuple[float, ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Failure:
    """A check that a pass fails."""

    check: str
    text: str
    texel: BadTexel | None = None


@dataclass(frozen=True, slots=True)
class PassOutcome:
    """One pass in one extreme. ``inherited``: it fails on inputs that were bad already. ``skipped``: checks left out,
    with reasons; ``reason`` why it did not run.
    """

    name: str
    node: str
    status: PassStatus
    failures: tuple[Failure, ...] = ()
    skipped: Mapping[str, str] = field(default_factory=dict)
    reason: str = ""


@dataclass(frozen=True, slots=True)
class CaseOutcome:
    """One extreme. ``code`` and ``text`` tell of what ended the run: a refusal, an error, a crash."""

    name: str
    help: str
    common: bool
    state: CaseState
    size: tuple[int, int]
    seconds: float = 0.0
    code: str = ""
    text: str = ""
    passes: tuple[PassOutcome, ...] = ()

    @property
    def failed(self) -> bool:
        """Whether anything in it is wrong."""
        return self.state in BROKEN or any(entry.status == "fail" for entry in self.passes)

    def to_json(self) -> dict[str, Any]:
        """For another process."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> CaseOutcome:
        """What :meth:`to_json` gave."""
        passes = tuple(
            PassOutcome(**{**entry, "failures": tuple(_failure(failure) for failure in entry["failures"])})
            for entry in data["passes"]
        )
        return cls(**{**data, "size": tuple(data["size"]), "passes": passes})


def _failure(data: dict[str, Any]) -> Failure:
    texel = data["texel"]
    if texel is not None:
        inputs = {port: tuple(values) for port, values in texel["inputs"].items()}
        texel = BadTexel(**{**texel, "value": tuple(texel["value"]), "inputs": inputs})
    return Failure(data["check"], data["text"], texel)
