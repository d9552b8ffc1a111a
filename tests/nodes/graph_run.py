"""Builds one node without a graph, and runs small graphs made from a mapping and shader texts."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from rendergraph.document.load import load_document
from rendergraph.node.builder import Builder
from rendergraph.node.discovery import find_node
from rendergraph.plan.graph import BufferDesc, Frame, Resource, TextureDesc
from rendergraph.run.render import RenderOptions, render_document
from rendergraph.run.result import FrameResult
from rendergraph.scene.features import SceneFeatures

Desc = TextureDesc | BufferDesc

#: Radiance over 24 stops, a hash of the texel, and in the first row everything that is no plain positive number.
RADIANCE = """\
#version 450
out vec4 color;
void main() {
    uvec2 t = uvec2(gl_FragCoord.xy);
    uvec3 v = uvec3(t, 7u) * 1664525u + 1013904223u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
    vec3 radiance = exp2(vec3(v >> 8u) / 16777216.0 * 24.0 - 14.0);
    if (t.y == 0u) {
        uint special[6] = uint[](0x7fc00000u, 0x7f800000u, 0xff800000u, 0xbf800000u, 0u, 0x7f000000u);
        radiance = vec3(uintBitsToFloat(special[t.x % 6u]));
    }
    color = vec4(radiance, 1.0);
}
"""


def build_node(
    node: str,
    params: Mapping[str, Any],
    inputs: Mapping[str, Desc],
    outputs: Mapping[str, Desc],
    *,
    features: SceneFeatures | None = None,
    full: bool = False,
    frame: Frame | None = None,
) -> Builder:
    """A pass ``p`` of the node, built; resources are named ``in_<port>`` and ``out_<port>``."""
    found = find_node(node)
    b = Builder(
        "p", found.folder, Path(), frame or Frame(64, 64), features or SceneFeatures(), full,
        {port: Resource(f"in_{port}", desc) for port, desc in inputs.items()},
        {port: Resource(f"out_{port}", desc) for port, desc in outputs.items()},
    )  # fmt: skip
    found(found.params_type(**params)).build(b)
    return b


def run_graph(
    folder: Path, graph: Mapping[str, Any], shaders: Mapping[str, str], captures: tuple[str, ...] = (), **options: Any
) -> FrameResult:
    """Write the graph and its shaders into ``folder`` and render it."""
    for name, text in shaders.items():
        (folder / name).write_text(text)
    path = folder / "graph.yaml"
    path.write_text(yaml.safe_dump({"rendergraph": 1, **graph}, sort_keys=False))
    return render_document(load_document(path), RenderOptions(samples=0, captures=captures, **options))


def paint(resource: str, shader: str = "paint.frag", **settings: Any) -> dict[str, Any]:
    """A pass that fills a texture by a shader."""
    return {"node": "fullscreen", "write": {"color": resource}, "set": {"shader": shader, **settings}}
