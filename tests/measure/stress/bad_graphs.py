"""Graphs with one mistake each that only an extreme shows, and their healthy twins."""

from __future__ import annotations

from pathlib import Path

HEAD = "#version 450\n"

#: By name: the bad shader, and the same without the mistake. Each is one full-screen pass, `test`, into rgba16f.
PAIRS = {
    # Divides by zero in a frame one texel wide.
    "width_minus_one": (
        "out vec4 color; uniform vec2 u_size;\n"
        "void main() { float x = gl_FragCoord.x - 0.5; color = vec4(x / (u_size.x - 1.0), 0, 0, 1); }\n",
        "out vec4 color; uniform vec2 u_size;\n"
        "void main() { float x = gl_FragCoord.x - 0.5; color = vec4(x / max(u_size.x - 1.0, 1.0), 0, 0, 1); }\n",
    ),
    # Normalises a vector that is zero in the middle texel of frames of odd size.
    "zero_vector": (
        "out vec4 color; uniform vec2 u_size;\n"
        "void main() { vec2 d = gl_FragCoord.xy - 0.5 * u_size; color = vec4(d / sqrt(dot(d, d)), 0, 1); }\n",
        "out vec4 color; uniform vec2 u_size;\n"
        "void main() { vec2 d = gl_FragCoord.xy - 0.5 * u_size; color = vec4(d / max(length(d), 1e-5), 0, 1); }\n",
    ),
    # Leaves floats, and with them half floats, from the 1000th column on (a driver may let half floats saturate).
    "overflow": (
        "out vec4 color;\n"
        "void main() { float x = gl_FragCoord.x - 0.5; color = vec4(x < 1000 ? x : x * 1e36, 0, 0, 1); }\n",
        "out vec4 color;\nvoid main() { float x = gl_FragCoord.x - 0.5; color = vec4(min(x, 1000), 0, 0, 1); }\n",
    ),
}

#: Reads its input, and lets through what is not finite.
READS = (
    "uniform sampler2D u_in; out vec4 color;\n"
    "void main() { color = 2.0 * texelFetch(u_in, ivec2(gl_FragCoord.xy), 0); }\n",
    "uniform sampler2D u_in; out vec4 color;\n"
    "void main() { vec4 c = texelFetch(u_in, ivec2(gl_FragCoord.xy), 0);\n"
    "  bvec4 bad = bvec4(uvec4(greaterThanEqual(floatBitsToUint(c) & 0x7fffffffu, uvec4(0x7f800000u))));\n"
    "  color = 2.0 * vec4(bad.x ? 0.0 : c.x, bad.y ? 0.0 : c.y, bad.z ? 0.0 : c.z, bad.w ? 0.0 : c.w); }\n",
)

_ONE = """\
rendergraph: 1
title: {name}
frame: {{size: [16, 8]}}
resources: {{image: {{format: rgba16f}}}}
passes:
  test: {{node: fullscreen, write: {{color: image}}, set: {{shader: {name}.frag}}}}
outputs: {{image: {{file: image.npy}}}}
"""

_TWO = """\
rendergraph: 1
title: {name}
frame: {{size: [16, 8]}}
resources: {{first: {{format: rgba16f}}, image: {{format: rgba16f}}}}
passes:
  source: {{node: fullscreen, write: {{color: first}}, set: {{shader: plain.frag}}}}
  test: {{node: fullscreen, read: {{u_in: first}}, write: {{color: image}}, set: {{shader: {name}.frag}}}}
outputs: {{image: {{file: image.npy}}}}
"""

_PLAIN = "out vec4 color;\nvoid main() { color = vec4(0.25, 0.5, 0.75, 1.0); }\n"


def write_pair(folder: Path, name: str) -> tuple[Path, Path]:
    """The bad graph and its healthy twin, as files."""
    return write_one(folder, name, PAIRS[name][0]), write_one(folder, f"{name}_healthy", PAIRS[name][1])


def write_one(folder: Path, name: str, shader: str) -> Path:
    """A graph of one full-screen pass, whose `u_size` is its frame's size."""
    sized = shader.replace("uniform vec2 u_size;", "#include <frame.glsl>").replace("u_size", "frame.viewport.xy")
    (folder / f"{name}.frag").write_text(_included(sized))
    return _graph(folder, name, _ONE)


def write_reader(folder: Path, name: str, shader: str) -> Path:
    """A graph of two passes: one that is healthy, and one that reads it."""
    (folder / "plain.frag").write_text(HEAD + _PLAIN)
    (folder / f"{name}.frag").write_text(HEAD + shader)
    return _graph(folder, name, _TWO)


def _included(shader: str) -> str:
    """The include on a line of its own, before everything else."""
    line = "#include <frame.glsl>"
    return HEAD + (line + "\n" + shader.replace(line, "") if line in shader else shader)


def _graph(folder: Path, name: str, text: str) -> Path:
    file = folder / f"{name}.yaml"
    file.write_text(text.format(name=name))
    return file
