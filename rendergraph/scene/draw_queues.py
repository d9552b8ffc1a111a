"""The scene as indirect draw commands, sorted into queues and cut into runs of equal state."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from itertools import groupby

import numpy as np
import numpy.typing as npt

from rendergraph.scene.scene import F64, Alpha, Scene
from rendergraph.scene.texture_arrays import TexturePlacement

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

#: By ``Alpha``.
QUEUES = ("opaque", "masked", "blended")


@dataclass(frozen=True, slots=True)
class DrawRun:
    """Consecutive commands of a queue that one state serves: with or without culling, which way triangles wind, and the
    texture array of each slot of ``Material.textures``.
    """

    commands: Commands  # DRAW_COMMAND[n]
    double_sided: bool
    mirrored: bool
    arrays: tuple[int, ...]


def draw_runs(scene: Scene, eye: tuple[float, float, float], placement: TexturePlacement) -> dict[str, list[DrawRun]]:
    """Each of ``QUEUES`` as runs to draw one after another, one command an instance.

    ``opaque`` and ``masked`` are grouped by state. Groups follow one another by their nearest instance and run front to
    back, by the distance from ``eye`` (world space) to the centre of the instance's bounds. ``blended`` keeps its
    back-to-front order whatever the state, so neighbours of equal state form its runs. Equal distances keep the order
    of ``Scene.instances``.
    """
    distances, mirrored = _placements(scene, np.asarray(eye, dtype=np.float64))
    members: dict[str, list[int]] = {queue: [] for queue in QUEUES}
    arrays = [placement.arrays_of(material) for material in scene.materials]
    state: dict[int, tuple[bool, bool, tuple[int, ...]]] = {}
    for index, instance in enumerate(scene.instances):
        mesh = scene.meshes[instance.mesh]
        if mesh.index_count:
            material = scene.materials[mesh.material]
            members[QUEUES[material.alpha]].append(index)
            state[index] = material.double_sided, bool(mirrored[index]), arrays[mesh.material]
    runs: dict[str, list[DrawRun]] = {}
    for queue, indices in members.items():
        if queue == QUEUES[Alpha.BLENDED]:
            indices.sort(key=lambda index: -float(distances[index]))
        else:
            indices = _grouped(sorted(indices, key=lambda index: float(distances[index])), state)
        runs[queue] = [
            DrawRun(_commands(scene, list(group)), *key) for key, group in groupby(indices, key=state.__getitem__)
        ]
    return runs


def _grouped(indices: list[int], state: Mapping[int, Hashable]) -> list[int]:
    """Indices of equal state side by side, in the order of each state's first."""
    groups: dict[Hashable, list[int]] = {}
    for index in indices:
        groups.setdefault(state[index], []).append(index)
    return [index for group in groups.values() for index in group]


def _placements(scene: Scene, eye: F64) -> tuple[F64, npt.NDArray[np.bool_]]:
    """Of each instance: distance from the eye to the centre of its bounds, and whether its transform mirrors."""
    if not scene.instances:
        return np.zeros(0), np.zeros(0, dtype=bool)
    meshes = [scene.meshes[i.mesh] for i in scene.instances]
    low = np.array([m.bounds_min for m in meshes], dtype=np.float64)
    high = np.array([m.bounds_max for m in meshes], dtype=np.float64)
    worlds = np.stack([i.world for i in scene.instances])
    centres = np.einsum("nij,nj->ni", worlds[:, :3, :3], (low + high) / 2) + worlds[:, :3, 3]
    return np.linalg.norm(centres - eye, axis=1), np.linalg.det(worlds[:, :3, :3]) < 0


def _commands(scene: Scene, indices: list[int]) -> Commands:
    commands = np.zeros(len(indices), dtype=DRAW_COMMAND)
    for row, index in enumerate(indices):
        mesh = scene.meshes[scene.instances[index].mesh]
        commands[row] = (mesh.index_count, 1, mesh.first_index, mesh.base_vertex, index)
    return commands
