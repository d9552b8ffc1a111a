"""How errors grow with distance, scale, distance from the origin, and format: docs/precision.md.

Every figure is of frames that were rendered, held against float64.

    python -m benchmarks.precision > docs/precision.md
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from unittest import mock

import numpy as np

from rendergraph.device.context import Device, open_device
from rendergraph.document.load import Document, load_document
from rendergraph.measure.stress.scenes import moved, scaled
from rendergraph.measure.truth.judge import judge_pass
from rendergraph.measure.truth.observe import observe
from rendergraph.node.discovery import find_node
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import plan_document, plan_for_scene
from rendergraph.scene.cameras import projection_matrix
from rendergraph.scene.floating_origin import ORIGIN
from rendergraph.scene.load import LoadedScene
from rendergraph.scene.procedural.geometry import surface
from rendergraph.scene.procedural.mesh_builder import SceneBuilder
from rendergraph.scene.scene import F64, Camera, Material

WIDTH, HEIGHT = 144, 64
#: Nearest point of each panel, metres: one every half decade.
DISTANCES: Final = tuple(10.0 ** (k / 2.0) for k in range(-1, 11))
#: How much farther a panel's upper edge is than its lower one.
LEAN: Final = 0.3
NEAR: Final = 0.1
FAR: Final = 1e6
FORMATS: Final = ("d16", "d24", "d32f")

GRAPH: Final = """\
rendergraph: 1
frame: {{size: [{width}, {height}], depth: {convention}}}
scene: {{source: spheres, detail: 0}}
resources:
  depth: {{format: {format}}}
  normal: {{format: rg16_snorm}}
  base_color: {{format: rgba8}}
  material: {{format: rgb10_a2}}
passes:
  gbuffer:
    node: gbuffer
    write: {{depth: depth, normal: normal, base_color: base_color, material: material}}
outputs: {{normal: {{file: normal.npy}}, depth: {{file: depth.npy}}}}
"""


@dataclass(frozen=True, slots=True)
class Panels:
    """Leaning panels side by side, each at a distance of its own and as high as the frame: a scene, and the view depth
    of every pixel of it in float64, metres.
    """

    scene: LoadedScene
    view_depth: F64  # [h, w]

    def columns(self, index: int) -> slice:
        """Pixels of a panel, without those at its edges."""
        width = WIDTH // len(DISTANCES)
        return slice(index * width + 1, (index + 1) * width - 1)


def panels(far: float | None) -> Panels:
    """A panel's lower edge is ``d`` metres away, its upper one ``d (1 + LEAN)``, on the frame's lower and upper edge.

    A ray (x, y) t of the frame meets the plane through both at ``d (2 + 2 LEAN) / (2 + LEAN (1 - y))``, y in -1..1.
    """
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), near=NEAR, far=far)
    tangent = np.tan(camera.fov / 2.0)
    builder = SceneBuilder("panels")
    material = builder.material(Material("grey", (0.5, 0.5, 0.5, 1.0)))
    edges = np.linspace(-1.0, 1.0, len(DISTANCES) + 1) * WIDTH / HEIGHT
    for index, near in enumerate(DISTANCES):
        rows = [
            [(x * tangent * z, y * tangent * z, -z) for x in edges[index : index + 2]]
            for y, z in ((-1.0, near), (1.0, near * (1.0 + LEAN)))
        ]
        uv = np.array([[(0.0, 0.0), (1.0, 0.0)], [(0.0, -1.0), (1.0, -1.0)]])
        builder.place(builder.mesh(surface(np.array(rows), uv), material))
    y = (np.arange(HEIGHT) + 0.5) / HEIGHT * 2.0 - 1.0
    truth = (
        np.repeat(DISTANCES, WIDTH // len(DISTANCES))[None, :] * (2.0 + 2.0 * LEAN) / (2.0 + LEAN * (1.0 - y[:, None]))
    )
    return Panels(LoadedScene(builder.build(), camera), truth)


def written(format: str = "d32f", convention: str = "reversed") -> Document:
    """A G-buffer's graph."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "panels.yaml"
        file.write_text(GRAPH.format(width=WIDTH, height=HEIGHT, format=format, convention=convention))
        return load_document(file)


def depth_errors(
    device: Device, document: Document, panels: Panels, scene: LoadedScene, unit: float = 1.0
) -> list[float]:
    """Largest relative error of view depth on each panel, from what the depth buffer holds; NaN where it holds nothing.

    ``scene`` is that of the panels, moved or ``unit`` times as large.
    """
    planned = plan_for_scene(document, scene, PlanOptions())
    stored = observe(document, planned, device, ["gbuffer"])["gbuffer"].outputs["depth"].astype(np.float64)[..., 0]
    p = projection_matrix(scene.camera, WIDTH / HEIGHT, document.model.frame.depth == "reversed")
    with np.errstate(divide="ignore"):
        depth = p[2, 3] / (stored + p[2, 2]) / unit
    errors = np.abs(depth / panels.view_depth - 1.0)
    found = []
    for index in range(len(DISTANCES)):
        part = errors[:, panels.columns(index)]
        found.append(float(part.max()) if np.isfinite(part).all() else float("nan"))
    return found


@contextmanager
def without_floating_origin() -> Iterator[None]:
    """As if positions on the device were the world's."""
    with mock.patch("rendergraph.run.runner.device_origin", return_value=ORIGIN):
        yield


def metres(value: float) -> str:
    """A distance with its unit."""
    return f"{value:.3g} m" if value < 1000.0 else f"{round(value / 1000.0, 1):g} km"


def shown(value: float) -> str:
    """An error."""
    return "lost" if not np.isfinite(value) else f"{value:.1e}"


def row(*cells: str) -> None:
    """A line of a table."""
    print("| " + " | ".join(cells) + " |")


def table(*heads: str) -> None:
    """The head of a table."""
    row(*heads)
    print("|" + "---|" * len(heads))


def by_distance(device: Device) -> None:
    """Depth formats and conventions over six decades of distance."""
    for far, name in ((None, "an infinite far plane"), (FAR, "a far plane at 1000 km")):
        print(f"\nWith the near plane at {metres(NEAR)} and {name}:\n")
        made = panels(far)
        kinds = [(c, f) for c in ("reversed", "standard") for f in FORMATS]
        table("distance", *(f"{c} {f}" for c, f in kinds))
        columns = [depth_errors(device, written(f, c), made, made.scene) for c, f in kinds]
        for index, distance in enumerate(DISTANCES):
            row(metres(distance), *(shown(column[index]) for column in columns))


def by_offset(device: Device) -> None:
    """The scene moved away from the origin."""
    made, document = panels(None), written()
    table("from the origin", "as it is", "without the floating origin")
    for offset in (0.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7):
        away = moved(made.scene, metres=offset)
        here = depth_errors(device, document, made, away)
        with without_floating_origin():
            there = depth_errors(device, document, made, away)
        row(metres(offset), *(shown(np.nanmax(e) if not np.isnan(e).all() else np.nan) for e in (here, there)))


def by_scale(device: Device) -> None:
    """The scene, its camera and its planes made smaller and larger."""
    made, document = panels(None), written()
    table("scale", "largest relative error of view depth")
    for power in range(-4, 6):
        errors = depth_errors(device, document, made, scaled(made.scene, factor=10.0**power), 10.0**power)
        row(f"1e{power}", shown(max(errors)))


def judged(device: Device, graph: str, name: str, measure: str, overrides: tuple[str, ...]) -> dict[str, float | None]:
    """All metrics of a measure of a pass of a shipped graph, at 192 x 108."""
    document = load_document(graph, ("scene.detail=0", "frame.size=[192, 108]", *overrides))
    planned = plan_document(document, PlanOptions())
    run = observe(document, planned, device, [name])[name]
    found = judge_pass(name, find_node(document.model.passes[name].node), run, flip=False)
    return dict(next(j for j in found if j.measure == measure).metrics)


def by_normal_format(device: Device) -> None:
    """Shading normals as the G-buffer keeps them, in degrees."""
    table("format", "bits", "mean", "99th percentile", "largest")
    spheres = ("scene.source=spheres",)
    for format, bits in (("rg8", 16), ("rgb10_a2", 32), ("rg16_snorm", 32), ("rgba16f", 64), ("rgba32f", 128)):
        m = judged(device, "gbuffer", "gbuffer", "normal", (*spheres, f"resources.normal.format={format}"))
        row(format, str(bits), *(f"{m[key]:.2g}" for key in ("mean", "p99", "max")))


def by_radiance_format(device: Device) -> None:
    """Lit images against the same light in float64, by the target's format."""
    table("target", "bits", "relative MSE", "RMSE", "largest error")
    linear = ("resources.base_color.format=rgba16f",)  # no sRGB decoding, whose error would hide the target's
    for format, bits in (("r11g11b10f", 32), ("rgba16f", 64), ("rgba32f", 128)):
        m = judged(device, "deferred_lighting", "light", "color", (*linear, f"resources.hdr.format={format}"))
        row(format, str(bits), *(f"{m[key]:.1e}" for key in ("rel_mse", "rmse", "max")))


def main() -> None:
    """Print the page."""
    device = open_device()
    print(f"""# Precision

How far off float32 and the formats are, measured on {device.info.renderer} by
`python -m benchmarks.precision`: frames are rendered and held against float64. `rg stress` checks it at extremes.

## Depth, by distance and format

Largest relative error of the view distance that the depth buffer stands for, on panels that lean away from the camera;
`lost` where the buffer holds no more than the far plane. The error in metres is the distance times it. Reversed floats
keep the same relative error at every distance, since their steps shrink as 1/z does; with 16 or 24 bits, or in standard
order, it grows with the distance over the near plane, and raising the near plane is what helps.""")
    by_distance(device)
    print("""
## Distance from the origin

The same panels, camera and all, moved along x and z; reversed d32f, largest relative error of all panels. Beyond 1024 m
the device's origin follows the camera (docs/conventions.md).
""")
    by_offset(device)
    print("""
## Scale

The same panels, the camera's planes with them, made smaller and larger; reversed d32f.
""")
    by_scale(device)
    print("""
## Normals, by format

Degrees between the stored normal and the true one, on the spheres; `docs/normal_formats.md` has every format.
""")
    by_normal_format(device)
    print("""
## Radiance, by format

`deferred_lighting` against the same light in float64, from the same G-buffer with a base colour of half floats. Floats
of 11 and 10 bits have steps of 1/64 and 1/32 of their value, half floats of 1/1024.
""")
    by_radiance_format(device)


if __name__ == "__main__":
    main()
