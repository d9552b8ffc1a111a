"""What the graph file's models are built from: names, numbers, colours, and how a validator reports a mistake."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

from rendergraph.document.formats import FORMATS
from rendergraph.document.suggest import did_you_mean

MAX_SIZE = 16384


def mistake(problem: str, hint: str, key: str = "") -> PydanticCustomError:
    """A validator's error with a help line of its own; ``key`` is the key of the model to point at."""
    return PydanticCustomError("mistake", "{problem}", {"problem": problem, "hint": hint, "key": key})


def _known_format(name: str) -> str:
    if name not in FORMATS:
        raise PydanticCustomError("RG303", "unknown format", {"format": name, "hint": did_you_mean(name, FORMATS)})
    return name


def _not_boolean(value: Any) -> Any:
    if isinstance(value, bool):
        raise PydanticCustomError("int_type", "not a number")
    return value


#: ``Literal[1]`` alone would take ``true``, which equals 1 in Python.
NotBoolean = BeforeValidator(_not_boolean)

Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=64)]
#: A resource, or a node's internal one: ``light.histogram``.
ResourceName = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*$", max_length=130)]
Extent = Annotated[int, Field(ge=1, le=MAX_SIZE)]
Vec3 = tuple[float, float, float]
Unit = Annotated[float, Field(ge=0, le=1)]
NonNegative = Annotated[float, Field(ge=0)]
Rgb = tuple[NonNegative, NonNegative, NonNegative]
FormatName = Annotated[str, AfterValidator(_known_format), Field(json_schema_extra={"enum": [*sorted(FORMATS)]})]


class Model(BaseModel):
    """Base of the file's models: no unknown keys, no infinities, frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
