"""Declared bytes, against sums made by hand."""

from dataclasses import replace

import pytest
from plan_graphs import adds, make_graph, make_pass, reads, texture, writes

from rendergraph.plan.compile import compile_plan
from rendergraph.plan.graph import (
    Access,
    BufferDesc,
    CopyBuffer,
    Dispatch,
    DispatchIndirect,
    DrawIndirect,
    Target,
    TextureDesc,
    Usage,
    Work,
)
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.traffic import declared_bytes

RGBA8 = 16 * 16 * 4
DESCS = {
    "a": texture(),
    "wide": texture("rgba16f"),
    "chain": texture(mips=5),
    "array": texture("r8", layers=3),
    "multi": texture("d32f", samples=4),
    "volume": TextureDesc("r8", 8, 8, 8, 2, 1, Target.D3),
    "buffer": BufferDesc(1000),
    "other": BufferDesc(64),
}


def moved(*accesses: Access, work: Work | None = None) -> tuple[int, int]:
    """(read, written) bytes of a sub-pass with these accesses."""
    step = make_pass("one", accesses).subpasses[0]
    every = make_graph([make_pass("all", [writes(name) for name in DESCS])], ["a"], descs=DESCS)
    plan, _ = compile_plan(make_graph([make_pass("x", [writes("out")])], ["out"]), PlanOptions())
    return declared_bytes(replace(plan, graph=every), replace(step, work=work or step.work))


@pytest.mark.parametrize(
    ("accesses", "expected"),
    [
        ([reads("a"), writes("wide")], (RGBA8, 2 * RGBA8)),
        ([reads("a"), reads("a")], (RGBA8, 0)),  # two samplers of one texture
        ([adds("a")], (RGBA8, RGBA8)),  # blended over
        ([writes("multi", "depth")], (0, RGBA8 * 4)),  # four samples a texel
        ([reads("multi", "depth_read")], (RGBA8 * 4, 0)),
        ([reads("chain")], ((256 + 64 + 16 + 4 + 1) * 4, 0)),
        ([reads("chain", mip=1)], (64 * 4, 0)),
        ([reads("chain", "copy_from", mip=0), writes("chain", "copy_to", mip=1)], (RGBA8, 64 * 4)),
        ([reads("array")], (3 * 256, 0)),
        ([writes("array", layer=2)], (0, 256)),
        ([reads("array", layer=0), reads("array")], (3 * 256, 0)),  # a part within a whole
        ([reads("volume")], (8 * 8 * 8 + 4 * 4 * 4, 0)),
        ([reads("buffer", "storage_read")], (1000, 0)),
        ([adds("buffer", "storage_update")], (1000, 1000)),
        ([adds("buffer", "storage_write")], (0, 1000)),  # partly written: nothing is fetched
        ([adds("a", "image_write")], (0, RGBA8)),
        ([adds("a", "image_update")], (RGBA8, RGBA8)),
        ([writes("a", "clear")], (0, RGBA8)),
        ([], (0, 0)),
    ],
)
def test_bytes(accesses: list[Access], expected: tuple[int, int]) -> None:
    assert moved(*accesses) == expected


def test_arguments_count_as_what_is_fetched_of_them() -> None:
    indirect = Access("buffer", Usage.INDIRECT)
    assert moved(indirect, work=DrawIndirect("buffer", count=3)) == (48, 0)
    assert moved(indirect, work=DispatchIndirect("buffer")) == (12, 0)
    assert moved(reads("buffer", "storage_read"), indirect, work=DispatchIndirect("buffer")) == (1000, 0)
    assert moved(reads("buffer", "storage_read"), work=Dispatch(1)) == (1000, 0)


def test_a_buffer_copy_moves_what_it_copies() -> None:
    copy = CopyBuffer("buffer", "other", 64)
    assert moved(reads("buffer", "copy_from"), writes("other", "copy_to"), work=copy) == (64, 64)
