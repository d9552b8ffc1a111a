"""`rg stress` on the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rendergraph.report.stress_shape import StressRecord
from tests.cli.conftest import Rg
from tests.measure.stress.bad_graphs import write_pair

pytestmark = pytest.mark.gpu


def test_findings_exit_1_and_name_the_texel(rg: Rg, tmp_path: Path) -> None:
    bad, healthy = write_pair(tmp_path, "width_minus_one")
    found = rg("stress", str(bad), "--only", "frame_1x1", "--only", "fov_1", "--no-isolate")
    assert (found.code, "RG765" in found.err) == (1, True)
    assert "(0, 0) of color" in found.err
    assert "frame_1x1" in found.out
    record = rg("stress", str(healthy), "--only", "frame_1x1", "--format", "json")
    assert record.code == 0
    shown = StressRecord.model_validate(json.loads(record.out))
    assert [e.state for e in shown.extremes] == ["ran"]


def test_list_needs_no_device(rg: Rg, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rendergraph.device.context.open_device", None)
    assert "frame_1x1" in rg("stress", "tonemap", "--list").out
    listed = json.loads(rg("stress", "tonemap", "--list", "--format", "json").out)
    assert {entry["common"] for entry in listed} == {True, False}


@pytest.mark.parametrize(
    ("arguments", "code"), [(("tonemapp",), "RG768"), (("tonemap", "--only", "frame1x1"), "RG769")]
)
def test_unknown_names(rg: Rg, arguments: tuple[str, ...], code: str) -> None:
    found = rg("stress", *arguments)
    assert (found.code, code in found.err, "did you mean" in found.err) == (2, True, True)
