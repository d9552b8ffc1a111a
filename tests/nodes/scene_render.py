"""Renders a scene made in the test, by a graph written in the test."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.expand import expand
from rendergraph.run.plan_document import PlannedDocument
from rendergraph.run.render import RenderOptions, run_plan
from rendergraph.run.result import FrameResult
from rendergraph.scene.load import LoadedScene
from rendergraph.scene.scene import Ambient, Camera, Image, Instance, Light, Material, Mesh, Scene, Sun
from rendergraph.scene.texture_arrays import place_textures

Vec3 = Sequence[float]


@dataclass(frozen=True)
class Quad:
    """A parallelogram: ``corner`` spanned by ``u`` and ``v``, counter-clockwise seen from ``u x v``."""

    corner: Vec3
    u: Vec3
    v: Vec3
    material: int = 0
    world: np.ndarray = field(default_factory=lambda: np.eye(4))


def quad_scene(
    quads: Sequence[Quad],
    materials: Sequence[Material],
    *,
    images: Sequence[Image] = (),
    lights: Sequence[Light] = (),
    sun: Sun | None = None,
    ambient: Ambient | None = None,
) -> Scene:
    """A scene of quads; texture coordinates run 0..1 along u and, downward as in glTF, against v."""
    positions, normals, tangents, uv, meshes, instances = [], [], [], [], [], []
    for index, quad in enumerate(quads):
        corner, u, v = (np.array(x, dtype=np.float64) for x in (quad.corner, quad.u, quad.v))
        corners = np.array([corner, corner + u, corner + u + v, corner + v])
        normal = np.cross(u, v) / np.linalg.norm(np.cross(u, v))
        positions.append(corners)
        normals.append(np.tile(normal, (4, 1)))
        tangents.append(np.tile([*(u / np.linalg.norm(u)), 1.0], (4, 1)))
        uv.append([[0, 1], [1, 1], [1, 0], [0, 0]])
        low, high = tuple(corners.min(0).tolist()), tuple(corners.max(0).tolist())
        meshes.append(Mesh(0, 6, 4 * index, quad.material, low, high))
        instances.append(Instance(index, quad.world))
    count = 4 * len(quads)
    coordinates = np.array(uv, dtype=np.float32).reshape(count, 2)
    return Scene(
        name="quads",
        positions=np.array(positions, dtype=np.float32).reshape(count, 3),
        normals=np.array(normals, dtype=np.float32).reshape(count, 3),
        tangents=np.array(tangents, dtype=np.float32).reshape(count, 4),
        uv0=coordinates,
        uv1=coordinates * 0.5,
        colors=np.ones((count, 4), dtype=np.float32),
        indices=np.array([0, 1, 2, 0, 2, 3], dtype=np.uint32),
        meshes=meshes,
        instances=instances,
        materials=list(materials),
        images=list(images),
        lights=list(lights),
        sun=sun,
        ambient=ambient,
    )


def render_scene(
    device: Device,
    folder: Path,
    text: str,
    scene: Scene,
    camera: Camera,
    *,
    captures: tuple[str, ...] = (),
    full: bool = False,
) -> FrameResult:
    """Run a graph (whose own ``scene:`` is only a placeholder) on ``scene`` seen by ``camera``."""
    path = folder / "graph.yaml"
    path.write_text(text)
    document = load_document(path)
    features = replace(scene.features(), texture_arrays=len(place_textures(scene).arrays))
    graph, _ = expand(document, features=features, full=full)
    plan, _ = compile_plan(graph)
    planned = PlannedDocument(plan, LoadedScene(scene, camera), (), 0, 0)
    options = RenderOptions(samples=1, captures=captures, full=full)
    return run_plan(planned, document, device, options, lambda stage, done, total: None)
