"""Opens one record file: JSON, of a schema and version that is known, checked against its model."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

from pydantic import BaseModel, ValidationError

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.suggest import did_you_mean
from rendergraph.plan.graph import Position
from rendergraph.report.record_models import AccuracyRecord, BenchRecord, ResourcesRecord, TimingRecord

_MODELS: Final[dict[str, type[BaseModel]]] = {
    "timing": TimingRecord,
    "resources": ResourcesRecord,
    "accuracy": AccuracyRecord,
    "bench": BenchRecord,
}
_VERSION: Final = 1
_LARGEST: Final = 1 << 29  # bytes of a record
RENDER_HINT: Final = "give a folder written by `rg render`, a record in it, or a file written by `rg bench`"


def read_record_file(path: Path) -> tuple[str, BaseModel]:
    """The record's kind (timing, resources, accuracy, bench), and the record checked.

    :raises RenderGraphError: RG730 to RG735, see :func:`rendergraph.report.read_records.read_record`.
    """
    data = _read_json(path)
    schema = data.get("schema") if isinstance(data, dict) else None
    project, _, rest = schema.partition(".") if isinstance(schema, str) else ("", "", "")
    kind, _, version = rest.partition("/")
    if project != "rendergraph" or kind not in _MODELS or not version.isdecimal():
        reason = f"its schema is {schema!r:.60}" if schema is not None else "it names no schema"
        raise RenderGraphError([diagnose("RG732", path=str(path), reason=reason)], exit_code=2)
    if int(version) != _VERSION:
        raise RenderGraphError(
            [diagnose("RG733", path=str(path), schema=schema, known=f"rendergraph.{kind}/{_VERSION}")], exit_code=2
        )
    try:
        return kind, _MODELS[kind].model_validate(data)
    except ValidationError as error:
        raise _invalid(path, error) from None


def _read_json(path: Path) -> Any:
    try:
        if not path.exists():
            known = [p.name for p in path.parent.iterdir()] if path.parent.is_dir() else []
            raise unreadable(path, "no such file or folder", did_you_mean(path.name, known, RENDER_HINT))
        if not path.is_file():
            raise unreadable(path, "it is neither a file nor a folder", RENDER_HINT)
        if path.stat().st_size > _LARGEST:
            raise unreadable(path, f"it is larger than {_LARGEST >> 20} MiB", "measure fewer frames")
        text = path.read_bytes().decode("utf-8-sig")
        return json.loads(text)
    except (OSError, ValueError, RecursionError) as error:
        if isinstance(error, json.JSONDecodeError):
            at = Position(str(path), error.lineno, error.colno)
            cut = error.pos >= len(error.doc.rstrip()) or error.msg.startswith("Unterminated")
            reason = "it ends in the middle" if cut else error.msg.lower()
        else:
            at = Position(str(path), 1, 1)
            reason = {UnicodeDecodeError: "it is not UTF-8 text", RecursionError: "it is nested too deeply"}.get(
                type(error), str(error)
            )
            if isinstance(error, OSError):
                raise unreadable(path, (error.strerror or str(error)).lower(), "check its permissions") from None
        raise RenderGraphError([diagnose("RG731", at, path=str(path), reason=reason)], exit_code=2) from None


def unreadable(path: Path, reason: str, hint: str) -> RenderGraphError:
    """The diagnostic for a path that gives no record."""
    return RenderGraphError([diagnose("RG730", path=str(path), reason=reason, hint=hint)], exit_code=2)


def _invalid(path: Path, error: ValidationError) -> RenderGraphError:
    """The first of the record's mistakes: a sample that is no time tells more than what follows from it."""
    found = error.errors(include_url=False)
    for entry in found:
        where = ".".join(str(part) for part in entry["loc"])
        if "samples" in entry["loc"] or "frame_ms" in entry["loc"] or "blocks" in entry["loc"]:
            value = entry.get("input")
            if isinstance(value, (int, float)) and entry["type"] in ("greater_than_equal", "finite_number"):
                return RenderGraphError([diagnose("RG735", path=str(path), where=where, value=value)], exit_code=2)
    first = found[0]
    where = ".".join(str(part) for part in first["loc"]) or "the record"
    reason = first["msg"][:1].lower() + first["msg"][1:]
    return RenderGraphError([diagnose("RG734", path=str(path), where=where, reason=reason)], exit_code=2)
