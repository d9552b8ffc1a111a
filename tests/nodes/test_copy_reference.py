"""Copies and clears held against what OpenGL says they hold: every kind of conversion, and contents spoilt."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from judged import judge_run, passes_of
from test_fxaa import NOISE

from rendergraph.device.context import Device
from rendergraph.node.reference import PassRun
from rendergraph.nodes.copy.texel_bits import reinterpret

pytestmark = pytest.mark.gpu


def copied(
    device: Device, folder: Path, source: dict[str, Any], destination: dict[str, Any], **settings: bool | str
) -> PassRun:
    """Noise of a texture, and its copy."""
    (folder / "noise.frag").write_text(NOISE)
    graph = {
        "rendergraph": 1,
        "resources": {"source": source, "destination": destination},
        "passes": {
            "paint": {"node": "fullscreen", "write": {"color": "source"}, "set": {"shader": "noise.frag"}},
            "copy": {
                "node": "copy", "read": {"source": "source"}, "write": {"destination": "destination"}, "set": settings,
            },
        },
        "outputs": {"destination": {"file": "destination.npy"}},
    }  # fmt: skip
    (folder / "graph.yaml").write_text(yaml.safe_dump(graph, sort_keys=False))
    return passes_of(device, str(folder / "graph.yaml"), "copy", "frame.size=[24, 16]")["copy"]


def one_step(run: PassRun, port: str) -> PassRun:
    """The run, had one texel another value, by three 8-bit steps or its relative size."""
    bad = np.array(run.outputs[port], np.float64)
    y, x = (int(v[len(v) // 3]) for v in np.nonzero((np.abs(bad) < 100.0).all(axis=-1)))
    bad[y, x, 0] += max(abs(bad[y, x, 0]) * 0.02, 0.012)
    return replace(run, outputs={**run.outputs, port: bad})


BITS = [
    ("rgba8", "rgba8"), ("rgba8", "r32f"), ("rgba8_snorm", "rgba8"), ("rgb10_a2", "r11g11b10f"), ("rgba32f", "rgba32f"),
    ("r11g11b10f", "rgb10_a2"), ("rgba16f", "rgba16"), ("srgb8_a8", "rgba8"), ("rg16", "rgba8"),
    ("rg16f", "rg16_snorm"),
]  # fmt: skip


@pytest.mark.parametrize(("source", "destination"), BITS, ids="-".join)
def test_bits_are_kept(device: Device, tmp_path: Path, source: str, destination: str) -> None:
    run = copied(device, tmp_path, {"format": source}, {"format": destination})
    assert judge_run("copy", run).above == ()
    assert judge_run("copy", one_step(run, "destination")).above == ("destination",)


CONVERTED = [
    ({"format": "rgba32f"}, {"format": "rgba8"}), ({"format": "rgba8"}, {"format": "rgba16f"}),
    ({"format": "rgba8"}, {"format": "srgb8_a8"}), ({"format": "srgb8_a8"}, {"format": "rgba32f"}),
    ({"format": "r8"}, {"format": "rgba8"}), ({"format": "rgba8"}, {"format": "rgba8", "fixed": [31, 57]}),
]  # fmt: skip


@pytest.mark.parametrize(("source", "destination"), CONVERTED)
def test_blits_convert(device: Device, tmp_path: Path, source: dict[str, Any], destination: dict[str, Any]) -> None:
    run = copied(device, tmp_path, source, destination, blit=True)
    assert judge_run("copy", run).above == ()
    assert judge_run("copy", one_step(run, "destination")).above == ("destination",)


@pytest.mark.parametrize("size", [[31, 57], [48, 32], [12, 8], [1, 1]])
def test_blits_interpolate(device: Device, tmp_path: Path, size: list[int]) -> None:
    run = copied(device, tmp_path, {"format": "rgba8"}, {"format": "rgba8", "fixed": size}, blit=True, linear=True)
    assert judge_run("copy", run).above == ()
    shifted = np.roll(np.asarray(run.outputs["destination"]), 1, axis=1)
    if size != [1, 1]:
        assert judge_run("copy", replace(run, outputs={"destination": shifted})).above == ("destination",)


def test_mip_levels_are_means_of_four(device: Device, tmp_path: Path) -> None:
    run = copied(device, tmp_path, {"format": "rgba8"}, {"format": "rgba8", "mips": 0}, mips=True)
    assert len(run.levels["destination"]) == 4
    assert judge_run("copy", run).above == ()
    levels = [np.array(level) for level in run.levels["destination"]]
    levels[1] += 3 / 255
    assert judge_run("copy", replace(run, levels={"destination": tuple(levels)})).above == ("destination",)


def test_infinities_and_nan_are_bits_too(device: Device, tmp_path: Path) -> None:
    run = copied(device, tmp_path, {"format": "rgba32f"}, {"format": "rgba32f"}, path="host")
    special = np.array(run.inputs["source"])
    special[0, 0], special[0, 1] = np.nan, np.inf
    same = replace(run, inputs={"source": special}, outputs={"destination": special})
    assert judge_run("copy", same).above == ()
    assert judge_run("copy", replace(run, inputs={"source": special})).above == ("destination",)


def test_bits_read_by_hand() -> None:
    one = np.array([[[1.0, 0.0, 0.0, 1.0]]])
    value, known = reinterpret(one, "rgba8", "r32f")  # 0xff0000ff
    assert value.item() == np.array([0xFF0000FF], np.uint32).view(np.float32).item()
    assert known.all()
    value, _ = reinterpret(np.array([[[0.5, -2.0]]]), "rg16f", "rg16")
    assert (value * 65535).ravel().tolist() == pytest.approx([0x3800, 0xC000])
    value, known = reinterpret(np.array([[[-1.0, 0.0]], [[1.0, 1.0]]]), "rg8_snorm", "rg8")
    assert known.ravel().tolist() == [False, True]
    assert (value[1] * 255).ravel().tolist() == pytest.approx([127, 127])


# ---------------------------------------------------------------- clear


def cleared(
    device: Device, folder: Path, target: dict[str, Any], value: Any, stencil: int = 0, **frame: Any
) -> PassRun:
    graph = {
        "rendergraph": 1,
        "frame": frame,
        "resources": {"target": target},
        "passes": {
            "clear": {
                "node": "clear", "write": {"target": "target"}, "set": {"value": value, "stencil": stencil},
                "keep": True,
            },
            "shown": {"node": "clear", "write": {"target": "image"}},
        },
        "outputs": {"image": {"file": "image.png"}},
    }  # fmt: skip
    (folder / "graph.yaml").write_text(yaml.safe_dump(graph, sort_keys=False))
    return passes_of(device, str(folder / "graph.yaml"), "clear", "frame.size=[24, 16]")["clear"]


COLOURS = [
    "rgba8", "rgba8_snorm", "srgb8_a8", "rgb10_a2", "r11g11b10f", "rgba16", "rgba16f", "rgba32f", "rg8",
]  # fmt: skip


@pytest.mark.parametrize("format", COLOURS)
def test_colours_are_cleared(device: Device, tmp_path: Path, format: str) -> None:
    run = cleared(device, tmp_path, {"format": format, "mips": 3}, [0.2, 0.5, 0.7, 0.9])
    assert judge_run("clear", run).above == ()
    assert judge_run("clear", one_step(run, "target")).above == ("target",)
    levels = [np.array(level) for level in run.levels["target"]]
    levels[-1][0, 0, 0] = 0.0
    assert judge_run("clear", replace(run, levels={"target": tuple(levels)})).above == ("target",)


@pytest.mark.parametrize("depth", ["reversed", "standard"])
@pytest.mark.parametrize("format", ["d16", "d24", "d24s8", "d32f", "d32fs8"])
def test_depth_and_stencil_are_cleared(device: Device, tmp_path: Path, format: str, depth: str) -> None:
    run = cleared(device, tmp_path, {"format": format}, 0.3, stencil=5 if "s8" in format else 0, depth=depth)
    assert judge_run("clear", run).above == ()
    assert judge_run("clear", one_step(run, "target")).above == ("target",)
    if "s8" in format:
        other = {"target": run.stencils["target"] + 1}
        assert judge_run("clear", replace(run, stencils=other)).above == ("target",)


@pytest.mark.parametrize(("target", "value"), [
    ({"format": "r8ui"}, 200), ({"format": "rgba32i"}, -7), ({"format": "rgba32ui"}, 3000000000),
    ({"bytes": 64}, 4294967295), ({"format": "rgba8", "samples": 4}, 0.4), ({"format": "rgba16f", "layers": 3}, 0.25),
])  # fmt: skip
def test_whole_numbers_words_samples_and_layers(
    device: Device, tmp_path: Path, target: dict[str, Any], value: float
) -> None:
    run = cleared(device, tmp_path, target, value)
    assert judge_run("clear", run).above == ()
    bad = np.array(run.outputs["target"])
    bad.reshape(-1)[3] -= 1
    assert judge_run("clear", replace(run, outputs={"target": bad})).above == ("target",)
