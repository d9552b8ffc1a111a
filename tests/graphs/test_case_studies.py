"""The case studies: slow and fixed show the same picture, and differ in what makes the difference."""

from __future__ import annotations

import numpy as np
import pytest

from rendergraph.document.load import load_document
from rendergraph.run.render import RenderOptions, render_document
from rendergraph.run.result import FrameResult

pytestmark = pytest.mark.gpu


def run(graph: str, *overrides: str) -> FrameResult:
    return render_document(load_document(graph, overrides), RenderOptions(size=(192, 108), samples=0))


@pytest.mark.parametrize(("case", "other"), [("case_draw_calls", "u_turn=0.01"), ("case_sync", "u_turn=0.01")])
def test_the_fix_keeps_every_bit(case: str, other: str) -> None:
    slow, fixed = run(case).images["image"], run(f"{case}_fixed").images["image"]
    assert np.array_equal(slow, fixed)
    twin = run(f"{case}_fixed", f"passes.stars.set.uniforms.{other}").images["image"]
    assert not np.array_equal(slow, twin), "a test that would pass for any picture"


def test_half_resolution_keeps_soft_clouds_within_a_mean_of_one_step() -> None:
    slow, fixed = (run(graph).images["image"].astype(np.float64) for graph in ("case_gpu", "case_gpu_fixed"))
    assert np.abs(slow - fixed).mean() < 1.0
    moved = run("case_gpu", "passes.march.set.uniforms.u_wind=400.0").images["image"].astype(np.float64)
    assert np.abs(slow - moved).mean() > 1.0


def test_what_was_changed_is_in_the_counters() -> None:
    def total(graph: str, name: str) -> int:
        return sum(getattr(step, name) for step in run(graph).counters)

    assert (total("case_draw_calls", "draw_calls"), total("case_draw_calls_fixed", "draw_calls")) == (8000, 1)
    assert total("case_gpu", "bytes_written") > 1.8 * total("case_gpu_fixed", "bytes_written")
    assert (total("case_sync", "host_bytes"), total("case_sync_fixed", "host_bytes")) == (192 * 108 * 4, 0)
