"""The trace opens in Perfetto: slices of a track nest strictly, resources live as planned, bytes add up."""

from __future__ import annotations

import copy
import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest

from rendergraph.device.clock import FinishWallClock, TimestampClock
from rendergraph.device.clock_proof import ClockProof
from rendergraph.device.context import Device
from rendergraph.document.load import load_document, shipped_graphs
from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.lifetimes import live_bytes
from rendergraph.report.trace import trace_record, write_trace
from rendergraph.run.render import RenderOptions, render_document
from tests.report.made_up import MS, made_up_plan, made_up_result


def nesting_faults(record: dict[str, Any]) -> list[str]:
    """Where slices of one thread overlap without one holding the other; in whole nanoseconds, as Perfetto has them."""
    tracks: dict[tuple[int, int], list[tuple[int, int, str]]] = defaultdict(list)
    for event in record["traceEvents"]:
        if event["ph"] == "X":
            start, length = round(1000 * event["ts"]), round(1000 * event["dur"])
            tracks[event["pid"], event["tid"]].append((start, -(start + length), event["name"]))
            if length < 0 or start < 0:
                tracks[event["pid"], event["tid"]].append((start, start, "negative"))
    faults = []
    for track, slices in tracks.items():
        open_until: list[int] = []
        for start, negative_end, name in sorted(slices):
            while open_until and open_until[-1] <= start:
                open_until.pop()
            if open_until and -negative_end > open_until[-1]:
                faults.append(f"{track} {name}")
            open_until.append(-negative_end)
    return faults


def named_track(record: dict[str, Any], name: str) -> list[dict[str, Any]]:
    (place,) = [
        (e["pid"], e["tid"]) for e in record["traceEvents"] if e["name"] == "thread_name" and e["args"]["name"] == name
    ]
    return [e for e in record["traceEvents"] if e["ph"] == "X" and (e["pid"], e["tid"]) == place]


@pytest.mark.parametrize("name", sorted(shipped_graphs()))
@pytest.mark.parametrize("lag", [0, MS // 4])
def test_slices_nest_on_every_track(name: str, lag: int) -> None:
    assert nesting_faults(trace_record(made_up_result(made_up_plan(name), device_lag=lag))) == []


@pytest.mark.parametrize(
    ("name", "milliseconds"), [("gbuffer.opaque", -0.001), ("gbuffer.opaque", 1.001), ("gbuffer.masked", 0.001)]
)
def test_the_checker_finds_a_slice_moved_out_of_its_place(name: str, milliseconds: float) -> None:
    record = copy.deepcopy(trace_record(made_up_result(made_up_plan())))
    assert nesting_faults(record) == []
    event = next(e for e in record["traceEvents"] if e["name"] == name)
    event["ts"] += 1000 * milliseconds  # before its pass, into its sibling, past its pass
    assert nesting_faults(record)


def test_passes_and_subpasses_stand_where_they_were_measured() -> None:
    plan = made_up_plan()
    record = trace_record(made_up_result(plan, samples=2, device_lag=MS // 4))
    track = named_track(record, "passes (device)")
    for index, subpass in enumerate(plan.order):
        first, second = (e for e in track if e["name"] == subpass.name)
        start = sum(range(1, index + 1)) + index + 0.25  # milliseconds after the host's first submission
        assert first["ts"] == pytest.approx(1000 * start)
        assert first["dur"] == pytest.approx(1000 * (index + 1))
        assert second["ts"] - first["ts"] == pytest.approx(1e6)
    host = named_track(record, "submission (CPU)")
    assert [e["name"] for e in host] == [e["name"] for e in track]
    assert min(e["ts"] for e in host) == 0.0
    frames = [e for e in track if e["name"].startswith("frame ")]
    assert [e["dur"] for e in frames] == [pytest.approx(1000 * (sum(range(1, 14)) + 12))] * 2


def test_each_resource_has_a_track_from_first_to_last_use() -> None:
    plan = made_up_plan()
    record = trace_record(made_up_result(plan, samples=1))
    spans = {e["name"]: (e["ts"], e["ts"] + e["dur"]) for e in named_track(record, "passes (device)")}
    for name, life in plan.lifetimes.items():
        (event,) = named_track(record, name)
        first, last = plan.order[life.first].name, plan.order[life.last].name
        frame = plan.graph.resources[name].kind.value != "transient"
        expected = spans["frame 0"] if frame else (spans[first][0], spans[last][1])
        assert (event["ts"], event["ts"] + event["dur"]) == pytest.approx(expected), name
        assert event["args"]["bytes"] == plan.graph.resources[name].desc.bytes


@pytest.mark.parametrize("name", sorted(shipped_graphs()))
def test_live_bytes_reach_load_and_end_at_nothing(name: str) -> None:
    plan = made_up_plan(name)
    live = live_bytes(plan.graph, plan.lifetimes, len(plan.order))
    assert max(live) == plan.totals.load
    counts = [e["args"]["bytes"] for e in trace_record(made_up_result(plan, 2))["traceEvents"] if e["ph"] == "C"]
    assert counts == [*live, 0] * 2


def test_a_run_without_timed_frames_is_refused() -> None:
    with pytest.raises(RenderGraphError) as caught:
        trace_record(made_up_result(made_up_plan(), samples=0))
    assert caught.value.diagnostics[0].code == "RG575"
    assert caught.value.exit_code == 2


def test_names_are_kept_as_they_are(tmp_path: Path) -> None:
    title = 'quote " backslash \\ <b> ☃'
    write_trace(tmp_path / "trace.json", made_up_result(made_up_plan()), title)
    record = json.loads((tmp_path / "trace.json").read_text(encoding="utf-8"))
    assert record["otherData"]["title"] == title
    assert title in {e["args"].get("name") for e in record["traceEvents"] if e["ph"] == "M"}


@pytest.mark.gpu
def test_a_real_run_nests_and_agrees_with_its_times() -> None:
    result = render_document(load_document("tonemap"), RenderOptions(size=(64, 36), samples=3))
    record = trace_record(result)
    assert nesting_faults(record) == []
    track = named_track(record, "passes (device)")
    for step in result.times.steps:
        assert [e["dur"] for e in track if e["name"] == step.name] == [ns / 1e3 for ns in step.device_ns]
    assert sum(e["name"].startswith("frame ") for e in track) == 3


@pytest.mark.parametrize("kind", [FinishWallClock, TimestampClock])
def test_host_and_device_are_on_one_clock(device: Device, kind: Any) -> None:
    clock = kind(device, ClockProof("agree", 64))
    for _ in range(2):
        clock.begin_frame()
        for index in range(3):
            clock.begin(index)
            device.gl.glFlush()
            clock.end(index)
        clock.end_frame()
        submitted = clock.submit_starts
    frames = clock.drain()
    assert [len(starts) for starts in clock.starts] == [len(times) for times in frames] == [3, 3]
    assert clock.starts[1] == sorted(clock.starts[1])
    assert clock.starts[0][-1] < clock.starts[1][0]
    assert all(abs(a - b) < 50 * MS for a, b in zip(submitted, clock.starts[1], strict=True))


def test_no_thread_is_taken_for_a_main_thread_and_none_is_named_twice() -> None:
    """A thread numbered as its process is marked and moved to the front; one number for two names shows one of them."""
    record = trace_record(made_up_result(made_up_plan()))
    threads = [(e["pid"], e["tid"]) for e in record["traceEvents"] if e["name"] == "thread_name"]
    assert len({thread for _, thread in threads}) == len(threads)
    assert not {process for process, _ in threads} & {thread for _, thread in threads}
