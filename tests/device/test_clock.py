"""Clocks: proven honest, chosen accordingly, and with the same interface."""

from __future__ import annotations

import time

import pytest

from rendergraph.device import enums as e
from rendergraph.device.clock import RING, Clock, FinishWallClock, TimestampClock, choose_clock
from rendergraph.device.clock_proof import ABSOLUTE_TOLERANCE_NS, ClockProof, agree, prove_clock
from rendergraph.device.context import Device
from rendergraph.device.framebuffers import create_framebuffer, destroy_framebuffer
from rendergraph.device.textures import create_texture, destroy_texture
from rendergraph.device.timestamps import create_timestamp, read_timestamp
from rendergraph.plan.graph import TextureDesc

UNPROVEN = ClockProof("agree", 64)


def test_the_proof_rejects_a_lying_timer(device: Device) -> None:
    clock = choose_clock(device)
    proof = clock.proof
    assert min(proof.raster_wall_ns, proof.compute_wall_ns) > 2 * ABSOLUTE_TOLERANCE_NS, "too short to prove anything"
    if device.info.is_software:
        assert clock.name == "finish_wall"
        assert proof.reason in ("disagree", "software")
        # llvmpipe stamps the binning, not the rasterising; on a busy machine the binning may take long too
        proofs = (proof, *(prove_clock(device) for _ in range(4)))
        assert any(p.raster_timestamp_ns < p.raster_wall_ns / 2 for p in proofs)
    else:
        assert clock.name == ("gpu_timestamp" if proof.reason == "agree" else "finish_wall")


def test_the_proof_is_made_once_and_costs_no_counts(device: Device) -> None:
    choose_clock(device)
    before, owned = device.counters.snapshot(), dict(device.owned)
    start = time.perf_counter()
    assert choose_clock(device).proof is device.clock_proof
    assert time.perf_counter() - start < 0.01
    prove_clock(device)
    assert device.counters == before
    assert device.owned == owned


@pytest.mark.parametrize(
    ("wall", "stamp", "same"),
    [
        (5_000_000, 5_000_000, True), (5_000_000, 6_200_000, True), (5_000_000, 6_300_000, False),
        (5_000_000, 400_000, False), (10_000, 59_000, True), (10_000, 61_000, False), (60_000, 11_000, True),
    ],
)  # fmt: skip
def test_agreement(wall: int, stamp: int, same: bool) -> None:
    assert agree(wall, stamp) is same


@pytest.fixture(params=[FinishWallClock, TimestampClock])
def clock(request, device: Device) -> Clock:
    """Each clock, whether this renderer deserves it or not."""
    return request.param(device, UNPROVEN)


def test_frames_come_out_whole_and_in_order(device: Device, clock: Clock) -> None:
    given = []
    for frame in range(2 * RING + 1):
        clock.begin_frame()
        for index in range(frame % 3 + 1):  # frames may differ in length
            clock.begin(index)
            device.gl.glFlush()
            clock.end(index)
        early = clock.end_frame()
        assert len(clock.submit_ns) == len(clock.process_ns) == len(clock.submit_starts) == frame % 3 + 1
        if early is not None:
            given.append(early)
    frames = clock.drain()
    assert [len(times) for times in frames] == [frame % 3 + 1 for frame in range(2 * RING + 1)]
    assert all(ns >= 0 for times in frames for ns in times)
    assert all(times in frames for times in given)
    assert clock.drain() == []


def test_an_empty_frame(clock: Clock) -> None:
    clock.begin_frame()
    clock.end_frame()
    assert clock.drain() == [[]]


def test_timing_creates_nothing_that_counts(device: Device, clock: Clock) -> None:
    before = device.counters.snapshot()
    clock.begin_frame()
    clock.begin(0)
    clock.end(0)
    clock.end_frame()
    clock.drain()
    assert device.counters == before


def test_the_wall_clock_blames_the_pass_that_works(device: Device, compile_text, draw) -> None:
    program = compile_text(
        uniforms={"u_steps": 3000},
        fragment="uniform int u_steps;\nin vec2 v_uv;\nout float o;\nvoid main() {\n"
        "float x = v_uv.x; for (int i = 0; i < u_steps; ++i) x = x * 0.999 + v_uv.y; o = x; }",
    )
    texture = create_texture(device, TextureDesc("r32f", 128, 128), "work")
    framebuffer = create_framebuffer(device, [(texture, 0, None)], None, "work")
    draw(program, framebuffer)  # compiles the variant
    clock = FinishWallClock(device, UNPROVEN)
    clock.begin_frame()
    for index in range(3):
        clock.begin(index)
        if index == 1:
            draw(program, framebuffer)
        clock.end(index)
    times = clock.end_frame()
    assert times is not None
    assert times[1] > 10 * max(times[0], times[2])
    assert times[1] > clock.submit_ns[1]
    destroy_framebuffer(device, framebuffer)
    destroy_texture(device, texture)


def test_the_counter_is_wide_enough_to_be_read(device: Device) -> None:
    query = create_timestamp(device)
    device.gl.glQueryCounter(query, e.TIMESTAMP)
    device.finish()
    first = read_timestamp(device, query)
    device.gl.glQueryCounter(query, e.TIMESTAMP)
    assert read_timestamp(device, query) > first > 2**32 or not device.info.is_software
    device.delete_object("glDeleteQueries", query)


def test_timestamps_never_wait(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    """A device that is always behind: more frames than the ring holds begin without one result being fetched."""
    monkeypatch.setattr("rendergraph.device.clock.read_available", lambda device, query: False)
    fetched: list[int] = []

    def fetch(device: Device, queries: list[int]) -> list[int]:
        fetched.extend(queries)
        return [0] * len(queries)

    monkeypatch.setattr("rendergraph.device.clock.read_timestamps", fetch)
    clock = TimestampClock(device, UNPROVEN)
    for _ in range(3 * RING):
        clock.begin_frame()
        clock.begin(0)
        clock.end(0)
        assert clock.end_frame() is None
    assert fetched == []
    assert len(clock.drain()) == 3 * RING
    assert len(set(fetched)) == 2 * 3 * RING, "frames in flight share no query"
    clock.begin_frame()
    clock.begin(0)
    assert clock._queries[0] in fetched, "queries are used again once they are read"
    clock.end(0)
    clock.end_frame()
    clock.drain()
