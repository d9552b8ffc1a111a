"""`rg sweep` and `rg attribute` as they are typed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from rendergraph.measure.sweep.store import FILE, locked
from rendergraph.report.record_schemas import record_schema
from tests.cli.conftest import Rg

pytestmark = pytest.mark.gpu

SMALL = ("--size", "32x18", "--rounds", "6", "--frames", "1")


def sweep(folder: Path, over: str, *more: str) -> tuple[str, ...]:
    return ("sweep", "fxaa", "--over", over, "-o", str(folder), *SMALL, *more)


def test_files_and_data(rg: Rg, tmp_path: Path) -> None:
    done = rg(*sweep(tmp_path, "antialias.search_steps=1|12", "--html", "--png", "--format", "json"))
    assert done.code == 0, done.err
    record = json.loads(done.out)
    jsonschema.validate(record, record_schema("sweep"))
    assert record == json.loads((tmp_path / "sweep.json").read_text())
    assert record["complete"]
    assert record["points"][1]["own"]
    assert {"sweep.json", "sweep.html", "sweep.png", FILE} <= {path.name for path in tmp_path.iterdir()}
    again = rg(*sweep(tmp_path, "antialias.search_steps=1|12", "--max-error", "1e-9"))
    assert again.code == 0
    assert "RG760" in again.err
    assert "rmse of display" in again.out


@pytest.mark.parametrize(
    ("over", "more", "code"),
    [
        ("antialias.serach_steps", (), "RG750"),
        ("antialias.search_steps=9:1:4", (), "RG751"),
        ("antialias.edge_threshold=nan:1:4", (), "RG751"),
        ("antialias.edge_threshold=0:1:1000,antialias.edge_minimum=0:1:1000", (), "RG753"),
        ("antialias.search_steps=1|99", (), "RG205"),
        ("antialias.search_steps", ("--error", "nobody"), "RG758"),
    ],
)
def test_mistakes(rg: Rg, tmp_path: Path, over: str, more: tuple[str, ...], code: str) -> None:
    refused = rg(*sweep(tmp_path / "out", over, *more))
    assert refused.code == 2
    assert code in refused.err
    assert refused.out == ""
    assert not (tmp_path / "out").exists()


def test_both_limits_are_one_too_many(rg: Rg, tmp_path: Path) -> None:
    refused = rg(*sweep(tmp_path / "out", "antialias.search_steps", "--budget-ms", "1", "--max-error", "1"))
    assert refused.code == 2
    assert "--budget-ms" in refused.err


def test_two_sweeps_in_one_folder(rg: Rg, tmp_path: Path) -> None:
    with locked(tmp_path):
        refused = rg(*sweep(tmp_path, "antialias.search_steps=1|12"))
    assert refused.code == 2
    assert "RG755" in refused.err


def exact(folder: Path) -> list[Any]:
    record = json.loads((folder / "sweep.json").read_text())
    kept = ("set", "own", "bytes", "error", "standard_error", "tolerance", "verdict", "reason")
    return [record["complete"], record["axes"], [{key: point[key] for key in kept} for point in record["points"]]]


def test_a_killed_sweep_goes_on(rg: Rg, tmp_path: Path) -> None:
    """Killed for good, without a chance to tidy up: the lock is free, and what was measured is not measured again."""
    over = "antialias.search_steps=1:16:16"
    code = "import sys; from rendergraph.cli import main; main(sys.argv[1:])"
    process = subprocess.Popen(
        [sys.executable, "-c", code, *sweep(tmp_path / "cut", over)], env=dict(os.environ), stderr=subprocess.DEVNULL
    )
    path, deadline = tmp_path / "cut" / FILE, time.monotonic() + 60
    while time.monotonic() < deadline and process.poll() is None:
        if path.exists() and path.read_bytes().count(b'"point"') >= 1:
            break
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    process.wait()
    kept = path.read_bytes()
    kept = kept[: kept.rfind(b"\n") + 1]
    assert b'"point"' in kept
    assert rg(*sweep(tmp_path / "cut", over)).code == 0
    assert path.read_bytes().startswith(kept)
    assert rg(*sweep(tmp_path / "whole", over)).code == 0
    assert exact(tmp_path / "cut") == exact(tmp_path / "whole")


def test_attribution(rg: Rg, tmp_path: Path) -> None:
    done = rg("attribute", "fxaa", "--size", "32x18", "-o", str(tmp_path))
    assert done.code == 0, done.err
    record = json.loads((tmp_path / "attribution.json").read_text())
    jsonschema.validate(record, record_schema("attribution"))
    assert record["output"] == "image", "not the one that nothing approximate has touched"
    assert [entry["name"] for entry in record["passes"]] == ["antialias"]
    refused = rg("attribute", "clear", "--size", "32x18")
    assert refused.code == 2
    assert "RG763" in refused.err
