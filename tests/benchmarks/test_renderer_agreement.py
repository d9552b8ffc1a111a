"""The comparison of two renderers' records: what agrees passes, and each way of disagreeing fails."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from benchmarks import renderer_agreement
from benchmarks.renderer_agreement import compare

Images = dict[str, npt.NDArray[np.generic]]
RECORD = {
    "device": {"renderer": "r", "version": "4.5"},
    "timing": {"clock": {"name": "finish_wall", "proof": {"raster_wall_ns": 1}}, "frame_ms": {"median": 2.0}},
}


def images() -> Images:
    """A textured and an untextured picture of 100 x 10 pixels, and a float one."""
    noise = np.random.default_rng(5).integers(20, 200, (10, 100, 4), dtype=np.uint8)
    return {"gbuffer.image": noise, "tonemap.aces": noise.copy(), "sky.depth": np.zeros((10, 100), np.float32)}


def saved(path: Path, found: Images) -> Path:
    np.savez(path, record=json.dumps(RECORD), **found)  # type: ignore[arg-type]
    return path


def compared(tmp_path: Path, there: Images) -> list[str]:
    return compare(saved(tmp_path / "here.npz", images()), saved(tmp_path / "there.npz", there))


def test_the_same_images_agree(tmp_path: Path) -> None:
    assert compared(tmp_path, images()) == []


def test_what_the_tolerance_allows(tmp_path: Path) -> None:
    there = images()
    there["gbuffer.image"][..., :3] += np.uint8(1)
    there["gbuffer.image"][0, :20, 1] += np.uint8(40)  # 2 % of the pixels; the mean is 1.8
    there["gbuffer.image"][..., 3] = 0  # coverage is not compared
    there["tonemap.aces"][..., 0] += np.uint8(2)
    there["sky.depth"] += np.float32(9)
    assert compared(tmp_path, there) == []


def test_a_mean_that_is_too_large(tmp_path: Path) -> None:
    there = images()
    there["gbuffer.image"][..., 2] += np.uint8(3)
    (failure,) = compared(tmp_path, there)
    assert failure.startswith("gbuffer.image: mean")


def test_too_many_pixels_far_off(tmp_path: Path) -> None:
    there = images()
    there["gbuffer.image"][0, :21, 1] += np.uint8(9)
    (failure,) = compared(tmp_path, there)
    assert failure.startswith("gbuffer.image: 2.10 %")


def test_an_untextured_image_may_be_off_by_two_steps_only(tmp_path: Path) -> None:
    there = images()
    there["tonemap.aces"][3, 3, 0] += np.uint8(3)
    (failure,) = compared(tmp_path, there)
    assert failure.startswith("tonemap.aces: off by 3")


def test_images_that_cannot_be_compared(tmp_path: Path) -> None:
    there = images()
    del there["gbuffer.image"]
    there["tonemap.aces"] = there["tonemap.aces"][:5]
    assert len(compared(tmp_path, there)) == 2
    nothing = saved(tmp_path / "nothing.npz", {})
    assert compare(nothing, nothing)


@pytest.mark.parametrize(("shift", "code"), [(0, 0), (9, 1)])
def test_exit_codes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, shift: int, code: int) -> None:
    there = images()
    there["gbuffer.image"][..., 0] += np.uint8(shift)
    files = [str(saved(tmp_path / name, found)) for name, found in (("a.npz", images()), ("b.npz", there))]
    monkeypatch.setattr(sys, "argv", ["renderer_agreement", "compare", *files])
    with pytest.raises(SystemExit) as exited:
        renderer_agreement.main()
    assert exited.value.code == code
