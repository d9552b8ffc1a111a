"""The timing record's arithmetic, on times made up for it."""

import io
from dataclasses import replace
from typing import Any

import pytest
from rich.console import Console

from rendergraph.document.load import load_document
from rendergraph.document.messages import diagnose
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.tables import mebibytes, timing_table
from rendergraph.report.timing import driver_version, spread, thread_count, timing_record
from rendergraph.run.result import DeviceFacts, FrameResult, RunTimes, SteadyState, StepCounters, StepTimes
from tests.report.made_up import BOUND


def result(samples: int) -> FrameResult:
    """Every sub-pass takes 1, 2, 3 ... ms in turn."""
    plan, _ = plan_without_scene(load_document("deferred_shading"), PlanOptions())
    times = tuple(range(1_000_000, 1_000_000 * (samples + 1), 1_000_000))
    steps = tuple(StepTimes(s.name, times, times, times) for s in plan.order)
    return FrameResult(
        plan=plan,
        images={},
        files={},
        captures={},
        times=RunTimes(1, 2, 3, 4, 5_000_000, times, steps, 1),
        steady=SteadyState(0, 0, 0),
        device=DeviceFacts("renderer", "vendor", "version", "finish_wall", {"reason": "disagree"}),
        frames=1,
        counters=tuple(StepCounters(s.name, 1, 1, 0, 0, 2, 300_000, 200_000, 0, {"fragments": 5}) for s in plan.order),
    )


def test_a_pass_is_the_sum_of_its_subpasses_frame_by_frame() -> None:
    record = timing_record(result(3), "title")
    by_name = {p["name"]: p for p in record["passes"]}
    count = len(by_name["meter"]["subpasses"])
    assert count > 1
    assert by_name["meter"]["ms"] == {
        "median": 2.0 * count,
        "min": 1.0 * count,
        "max": 3.0 * count,
        "samples": [1.0 * count, 2.0 * count, 3.0 * count],
    }
    assert record["once_ms"]["first_frame"] == 5.0
    assert record["clock"] == {"name": "finish_wall", "proof": {"reason": "disagree"}}


def test_passes_come_in_execution_order() -> None:
    names = [p["name"] for p in timing_record(result(1))["passes"]]
    assert names.index("light") < names.index("sky") < names.index("glass") < names.index("tonemap")
    assert names[-1] == "antialias"


def test_no_samples_are_null_not_zero() -> None:
    record = timing_record(result(0))
    assert record["frame_ms"] == {"median": None, "min": None, "max": None, "samples": []}
    timing_table(record)


def test_spread_of_even_counts_is_the_middle() -> None:
    assert spread([4_000_000, 1_000_000, 2_000_000, 3_000_000])["median"] == 2.5


def test_bytes_for_people() -> None:
    assert [mebibytes(b) for b in (16, 1024, 1536, 2**20, 3 * 2**19)] == [
        "16 B",
        "1.0 KiB",
        "1.5 KiB",
        "1.00 MiB",
        "1.50 MiB",
    ]


def test_counters_and_bandwidth_of_a_pass_are_its_subpasses_together() -> None:
    record = timing_record(result(3))
    assert record["statistics"]["source"] == "GL_ARB_pipeline_statistics_query"
    for entry in record["passes"]:
        count = len(entry["subpasses"])
        assert entry["counters"]["draws"] == count
        assert entry["counters"]["bytes_read"] == 300_000 * count
        assert entry["statistics"] == {"fragments": 5 * count}
        # 0.5 MB a sub-pass in a median of 2 ms: 0.25 GB/s, however many
        assert entry["gb_per_s"] == entry["subpasses"][0]["gb_per_s"] == 0.25


def test_what_one_subpass_does_not_know_the_pass_does_not_either() -> None:
    unknown = result(1)
    first, *others = (replace(step, triangles=None, statistics=None) for step in unknown.counters)
    known = [replace(step, triangles=2, statistics={"fragments": 5}) for step in others]
    record = timing_record(replace(unknown, counters=(first, *known)))
    by_step = {step["name"]: entry for entry in record["passes"] for step in entry["subpasses"]}
    assert by_step[first.name]["counters"]["triangles"] is None
    assert by_step[first.name]["statistics"] is None
    assert by_step[known[-1].name]["counters"]["triangles"] is not None


def test_without_samples_there_is_no_bandwidth() -> None:
    record = timing_record(replace(result(0), counters=()))
    assert {entry["gb_per_s"] for entry in record["passes"]} == {None}
    assert record["statistics"]["source"] is None


def test_driver_versions() -> None:
    assert driver_version("4.5 (Core Profile) Mesa 22.3.6") == "Mesa 22.3.6"
    assert driver_version("4.5.0 NVIDIA 580.159.04") == "NVIDIA 580.159.04"
    assert driver_version("4.6.14761 Core Profile Context 22.1") == "Core Profile Context 22.1"
    assert driver_version("odd") == "odd"


def test_threads_are_those_that_rasterise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LP_NUM_THREADS", "7")
    assert thread_count("llvmpipe (LLVM 15)") == 7
    assert thread_count("NVIDIA H200") == thread_count("other")
    monkeypatch.setenv("LP_NUM_THREADS", "0")
    assert thread_count("llvmpipe (LLVM 15)") == 1
    monkeypatch.delenv("LP_NUM_THREADS")
    assert thread_count("llvmpipe (LLVM 15)") == thread_count("other") >= 1


def test_what_the_driver_warned_of_is_in_the_record_and_other_warnings_are_not() -> None:
    heard = diagnose("RG507", None, where=" in a.b", what="", detail="undefined", scope="a.b", resource="hdr")
    other = diagnose("RG582", side="A", frames=3)
    record = timing_record(replace(result(1), warnings=(other, heard)))
    assert record["driver_warnings"] == [{"text": "undefined", "subpass": "a.b", "resource": "hdr"}]
    assert timing_record(result(1))["driver_warnings"] == []


@pytest.mark.parametrize("samples", [0, 3])
def test_the_table_says_what_the_frame_is_bound_by(samples: int) -> None:
    def printed(record: dict[str, Any]) -> str:
        console = Console(width=200, record=True, file=io.StringIO())
        console.print(timing_table(record))
        return console.export_text()

    assert "bound by" not in printed(timing_record(result(samples)))
    assert "the frame is bound by gpu (100 % of rounds agree)" in printed(timing_record(result(samples), bound=BOUND))
