"""The timing record's arithmetic, on times made up for it."""

from rendergraph.document.load import load_document
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.tables import mebibytes, timing_table
from rendergraph.report.timing import spread, timing_record
from rendergraph.run.result import DeviceFacts, FrameResult, RunTimes, SteadyState, StepTimes


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
