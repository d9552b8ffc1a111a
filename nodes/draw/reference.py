"""The truth of a user's shader is told by Python beside it, where there is any (docs/accuracy_user_shaders.md)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from rendergraph.measure.truth.user_reference import user_invariants, user_truths, why_unknown
from rendergraph.node.reference import PassRun, Truth

if TYPE_CHECKING:
    from rendergraph.nodes.draw import DrawParams


def judge(run: PassRun) -> Mapping[str, Truth]:
    """What ``<shader>_reference.py`` says. Raises RenderGraphError RG728 without it, RG729 where it fails."""
    return user_truths(run, _shader(run))


def invariants(run: PassRun) -> Iterable[str]:
    """What the same file's ``invariants(run)`` finds broken."""
    return user_invariants(run, _shader(run))


def why_not(run: PassRun) -> str:
    """Why this pass cannot be judged; empty where it can."""
    return why_unknown(run, _shader(run))


def _shader(run: PassRun) -> str | None:
    """The fragment shader tells what is seen, and the vertex shader where only depth is drawn."""
    params: DrawParams = run.params  # type: ignore[assignment]
    return params.fragment or params.vertex
