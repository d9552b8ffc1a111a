"""Runs of draw commands as a camera needs them: what one multi-draw draws, and with which state."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rendergraph.scene.draw_queues import DrawRun
from rendergraph.scene.texture_arrays import NO_ARRAY

#: By queue and number of replays.
Batches = Mapping[tuple[str, int], "tuple[Batch, ...]"]


@dataclass(frozen=True, slots=True)
class Batch:
    """A run of draw commands of one state: first command and count, within one camera's commands, and the triangles
    (replays included) they draw. ``textures``: slot of ``Material.textures`` and name of the texture array it needs.
    """

    first: int
    count: int
    double_sided: bool
    mirrored: bool
    textures: tuple[tuple[int, int], ...]
    triangles: int


def cut_batches(
    queues: Mapping[str, Sequence[DrawRun]], replays: Iterable[int], textures: Sequence[int]
) -> tuple[Batches, bytes]:
    """The batches of one camera's queues for every number of replays, and their commands, one after another.

    ``textures`` names the texture object of each array.
    """
    batches: dict[tuple[str, int], tuple[Batch, ...]] = {}
    parts: list[bytes] = []
    first = 0
    for replay in sorted(replays):
        for queue, runs in queues.items():
            cut = []
            for run in runs:
                commands = run.commands.copy()
                commands["instance_count"] *= replay
                indices = commands["count"].astype(np.int64) * commands["instance_count"]
                slots = tuple((slot, textures[array]) for slot, array in enumerate(run.arrays) if array != NO_ARRAY)
                triangles = int(indices.sum()) // 3
                cut.append(Batch(first, len(commands), run.double_sided, run.mirrored, slots, triangles))
                parts.append(commands.tobytes())
                first += len(commands)
            batches[queue, replay] = tuple(cut)
    return batches, b"".join(parts)
