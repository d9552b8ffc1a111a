"""The scene as indirect draw commands, sorted into queues."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby

import numpy as np
import numpy.typing as npt

from rendergraph.scene.scene import F64, Alpha, Scene

#: ``DrawElementsIndirectCommand`` (GL 4.5, 10.4), 20 bytes. ``base_instance`` is the index into ``Instances``.
DRAW_COMMAND = np.dtype(
    [
        ("count", np.uint32),
        ("instance_count", np.uint32),
        ("first_index", np.uint32),
        ("base_vertex", np.int32),
        ("base_instance", np.uint32),
    ]
)

Commands = npt.NDArray[np.void]

QUEUES = ("opaque", "masked", "blended")
#: The keys of :func:`draw_queues`: each queue, single-sided (back faces culled) then double-sided (not culled).
QUEUE_KEYS = tuple(f"{queue}{side}" for queue in QUEUES for side in ("", "_double_sided"))


def draw_queues(scene: Scene, eye: tuple[float, float, float]) -> dict[str, Commands]:
    """``DRAW_COMMAND[n]`` for each of ``QUEUE_KEYS`` (possibly empty), one command an instance.

    ``opaque`` and ``masked`` run front to back by the distance from ``eye`` (world space) to the centre of the
    instance's bounds, ``blended`` back to front; equal distances keep the order of ``Scene.instances``.
    """
    distances = _distances(scene, np.asarray(eye, dtype=np.float64))
    members: dict[str, list[int]] = {key: [] for key in QUEUE_KEYS}
    for index, instance in enumerate(scene.instances):
        mesh = scene.meshes[instance.mesh]
        material = scene.materials[mesh.material]
        if mesh.index_count:
            members[QUEUES[material.alpha] + ("_double_sided" if material.double_sided else "")].append(index)
    return {key: _commands(scene, _sorted(key, indices, distances)) for key, indices in members.items()}


def _sorted(key: str, indices: list[int], distances: F64) -> list[int]:
    sign = -1.0 if key.startswith(QUEUES[Alpha.BLENDED]) else 1.0
    return sorted(indices, key=lambda index: sign * float(distances[index]))


def _distances(scene: Scene, eye: F64) -> F64:
    if not scene.instances:
        return np.zeros(0)
    meshes = [scene.meshes[i.mesh] for i in scene.instances]
    low = np.array([m.bounds_min for m in meshes], dtype=np.float64)
    high = np.array([m.bounds_max for m in meshes], dtype=np.float64)
    worlds = np.stack([i.world for i in scene.instances])
    centres = np.einsum("nij,nj->ni", worlds[:, :3, :3], (low + high) / 2) + worlds[:, :3, 3]
    distances: F64 = np.linalg.norm(centres - eye, axis=1)
    return distances


def _commands(scene: Scene, indices: list[int]) -> Commands:
    commands = np.zeros(len(indices), dtype=DRAW_COMMAND)
    for row, index in enumerate(indices):
        mesh = scene.meshes[scene.instances[index].mesh]
        commands[row] = (mesh.index_count, 1, mesh.first_index, mesh.base_vertex, index)
    return commands


@dataclass(frozen=True, slots=True)
class DrawRun:
    """Consecutive commands of a queue that one state serves: with or without culling, and which way triangles wind."""

    commands: Commands  # DRAW_COMMAND[n]
    double_sided: bool
    mirrored: bool


def draw_runs(scene: Scene, eye: tuple[float, float, float]) -> dict[str, list[DrawRun]]:
    """Each of ``QUEUES`` as runs to draw one after another.

    ``opaque`` and ``masked`` are grouped by state, front to back inside a group; ``blended`` keeps its back-to-front
    order by ``eye`` (world space) whatever the state, so neighbours of equal state form its runs.
    """
    distances = _distances(scene, np.asarray(eye, dtype=np.float64))
    members: dict[str, list[int]] = {queue: [] for queue in QUEUES}
    state: dict[int, tuple[bool, bool]] = {}
    for index, instance in enumerate(scene.instances):
        mesh = scene.meshes[instance.mesh]
        if mesh.index_count:
            material = scene.materials[mesh.material]
            members[QUEUES[material.alpha]].append(index)
            state[index] = material.double_sided, bool(np.linalg.det(instance.world[:3, :3]) < 0)
    runs: dict[str, list[DrawRun]] = {}
    for queue, indices in members.items():
        ordered = _sorted(queue, indices, distances)
        if queue != QUEUES[Alpha.BLENDED]:
            ordered.sort(key=state.__getitem__)
        runs[queue] = [
            DrawRun(_commands(scene, list(group)), *key) for key, group in groupby(ordered, key=state.__getitem__)
        ]
    return runs
