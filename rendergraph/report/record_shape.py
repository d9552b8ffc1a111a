"""What the shapes of records are built from: quantities with their units, and the base of their models."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Bytes = Annotated[int, Field(ge=0, json_schema_extra={"unit": "bytes"})]
Count = Annotated[int, Field(ge=0)]
Share = Annotated[float, Field(ge=0, le=1)]
Milliseconds = Annotated[float, Field(ge=0, json_schema_extra={"unit": "ms"})]
Size = Annotated[list[Annotated[int, Field(ge=1)]], Field(min_length=2, max_length=2)]


class Part(BaseModel):
    """Base: exactly the keys given, of exactly the types given, and no infinities."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


class Head(Part):
    """What every record begins with."""

    rendergraph: str = Field(description="Version of the program that wrote it.")
    title: str = Field(description="The graph's title.")
    size: Size = Field(description="Width and height of the frame in pixels.")
