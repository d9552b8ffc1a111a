"""Parameters of a node: one pydantic field holds name, type, range, unit, default and help; everything else derives."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field


class Params(BaseModel):
    """Base of every node's ``Params``: unknown keys are errors, values are frozen and finite."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


#: What ``accurate`` says of a parameter of which no value is more accurate than another.
NEITHER = "neither"

#: A file named in a graph, relative to the graph's own folder; expansion checks that it exists and stays inside.
GraphFile = Annotated[str, Field(json_schema_extra={"rg_file": True})]


def knob(
    default: Any,
    help: str,
    *,
    unit: str = "",
    ge: float | None = None,
    le: float | None = None,
    gt: float | None = None,
    lt: float | None = None,
    accurate: str | tuple[Any, ...] = "",
) -> Any:
    """Declare one parameter.

    ``unit`` is the SI or pixel unit ("" for pure numbers). ``accurate`` marks a quality knob: ``"up"`` when larger is
    more accurate and costlier, ``"down"`` when smaller is, or the values from cheap to accurate for a choice;
    ``"neither"`` says that it chooses what is computed, not how well.
    """
    extra: dict[str, Any] = {"unit": unit}
    if accurate == NEITHER:
        extra["indifferent"] = True
    elif accurate:
        extra["accurate"] = list(accurate) if isinstance(accurate, tuple) else accurate
    return Field(default, description=help, ge=ge, le=le, gt=gt, lt=lt, json_schema_extra=extra)
