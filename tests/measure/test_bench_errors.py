"""Budgets of error are checked by a bench too."""

from pathlib import Path

import pytest

from rendergraph.device.context import Device
from rendergraph.measure.bench_errors import check_errors
from rendergraph.measure.bench_job import BenchJob, Side
from rendergraph.node.discovery import node_folder

pytestmark = pytest.mark.gpu

FXAA = (node_folder().parent / "graphs" / "fxaa.yaml").resolve()


@pytest.mark.parametrize(
    ("overrides", "codes"),
    [
        ((), []),
        (("budget.error={antialias: 1.0}",), []),
        (("budget.error={antialias: 1.0e-9}",), ["RG710"]),
        (("budget.flip=1.0e-9",), ["RG711"]),
    ],
)
def test_errors_are_held_against_their_budgets(
    device: Device, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, overrides: tuple[str, ...], codes: list[str]
) -> None:
    monkeypatch.setenv("RENDERGRAPH_CACHE", str(tmp_path))
    side = Side(str(FXAA), overrides)
    job = BenchJob({"A": side}, size=(64, 36))
    found = check_errors(job, side)
    assert sorted({finding.code for finding in found if finding.severity == "error"}) == codes
