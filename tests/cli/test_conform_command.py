"""`rg conform`: exit codes, the record, refusals."""

from __future__ import annotations

import json

import pytest

from rendergraph.conformance.demands import DEMANDS
from tests.cli.conftest import Rg


@pytest.mark.gpu
def test_a_shipped_node_meets_all(rg: Rg) -> None:
    outcome = rg("conform", "clear", "--no-isolate", "--format", "json")
    assert outcome.code == 0, outcome.err
    record = json.loads(outcome.out)
    assert record["schema"] == "rendergraph.conformance/1"
    assert record["counts"] == {"met": len(DEMANDS), "missed": 0, "exempt": 0, "not_tried": 0}
    assert [verdict["code"] for verdict in record["verdicts"]] == [demand.code for demand in DEMANDS.values()]
    assert record["device"]["renderer"]


def test_without_a_demand_that_runs_no_device_is_opened(rg: Rg) -> None:
    outcome = rg("conform", "rendergraph.nodes.sky", "--only", "readme", "--format", "json")
    assert outcome.code == 2  # shipped nodes go by their names
    outcome = rg("conform", "sky", "--only", "readme", "--format", "json")
    assert (outcome.code, json.loads(outcome.out)["device"]["renderer"]) == (0, "")


@pytest.mark.parametrize(
    ("arguments", "code"), [(["skye"], "RG794"), (["sky", "--only", "beauty"], "RG795")], ids=["node", "demand"]
)
def test_wrong_names_are_refused(rg: Rg, arguments: list[str], code: str) -> None:
    outcome = rg("conform", *arguments)
    assert outcome.code == 2
    assert code in outcome.err


def test_a_missed_demand_is_a_finding(rg: Rg, monkeypatch: pytest.MonkeyPatch) -> None:
    from rendergraph.conformance import readme

    monkeypatch.setitem(readme.SECTIONS, "verse", ("Verse",))
    outcome = rg("conform", "sky", "--only", "readme")
    assert outcome.code == 1
    assert "RG781" in outcome.err
