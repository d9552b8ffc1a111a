"""The records' schemas are current, take real records, and refuse each record with one thing wrong."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from pydantic import ValidationError

from rendergraph.document.load import load_document
from rendergraph.document.messages import diagnose
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.memory_advice import advise
from rendergraph.report.record_schemas import RECORDS, record_schema, schema_text, write_record_schemas
from rendergraph.report.resources import resources_record
from rendergraph.report.timing import timing_record
from tests.report.made_up import BOUND
from tests.report.made_up_accuracy import made_up_accuracy
from tests.report.made_up_attribution import made_up_attribution
from tests.report.made_up_stress import made_up_stress
from tests.report.made_up_sweep import made_up_sweep
from tests.report.test_timing import result

DOCS = Path(__file__).resolve().parents[2] / "docs"
WRITE = "python -c \"from rendergraph.report.record_schemas import write_record_schemas as w; w('docs')\""


def planned(name: str, **options: Any) -> dict[str, Any]:
    document = load_document(name)
    plan, _ = plan_without_scene(document, PlanOptions(**options))
    return resources_record(plan, "title", advice=advise(document, plan), created=(3, 0))


def records() -> Iterator[tuple[str, dict[str, Any]]]:
    """Records of every sort, by the name of their schema."""
    for name in ("deferred_shading", "exposure", "compute", "shadow_map"):
        yield "resources", planned(name)
    yield "resources", planned("deferred_shading", alias=False)
    yield "resources", planned("deferred_shading", order="random", seed=3, cull=False)
    yield "accuracy", made_up_accuracy()
    yield "stress", made_up_stress()
    yield "sweep", made_up_sweep()
    yield "attribution", made_up_attribution()
    for samples in (0, 1, 3):
        yield "timing", json.loads(json.dumps(timing_record(result(samples), "title")))
    heard = diagnose("RG507", None, where="", what="", detail="undefined", scope="", resource="hdr")
    yield "timing", json.loads(json.dumps(timing_record(replace(result(2), warnings=(heard,)), "title", BOUND)))


VALIDATORS = {name: Draft202012Validator(record_schema(name)) for name in RECORDS}


def errors(name: str, record: Any) -> list[str]:
    found = VALIDATORS[name].iter_errors(record)
    return [f"{list(error.absolute_path)}: {error.message[:200]}" for error in found]


def refused(name: str, record: Any) -> bool:
    """By the schema and by the models, which have to agree."""
    by_model = refused_by_model(name, record)
    assert VALIDATORS[name].is_valid(record) != by_model
    return by_model


def refused_by_model(name: str, record: Any) -> bool:
    try:
        RECORDS[name].model_validate(record)
    except ValidationError:
        return True
    return False


@pytest.mark.parametrize("name", RECORDS)
def test_committed_schemas_are_current(name: str) -> None:
    assert (DOCS / f"{name}.schema.json").read_text(encoding="utf-8") == schema_text(name), f"write it anew: {WRITE}"


def test_they_are_written_as_committed(tmp_path: Path) -> None:
    write_record_schemas(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {f"{name}.schema.json" for name in RECORDS}


@pytest.mark.parametrize("name", RECORDS)
def test_they_are_schemas(name: str) -> None:
    Draft202012Validator.check_schema(record_schema(name))


def test_records_validate() -> None:
    for name, record in records():
        assert errors(name, record) == []
        RECORDS[name].model_validate(record)


@pytest.mark.gpu
def test_records_of_a_run_validate(tmp_path: Path) -> None:
    from rendergraph.report.write import write_result
    from rendergraph.run.render import RenderOptions, render_document

    document = load_document("exposure")
    made = render_document(document, RenderOptions(size=(32, 18), frames=3, samples=2))
    write_result(made, document, tmp_path)
    for name in ("timing", "resources"):
        record = json.loads((tmp_path / f"{name}.json").read_text())
        assert errors(name, record) == []
        RECORDS[name].model_validate(record)
    created = json.loads((tmp_path / "resources.json").read_text())["objects_created"]
    assert created["frames"] >= 2
    assert created["objects"] == 0


def paths(value: Any, at: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Every key and the first index of every list, less what is inside of what a schema leaves open."""
    if at and at[-1] in OPEN:
        return
    if isinstance(value, dict):
        for key, entry in value.items():
            yield (*at, key)
            yield from paths(entry, (*at, key))
    elif isinstance(value, list) and value:
        yield (*at, 0)
        yield from paths(value[0], (*at, 0))


def at(record: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        record = record[key]
    return record


OPEN = {"evidence", "proof"}
OPTIONAL = {"slot", "offset", "view_class", "half_resolution", "no_readback"}
FREE = {"metrics", "inputs"}  # mappings with any keys
SIGNED = {"value", "metrics", "judged", "true", "inputs", "removed"}


@pytest.mark.parametrize("name", RECORDS)
def test_a_record_with_one_thing_wrong_is_refused(name: str) -> None:
    whole = next(record for kind, record in reversed(list(records())) if kind == name and record.get("advice", True))
    tried = 0
    for path in paths(whole):
        if "statistics" in path and path[0] == "passes":  # what the device counts depends on the device
            continue
        for wrong in (object, {"no": "such"}, -1):
            record = copy.deepcopy(whole)
            parent = at(record, path[:-1])
            if wrong == -1 and SIGNED & set(path):
                continue
            if wrong is object and (path[-1] in OPTIONAL or isinstance(parent, list) or FREE & set(path[:-1])):
                continue
            if isinstance(wrong, dict) and path[-1] in OPEN:
                continue
            if wrong is object:
                del parent[path[-1]]
            else:
                parent[path[-1]] = wrong
            tried += 1
            assert refused(name, record), (path, wrong)
        record = copy.deepcopy(whole)
        at(record, path[:-1])[path[-1]] = float("nan")  # which JSON has not, so that no schema can speak of it
        assert refused_by_model(name, record), path
        if isinstance(at(whole, path), dict) and path[-1] not in OPEN | FREE:
            record = copy.deepcopy(whole)
            at(record, path)["no_such_key"] = 1
            assert refused(name, record), path
    assert tried > 100


@pytest.mark.parametrize("name", RECORDS)
def test_another_version_is_refused(name: str) -> None:
    record = next(record for kind, record in records() if kind == name)
    assert not refused(name, record)
    for schema in ("rendergraph.timing/2", "rendergraph.resources/2", "other/1", 1, None):
        assert refused(name, record | {"schema": schema})
