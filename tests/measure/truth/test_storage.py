"""What formats and the hardware's rounding cost, against a ramp really stored; shares of what is allowed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from rendergraph.device.context import Device
from rendergraph.document.formats import FORMATS, REAL
from rendergraph.document.load import load_document
from rendergraph.measure.truth.observe import observe
from rendergraph.measure.truth.shares import as_shares
from rendergraph.measure.truth.storage import held, rounding, srgb_encode, step, steps, storage_error
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import plan_document

RAMP = """\
#version 450
layout(location = 0) out vec4 color;
void main() {
    float shade = (gl_FragCoord.x - 0.5 + 256.0 * (gl_FragCoord.y - 0.5)) / 8192.0;
    color = vec4(shade, 1.0 - shade, 0.5 * shade, 1.0);
}
"""


def ramp() -> np.ndarray:
    """What the shader writes."""
    y, x = np.mgrid[:32, :256]
    shade = (x + 256.0 * y) / 8192.0
    return np.stack([shade, 1.0 - shade, 0.5 * shade, np.ones_like(shade)], axis=-1)


@pytest.mark.gpu
@pytest.mark.parametrize("format", sorted(f for f in REAL if FORMATS[f].renderable))
def test_a_stored_ramp_keeps_to_what_is_stated(device: Device, tmp_path: Path, format: str) -> None:
    (tmp_path / "ramp.frag").write_text(RAMP)
    graph = {
        "rendergraph": 1,
        "frame": {"size": [256, 32]},
        "resources": {"ramp": {"format": format}},
        "passes": {"paint": {"node": "fullscreen", "write": {"color": "ramp"}, "set": {"shader": "ramp.frag"}}},
        "outputs": {"ramp": {"file": "ramp.npy"}},
    }
    (tmp_path / "graph.yaml").write_text(yaml.safe_dump(graph))
    document = load_document(tmp_path / "graph.yaml")
    run = observe(document, plan_document(document, PlanOptions()), device, ["paint"])["paint"]
    stored = np.asarray(run.outputs["color"])
    value = ramp()[..., : stored.shape[-1]]
    allowed = storage_error(format, value)
    error = np.abs(stored - value)
    assert (error <= allowed + 1e-7).all()
    if allowed.any():
        assert (error > 0.4 * allowed).any()  # the twin: less than half would not do


def test_steps_by_hand() -> None:
    assert step("rgba8").tolist() == [1 / 255] * 4
    assert step("rg8_snorm").tolist() == [1 / 127] * 2
    assert step("rgb10_a2").tolist() == [1 / 1023] * 3 + [1 / 3]
    assert step("d24").item() == 1 / (2**24 - 1)
    assert steps("rgba16f", np.array([1.0, 1.999, 2.0, 0.0])).tolist() == [2**-10, 2**-10, 2**-9, 2**-24]
    assert steps("r11g11b10f", np.array([1.0, 1.0, 1.0])).tolist() == [2**-6, 2**-6, 2**-5]
    assert steps("rgba8ui", np.array([7.0])).tolist() == [1.0]
    assert [rounding(f) for f in ("rgba8", "rgba16f", "rgba32f", "r8ui")] == [0.56, 1.0, 0.0, 0.0]
    # An sRGB step at white: the slope of the decoding there, over 255.
    assert steps("srgb8_a8", np.ones(4))[0] == pytest.approx(2.4 / 1.055 / 255)


def test_values_are_moved_into_range() -> None:
    assert held("rgba8", np.array([-1.0, 2.0])).tolist() == [0.0, 1.0]
    assert held("rg8_snorm", np.array([-2.0, 0.5])).tolist() == [-1.0, 0.5]
    assert held("r11g11b10f", np.array([1e9, -1.0, 1e9])).tolist() == [65024.0, 0.0, 64512.0]
    assert held("rgba16f", np.array([-1e9])).tolist() == [-65504.0]
    assert held("r8ui", np.array([300.0])).tolist() == [300.0]


def test_encoding_meets_its_two_pieces() -> None:
    assert srgb_encode(np.array([0.0, 1.0, 0.0031308])).tolist() == pytest.approx([0.0, 1.0, 0.0404499])


def test_shares() -> None:
    value, judged = np.array([[[1.0, 2.0]]]), np.array([[[1.1, 2.0]]])
    a, b, tolerance = as_shares(judged, value, np.array([[[0.2, 0.0]]]))
    assert (np.abs(a - b).max(), tolerance) == (pytest.approx(0.5), 1.0)
    a, b, _ = as_shares(judged + np.array([0.0, 1e-9]), value, np.array([[[0.2, 0.0]]]))
    assert np.abs(a - b).max() > 1.0
    a, b, tolerance = as_shares(judged, value, np.zeros((1, 1, 2)))
    assert (np.abs(a - b).max(), tolerance) == (pytest.approx(0.1), 0.0)
