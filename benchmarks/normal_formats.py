"""Angle between a unit vector and what each G-buffer format holds of it: docs/normal_formats.md.

Two ways, independent of one another: the packing of nodes/gbuffer/reference.py in float64 with exact rounding (and, for
half floats, truncation, which OpenGL allows), over a million random directions and those where packings break; and the
shader's own packing on this machine's renderer, over a spiral of 1024 x 1024 directions, written to a texture of the
format and read back.

    python -m benchmarks.normal_formats [--directions N] [--out docs/normal_formats.md] [--no-gpu]
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt

from rendergraph.document.formats import FORMATS, Channel
from rendergraph.document.load import load_document
from rendergraph.nodes.gbuffer import reference
from rendergraph.nodes.gbuffer.packing import NORMAL_FORMATS, normal_defines

F64 = npt.NDArray[np.float64]

_PACK = """\
#version 450
#include <packing.glsl>
layout(location = 0) out vec4 out_direction;
layout(location = 1) out vec4 out_packed;
void main() {
    uint index = uint(gl_FragCoord.y) * 1024u + uint(gl_FragCoord.x);
    float z = 1.0 - 2.0 * (float(index) + 0.5) / 1048576.0;
    float angle = float(index) * 2.399963;
    vec3 n = normalize(vec3(sqrt(1.0 - z * z) * vec2(cos(angle), sin(angle)), z));
    out_direction = vec4(n, 0.0);
    out_packed = pack_normal(n);
}
"""
_GRAPH = """\
rendergraph: 1
frame: {{size: [1024, 1024]}}
resources: {{direction: {{format: rgba32f}}, packed: {{format: {format}}}}}
passes:
  pack:
    node: fullscreen
    write: {{direction: direction, packed: packed}}
    set: {{shader: pack.frag, defines: {defines}}}
outputs: {{packed: {{file: packed.npy}}, direction: {{file: direction.npy}}}}
"""


def quantised(stored: F64, format: str, *, truncate: bool = False) -> F64:
    """Values as a texture of the format gives them back: float64, -1..1 for signed channels, 0..1 for unsigned ones."""
    row = FORMATS[format]
    if row.channel is Channel.FLOAT:
        narrow = np.float16 if row.texel_bytes // row.channels == 2 else np.float32
        rounded = stored.astype(narrow)
        if truncate:
            away = np.abs(rounded.astype(np.float64)) > np.abs(stored)
            rounded = np.where(away, np.nextafter(rounded, narrow(0)), rounded)
        return rounded.astype(np.float64)
    bits = 10 if format == "rgb10_a2" else 8 * row.texel_bytes // row.channels
    top = 2.0 ** (bits - 1) - 1.0 if row.channel is Channel.SNORM else 2.0**bits - 1.0
    return np.asarray(np.round((stored if row.channel is Channel.SNORM else stored * 0.5 + 0.5) * top) / top)


def exact_errors(directions: F64, format: str, *, truncate: bool = False) -> F64:
    """Degrees for each of the directions float64[n, 3]."""
    stored = reference.octahedral_encode(directions) if FORMATS[format].channels == 2 else directions
    read = reference.unpack_normals(quantised(stored, format, truncate=truncate), format)
    return reference.angle_degrees(directions, read)


def measured_errors(format: str, folder: Path) -> tuple[F64, str]:
    """Degrees for each direction of the spiral, by the shader's packing, and the renderer's name."""
    from rendergraph.measure.truth.decode import decode
    from rendergraph.run.render import RenderOptions, render_document

    (folder / "pack.frag").write_text(_PACK)
    defines = "{" + ", ".join(f"{name}: {value}" for name, value in normal_defines(format).items()) + "}"
    (folder / "graph.yaml").write_text(_GRAPH.format(format=format, defines=defines))
    result = render_document(load_document(folder / "graph.yaml"), RenderOptions(samples=0))
    channels = FORMATS[format].channels
    stored = decode(result.images["packed"], format).reshape(-1, channels)
    directions = result.images["direction"][..., :3].reshape(-1, 3).astype(np.float64)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return reference.angle_degrees(directions, reference.unpack_normals(stored, format)), result.device.renderer


def table(count: int, gpu: bool) -> str:
    """The whole page."""
    directions = reference.sphere(count)
    lines, renderer = [], ""
    for format in NORMAL_FORMATS:
        row = FORMATS[format]
        exact = exact_errors(directions, format)
        half = row.channel is Channel.FLOAT and row.texel_bytes // row.channels == 2
        truncated = f"{exact_errors(directions, format, truncate=True).max():.3g}" if half else ""
        found = "-"
        if gpu:
            with tempfile.TemporaryDirectory() as folder:
                errors, renderer = measured_errors(format, Path(folder))
            found = f"{errors.max():.3g}"
        packing = "octahedral" if row.channels == 2 else "xyz"
        p99 = float(np.quantile(exact, 0.99))
        lines.append(
            f"| `{format}` | {row.texel_bytes} | {packing} | {exact.max():.3g} | {p99:.3g} | {exact.mean():.3g} "
            f"| {truncated} | {found} |"
        )
    told = f"by the shader on {renderer}, over a spiral of 1,048,576 directions" if renderer else "not measured here"
    return (
        "# Normals: what each format loses\n\n"
        "Angle in degrees between a unit vector and what a G-buffer's normal target holds of it. Made by\n"
        "`python -m benchmarks.normal_formats`; the node states the largest of them as its tolerance\n"
        "(`nodes/gbuffer/packing.py`).\n\n"
        f"Exact: the packing in float64, rounded to nearest, over {len(directions):,} directions, axes, diagonals and\n"
        "poles included. Truncated: half floats cut off instead of rounded, which OpenGL allows. Measured: largest,\n"
        f"{told}.\n\n"
        "| Format | Bytes | Packing | Largest | 99 % below | Mean | Largest, truncated | Measured |\n"
        "|---|---|---|---|---|---|---|---|\n" + "\n".join(lines) + "\n\n"
        "Of equal bytes, octahedral beats xyz by far: `rg16_snorm` is 26 times as fine as `rgb10_a2`. Signed formats\n"
        "hold zero, and with it the directions of the axes, exactly; unsigned ones miss it by half a code.\n"
    )


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--directions", type=int, default=1_000_000)
    parser.add_argument("--out", type=Path, default=Path("docs/normal_formats.md"))
    parser.add_argument("--no-gpu", action="store_true")
    options = parser.parse_args()
    options.out.write_text(table(options.directions, not options.no_gpu))


if __name__ == "__main__":
    main()
