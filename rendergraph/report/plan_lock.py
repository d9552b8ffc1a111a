"""A plan's lock: order, barriers and bytes in a small file that is committed, reviewed and checked for change.

One entry a line, in a stable order, without times, paths or versions: a change of the plan is a change of few lines.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.whole_files import whole_file
from rendergraph.report.resources import SCHEMA as RESOURCES_SCHEMA
from rendergraph.report.resources_shape import ResourcesRecord

SCHEMA: Final = "rendergraph.plan_lock/1"

Count = Annotated[int, Field(ge=0)]


class _Locked(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class LockedBarrier(_Locked):
    """A barrier: the names of its bits (and ``glTextureBarrier``), and the resources it is for."""

    before: str
    bits: list[str]
    resources: list[str]


class LockedSlot(_Locked):
    """Texture storage and its tenants, in order of use."""

    tenants: Annotated[list[str], Field(min_length=1)]
    shape: str
    bytes: Count


class LockedResource(_Locked):
    """What a resource is, and the sub-passes that use it first and last."""

    name: str
    kind: str
    shape: str
    bytes: Count
    first: str
    last: str


class PlanLock(_Locked):
    """The lock of one plan. ``size`` is the frame's in pixels; ``bytes`` holds used, load, unshared and heap."""

    version: Literal["rendergraph.plan_lock/1"] = Field(alias="schema")
    size: Annotated[list[Count], Field(min_length=2, max_length=2)]
    order: list[str]
    culled: list[str]
    bytes: dict[str, Count]
    barriers: list[LockedBarrier]
    slots: list[LockedSlot]
    resources: list[LockedResource]


def plan_lock(record: Mapping[str, Any]) -> PlanLock:
    """The lock of a plan, from its ``rendergraph.resources/1`` record."""
    totals = {name: record["totals"][name] for name in ("used", "load", "unshared")}
    lock = {
        "schema": SCHEMA,
        "size": record["size"],
        "order": record["order"],
        "culled": sorted(record["culled"]),
        "bytes": totals | {"heap": record["heap_bytes"]},
        "barriers": [
            {
                "before": barrier["before"],
                "bits": barrier["names"] + (["glTextureBarrier"] if barrier["texture_barrier"] else []),
                "resources": sorted({hazard["resource"] for hazard in barrier["hazards"]}),
            }
            for barrier in record["barriers"]
        ],
        "slots": [_kept(slot, "tenants", "shape", "bytes") for slot in record["slots"]],
        "resources": [
            _kept(resource, "name", "kind", "shape", "bytes", "first", "last") for resource in record["resources"]
        ],
    }
    return PlanLock.model_validate(lock)


def _kept(entry: Mapping[str, Any], *keys: str) -> dict[str, Any]:
    return {key: _shape(entry["desc"]) if key == "shape" else entry[key] for key in keys}


def _shape(desc: Mapping[str, Any]) -> str:
    """Format, size and what is not one: ``d32f 2048x2048 2d_array 3 layers``."""
    if "buffer" in desc:
        return f"buffer of {desc['buffer']} bytes"
    target = "" if desc["target"] == "2d" else f" {desc['target']}"
    counts = "".join(f" {desc[key]} {key}" for key in ("layers", "mips", "samples") if desc[key] > 1)
    return f"{desc['format']} {desc['size'][0]}x{desc['size'][1]}{target}{counts}"


def write_lock(path: Path, lock: PlanLock) -> None:
    """Write the lock, whole or not at all. Raises ``RenderGraphError`` RG560."""
    with whole_file(path) as temporary:
        temporary.write_text(lock_text(lock), encoding="utf-8")


def lock_text(lock: PlanLock) -> str:
    """The file's text: JSON, one line an entry."""
    parts = []
    for key, value in lock.model_dump(by_alias=True).items():
        if isinstance(value, list) and value and key != "size":
            entries = ",\n    ".join(_json(entry) for entry in value)
            parts.append(f"  {_json(key)}: [\n    {entries}\n  ]")
        else:
            parts.append(f"  {_json(key)}: {_json(value)}")
    return "{\n" + ",\n".join(parts) + "\n}\n"


def read_lock(path: Path) -> PlanLock:
    """A lock, or the lock of the plan of a resources record (as ``rg plan --format json`` prints it).

    Raises ``RenderGraphError`` RG720, exit code 2, for anything else.
    """
    try:
        data = json.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise _refused(path, reason, "`rg plan GRAPH --lock FILE` writes a lock") from None
    except (ValueError, RecursionError) as error:
        at = f" (line {error.lineno})" if isinstance(error, json.JSONDecodeError) else ""
        raise _refused(
            path, f"it is no JSON{at}", "it may be cut short or hold a merge conflict; write it anew"
        ) from None
    schema = data.get("schema") if isinstance(data, dict) else None
    try:
        if schema == RESOURCES_SCHEMA:
            ResourcesRecord.model_validate(data)
            return plan_lock(data)
        if schema == SCHEMA:
            return PlanLock.model_validate(data)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"])) or "the file"
        raise _refused(path, f"{where}: {first['msg'].lower()}", "write it anew with --lock") from None
    if isinstance(schema, str) and schema.startswith("rendergraph.plan_lock/"):
        raise _refused(path, f"its schema is {schema}, this version reads {SCHEMA}", "use the version that wrote it")
    raise _refused(path, "it is no plan lock", "`rg plan GRAPH --lock FILE` writes one")


def _refused(path: Path, reason: str, hint: str) -> RenderGraphError:
    return RenderGraphError([diagnose("RG720", path=str(path), reason=reason, hint=hint)], exit_code=2)


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)
