"""What of a scene on the device no change touches: its vertices, and the textures and materials of what is drawn.

Runs of one scene, and the plans of a scene that changes, share them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.device.buffers import Buffer, create_buffer
from rendergraph.device.context import Device
from rendergraph.device.textures import Texture, create_texture, upload_texture
from rendergraph.plan.graph import Target, TextureDesc
from rendergraph.scene.gpu_layout import TexturePlacement, pack_materials, place_textures
from rendergraph.scene.scene import Scene

#: Drawing an empty scene is legal and draws nothing, but GL wants every buffer to have at least one byte.
PAD = np.zeros(16, dtype=np.uint32)


class SceneStore:
    """``positions`` float32[n, 3] and ``attributes`` (vertex_inputs.py) by vertex, and ``indices`` uint32[m]."""

    def __init__(self, device: Device, scene: Scene) -> None:
        self._device = device
        attributes = np.concatenate([scene.normals, scene.tangents, scene.uv0, scene.uv1, scene.colors], axis=1)
        self.positions = create_buffer(device, _bytes(scene.positions), "scene positions")
        self.attributes = create_buffer(device, _bytes(attributes.astype(np.float32)), "scene attributes")
        self.indices = create_buffer(device, _bytes(scene.indices), "scene indices")
        self._materials: dict[tuple[tuple[int, tuple[int, int]], ...], tuple[list[Texture], Buffer]] = {}
        self.materials(scene)

    def materials(self, scene: Scene) -> tuple[list[Texture], Buffer]:
        """``u_textures`` and the block ``Materials`` for what ``scene`` draws: made once a placement of images."""
        placement = place_textures(scene)
        key = tuple(sorted(placement.refs.items()))
        if key not in self._materials:
            packed = pack_materials(scene, placement) or PAD.tobytes() * 4
            self._materials[key] = (
                _upload_textures(self._device, placement),
                create_buffer(self._device, packed, "Materials"),
            )
        return self._materials[key]


def _bytes(array: npt.NDArray[Any]) -> bytes:
    return np.ascontiguousarray(array).tobytes() or PAD.tobytes()


def _upload_textures(device: Device, placement: TexturePlacement) -> list[Texture]:
    textures = []
    for index, array in enumerate(placement.arrays):
        desc = TextureDesc(
            "srgb8_a8" if array.srgb else "rgba8",
            array.size,
            array.size,
            layers=len(array.images),
            mips=array.size.bit_length(),
            target=Target.D2_ARRAY,
        )
        texture = create_texture(device, desc, f"u_textures[{index}]")
        for mip, level in enumerate(array.levels()):
            upload_texture(device, texture, level, mip=mip)
        textures.append(texture)
    return textures
