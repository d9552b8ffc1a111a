"""The meter against sorted texels in float64, adaptation over frames, and frames that hold nothing to meter."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from graph_run import RADIANCE, build_node, paint, run_graph
from pydantic import ValidationError

from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.nodes.exposure import ExposureParams, reference
from rendergraph.plan.graph import BufferDesc, ClearResource, Dispatch, TextureDesc, Usage
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import plan_document

HALF_BIN = 24.0 / 510.0

ONE_BRIGHT = """\
#version 450
out vec4 color;
void main() { color = vec4(ivec2(gl_FragCoord.xy) == ivec2(3, 2) ? vec3(60000.0) : vec3(0.18), 1.0); }
"""

UNIFORM = """\
#version 450
uniform uint u_bits;
out vec4 color;
void main() { color = vec4(vec3(uintBitsToFloat(u_bits)), 1.0); }
"""

STEP = """\
#version 450
#include <frame.glsl>
out vec4 color;
void main() { color = vec4(vec3(frame.counts.x == 0u ? 0.18 : frame.counts.x < 3u ? 2.88 : 0.01125), 1.0); }
"""


def graph(settings: dict[str, Any], size: tuple[int, int] = (70, 41), **more: Any) -> dict[str, Any]:
    """Paint, meter, and tone-map so that the exposure is needed."""
    reads = {"color": "hdr", **({"previous": "last"} if more.pop("history", False) else {})}
    resources: dict[str, Any] = {"hdr": {"format": "rgba32f"}, "exposure": {"bytes": 16}}
    if "previous" in reads:
        resources["last"] = {"previous": "exposure"}
    return {
        "frame": {"size": list(size), **more.get("frame", {})},
        "resources": resources,
        "passes": {
            "paint": paint("hdr", **more.get("paint", {})),
            "meter": {"node": "exposure", "read": reads, "write": {"exposure": "exposure"}, "set": settings},
            "map": {"node": "tonemap", "read": {"color": "hdr", "exposure": "exposure"}, "write": {"color": "image"}},
        },
        "outputs": {"image": {"file": "image.png"}},
    }


def metered(folder: Path, shader: str, settings: dict[str, Any], **more: Any) -> tuple[np.ndarray, np.ndarray]:
    """The exposure buffer (scale, log luminance, measured, texels) and the image metered."""
    result = run_graph(folder, graph(settings, **more), {"paint.frag": shader}, captures=("exposure", "hdr"))
    words = result.captures["exposure"].reshape(-1)
    return np.array([*words[:3].astype(float), words[3:].view(np.uint32)[0]]), result.captures["hdr"]


# ---------------------------------------------------------------- the sub-passes


def usages(mode: str, **inputs: BufferDesc) -> list[tuple[str, list[tuple[str, Usage]]]]:
    """Names and accesses of a mode's sub-passes."""
    b = build_node(
        "exposure", {"mode": mode}, {"color": TextureDesc("rgba16f", 100, 50), **inputs}, {"exposure": BufferDesc(16)}
    )
    return [(s.name, [(a.resource, a.usage) for a in s.accesses]) for s in b.subpasses]


def test_histogram_is_cleared_counted_and_reduced() -> None:
    assert usages("histogram") == [
        ("p.clear", [("p.histogram", Usage.CLEAR)]),
        ("p.count", [("in_color", Usage.SAMPLED), ("p.histogram", Usage.STORAGE_UPDATE)]),
        ("p.reduce", [("p.histogram", Usage.STORAGE_READ), ("out_exposure", Usage.STORAGE_WRITE)]),
    ]


def test_average_sums_and_reduces() -> None:
    assert usages("average", previous=BufferDesc(16)) == [
        ("p.sum", [("in_color", Usage.SAMPLED), ("p.partials", Usage.STORAGE_WRITE)]),
        (
            "p.reduce",
            [
                ("p.partials", Usage.STORAGE_READ),
                ("out_exposure", Usage.STORAGE_WRITE),
                ("in_previous", Usage.STORAGE_READ),
            ],
        ),
    ]


def test_manual_reads_nothing() -> None:
    assert usages("manual", previous=BufferDesc(16)) == [("p.write", [("out_exposure", Usage.STORAGE_WRITE)])]


def test_stride_saves_work_groups() -> None:
    image = {"color": TextureDesc("rgba16f", 1280, 720)}
    groups = []
    for stride in (1, 4):
        b = build_node("exposure", {"stride": stride}, image, {"exposure": BufferDesc(16)})
        work = b.subpasses[1].work
        assert isinstance(work, Dispatch)
        groups.append((work.x, work.y))
    assert groups == [(40, 23), (10, 6)]
    assert isinstance(b.subpasses[0].work, ClearResource)


@pytest.mark.parametrize("port", ["previous", "exposure"])
def test_buffer_too_small(port: str) -> None:
    sizes = {"previous": 16, "exposure": 16} | {port: 8}
    with pytest.raises(RenderGraphError) as raised:
        build_node(
            "exposure",
            {},
            {"color": TextureDesc("rgba16f", 8, 8), "previous": BufferDesc(sizes["previous"])},
            {"exposure": BufferDesc(sizes["exposure"])},
        )
    assert raised.value.diagnostics[0].code == "RG225"


@pytest.mark.parametrize("wrong", [{"low": 0.9, "high": 0.9}, {"min_ev": 3, "max_ev": 3}, {"stride": 0}])
def test_ranges_that_hold_nothing_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValidationError):
        ExposureParams(**wrong)


def test_barriers_between_count_reduce_and_use(tmp_path: Path) -> None:
    (tmp_path / "paint.frag").write_text(RADIANCE)
    path = tmp_path / "graph.yaml"
    path.write_text(yaml.safe_dump({"rendergraph": 1, **graph({})}))
    plan = plan_document(load_document(path), PlanOptions()).plan
    found = {
        (h.earlier, h.later, h.resource, h.kind)
        for barrier in plan.barriers
        for h in barrier.hazards
        if h.resource == h.previous_resource
    }
    assert ("meter.count", "meter.reduce", "meter.histogram", "shader_storage") in found
    assert ("meter.reduce", "map.map", "exposure", "shader_storage") in found


# ---------------------------------------------------------------- the meter


@pytest.mark.gpu
@pytest.mark.parametrize("stride", [1, 3])
def test_average_equals_float64(device: Device, tmp_path: Path, stride: int) -> None:
    got, image = metered(tmp_path, RADIANCE, {"mode": "average", "stride": stride, "compensation": 0.5})
    evs = reference.log_luminances(image, -10.0, 14.0, stride)
    assert got[3] == evs.size < image[::stride, ::stride, 0].size  # NaN and infinities are left out
    assert got[1] == pytest.approx(evs.mean(), abs=1e-5)
    assert got[0] == pytest.approx(reference.scale(evs.mean(), 0.5), rel=1e-5)


@pytest.mark.gpu
def test_error_grows_with_the_stride(device: Device, tmp_path: Path) -> None:
    errors = []
    for stride in (1, 4, 16):
        got, image = metered(tmp_path, RADIANCE, {"mode": "average", "stride": stride})
        errors.append(abs(got[1] - reference.log_luminances(image, -10.0, 14.0).mean()))
    assert errors == sorted(errors)
    assert errors[0] < 1e-5 < errors[1]


@pytest.mark.gpu
@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (0.5, 0.95), (0.0, 0.01), (0.99, 1.0), (0.31, 0.32)])
def test_histogram_is_within_half_a_bin(device: Device, tmp_path: Path, low: float, high: float) -> None:
    got, image = metered(tmp_path, RADIANCE, {"low": low, "high": high})
    evs = reference.log_luminances(image, -10.0, 14.0)
    assert got[3] == evs.size
    assert abs(got[1] - reference.trimmed_mean(evs, low, high)) < HALF_BIN + 1e-5
    if (low, high) != (0.0, 1.0):  # the twin: the plain mean is not within it
        assert abs(got[1] - evs.mean()) > HALF_BIN


def test_trimmed_mean_by_hand() -> None:
    # Ranks 1 to 2.5 of four texels: the second whole, the third half.
    assert reference.trimmed_mean(np.array([8.0, 1.0, 2.0, 4.0]), 0.25, 0.625) == pytest.approx((2 + 0.5 * 4) / 1.5)


# ---------------------------------------------------------------- the extremes


@pytest.mark.gpu
@pytest.mark.parametrize("mode", ["histogram", "average"])
def test_black_frame_is_metered_as_the_darkest(device: Device, tmp_path: Path, mode: str) -> None:
    got, _ = metered(tmp_path, UNIFORM, {"mode": mode}, paint={"uniforms": {"u_bits": 0}})
    assert got[1] == pytest.approx(-10.0, abs=1e-4)
    assert got[0] == pytest.approx(0.18 * 2.0**10, rel=1e-4)
    assert got[3] == 70 * 41


@pytest.mark.gpu
@pytest.mark.parametrize("mode", ["histogram", "average"])
@pytest.mark.parametrize("bits", [0x7FC00000, 0x7F800000])
def test_nothing_finite_leaves_the_compensation(device: Device, tmp_path: Path, mode: str, bits: int) -> None:
    got, _ = metered(
        tmp_path, UNIFORM, {"mode": mode, "compensation": 2.0}, paint={"uniforms": {"u_bits": bits}}, history=True
    )
    assert got[3] == 0
    assert got[0] == pytest.approx(4.0)


@pytest.mark.gpu
def test_single_bright_texel_does_not_move_the_histogram(device: Device, tmp_path: Path) -> None:
    histogram, _ = metered(tmp_path, ONE_BRIGHT, {}, size=(16, 16))
    assert histogram[0] == pytest.approx(1.0, rel=0.04)  # within half a bin of 0.18 on middle grey
    average, image = metered(tmp_path, ONE_BRIGHT, {"mode": "average"}, size=(16, 16))
    moved = np.log2(60000 / 0.18)
    assert image.shape[:2] == (16, 16)
    assert average[1] == pytest.approx(np.log2(0.18) + min(moved, 14 - np.log2(0.18)) / 256, abs=1e-4)
    assert average[1] > histogram[1] + 0.02


@pytest.mark.gpu
@pytest.mark.parametrize("mode", ["histogram", "average"])
def test_one_texel(device: Device, tmp_path: Path, mode: str) -> None:
    one = int(np.float32(1.0).view(np.uint32))
    got, _ = metered(tmp_path, UNIFORM, {"mode": mode}, size=(1, 1), paint={"uniforms": {"u_bits": one}})
    assert got[1] == pytest.approx(0.0, abs=HALF_BIN)
    assert got[3] == 1


@pytest.mark.gpu
def test_manual_is_the_compensation(device: Device, tmp_path: Path) -> None:
    got, _ = metered(tmp_path, RADIANCE, {"mode": "manual", "compensation": -1.5})
    assert got[0] == pytest.approx(2.0**-1.5)


# ---------------------------------------------------------------- adaptation


@pytest.mark.gpu
@pytest.mark.parametrize("frames", [1, 2, 3, 5])
def test_adapts_frame_by_frame(device: Device, tmp_path: Path, frames: int) -> None:
    got, _ = metered(
        tmp_path,
        STEP,
        {"mode": "average", "brighten": 0.25, "darken": 0.5},
        history=True,
        frame={"count": frames},
        size=(16, 16),
    )
    grey = float(np.log2(0.18))
    scene = [grey, grey + 4, grey + 4, grey - 4, grey - 4][:frames]
    last = scene[0]  # the first frame has no history and follows at once
    for target in scene[1:]:
        last = reference.adapt(last, target, 0.25, 0.5)
    assert got[1] == pytest.approx(last, abs=1e-4)
    assert got[2] == pytest.approx(scene[-1], abs=1e-4)
