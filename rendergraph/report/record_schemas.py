"""The JSON Schemas of the records under ``docs/``, made from their shapes, which are said once.

A record of this version has every key given there and no other; a reader of the same version may count on it.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import CoreSchema

from rendergraph.report.accuracy_shape import AccuracyRecord
from rendergraph.report.attribution_shape import AttributionRecord
from rendergraph.report.record_shape import Head
from rendergraph.report.resources_shape import ResourcesRecord
from rendergraph.report.stress_shape import StressRecord
from rendergraph.report.sweep_shape import SweepRecord
from rendergraph.report.timing_shape import TimingRecord

DIALECT: Final = "https://json-schema.org/draft/2020-12/schema"

#: The records by the name of their file.
RECORDS: Final[dict[str, type[Head]]] = {
    "timing": TimingRecord,
    "resources": ResourcesRecord,
    "accuracy": AccuracyRecord,
    "sweep": SweepRecord,
    "attribution": AttributionRecord,
    "stress": StressRecord,
}


def record_schema(name: str) -> dict[str, Any]:
    """The JSON Schema of a record, by its name in ``RECORDS``."""
    model = RECORDS[name]
    schema = model.model_json_schema(schema_generator=_Untitled)
    version = schema["properties"]["schema"]["const"]
    return {"$schema": DIALECT, "$id": f"urn:{version.replace('.', ':').replace('/', ':')}", **schema}


def schema_text(name: str) -> str:
    """The text of ``docs/NAME.schema.json``."""
    return json.dumps(record_schema(name), indent=2, ensure_ascii=False) + "\n"


def write_record_schemas(folder: str | Path) -> None:
    """Write all of them into a folder, as committed under ``docs/``."""
    for name in RECORDS:
        (Path(folder) / f"{name}.schema.json").write_text(schema_text(name), encoding="utf-8")


class _Untitled(GenerateJsonSchema):
    def field_title_should_be_set(self, schema: CoreSchema) -> bool:
        """No titles: they only repeat the names."""
        return False
