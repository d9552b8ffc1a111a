"""Front faces under mirroring transforms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rendergraph.scene.scene import Scene


def unmirror_winding(scene: Scene) -> None:
    """Make front faces counter-clockwise in the world for every instance, in place.

    A transform with a negative determinant turns the winding around. An instance under one is given a copy of its
    mesh's triangles wound the other way (one copy a mesh, sharing the vertices), so that no draw has to switch
    ``glFrontFace`` and ``gl_FrontFacing`` is always right.
    """
    reversed_meshes: dict[int, int] = {}
    added = [scene.indices]
    total = len(scene.indices)
    for index, instance in enumerate(scene.instances):
        if np.linalg.det(instance.world[:3, :3]) >= 0:
            continue
        if instance.mesh not in reversed_meshes:
            mesh = scene.meshes[instance.mesh]
            run = scene.indices[mesh.first_index : mesh.first_index + mesh.index_count]
            added.append(run.reshape(-1, 3)[:, ::-1].reshape(-1))
            reversed_meshes[instance.mesh] = len(scene.meshes)
            scene.meshes.append(replace(mesh, first_index=total))
            total += mesh.index_count
        scene.instances[index] = replace(instance, mesh=reversed_meshes[instance.mesh])
    if len(added) > 1:
        scene.indices = np.concatenate(added)
