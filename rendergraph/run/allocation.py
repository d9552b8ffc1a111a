"""Gives every resource of a plan its storage: slots and views, the buffer heap, history pairs, imported files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from rendergraph.device.buffers import Buffer, create_buffer
from rendergraph.device.context import Device
from rendergraph.device.textures import Texture, clear_texture, create_texture, create_view, upload_texture
from rendergraph.document.formats import FORMATS
from rendergraph.plan.graph import BufferDesc, Kind, Resource, TextureDesc
from rendergraph.plan.plan import Plan
from rendergraph.run.image_files import Pixels, read_image

PARITIES = (0, 1)


class Allocation:
    """The storage of a plan.

    History resources swap with their source at every frame boundary, so a lookup takes the frame's parity; without
    history both parities are the same objects and ``parities`` is 1.
    """

    def __init__(self, device: Device, plan: Plan) -> None:
        self._textures: dict[tuple[str, int], Texture] = {}
        self._buffers: dict[tuple[str, int], Buffer] = {}
        slots = _create_slots(device, plan)
        heap = create_buffer(device, plan.heap_bytes, "transient buffers") if plan.heap_bytes else None
        history = {r.previous_of: r for r in plan.graph.resources.values() if r.kind is Kind.HISTORY}
        self.parities = 2 if any(name in plan.lifetimes for r in history.values() for name in (r.name,)) else 1
        for name in plan.lifetimes:
            resource = plan.graph.resources[name]
            if resource.kind is Kind.TRANSIENT and name in plan.slot_of:
                assert isinstance(resource.desc, TextureDesc)
                view = slots[plan.slot_of[name], resource.desc]
                self._share(name, replace(view, label=name))
            elif resource.kind is Kind.TRANSIENT and name in plan.buffer_of:
                assert heap is not None
                place = plan.buffer_of[name]
                self._share(name, heap.range(place.offset, place.bytes, name))
            elif resource.kind is not Kind.HISTORY:
                self._own(device, resource)
        for source, resource in history.items():
            if resource.name in plan.lifetimes:
                assert source is not None
                self._pair(device, plan.graph.resources[source], resource)

    def texture(self, name: str, parity: int = 0) -> Texture:
        """The texture behind a resource in frames of this parity. ``KeyError`` when it is a buffer."""
        return self._textures[name, parity % self.parities]

    def buffer(self, name: str, parity: int = 0) -> Buffer:
        """The buffer (or range of one) behind a resource in frames of this parity."""
        return self._buffers[name, parity % self.parities]

    def is_texture(self, name: str) -> bool:
        """Whether a resource is a texture."""
        return (name, 0) in self._textures

    # ---- kinds of storage

    def _own(self, device: Device, resource: Resource) -> None:
        if isinstance(resource.desc, BufferDesc):
            self._share(resource.name, create_buffer(device, bytes(resource.desc.bytes), resource.name))
            return
        texture = create_texture(device, resource.desc, resource.name)
        if resource.kind is Kind.IMPORTED:
            assert resource.file is not None
            upload_texture(device, texture, load_texels(resource.file, resource.desc))
        else:
            clear_texture(device, texture, (0.0, 0.0, 0.0, 0.0))
        self._share(resource.name, texture)

    def _pair(self, device: Device, source: Resource, history: Resource) -> None:
        if isinstance(history.desc, BufferDesc):
            previous = create_buffer(device, bytes(history.desc.bytes), history.name)
            pair = self._buffers[source.name, 0], previous
            for parity in PARITIES:
                self._buffers[source.name, parity] = pair[parity]
                self._buffers[history.name, parity] = pair[1 - parity]
            return
        older = create_texture(device, history.desc, history.name)
        clear_texture(device, older, (0.0, 0.0, 0.0, 0.0))
        textures = self._textures[source.name, 0], older
        for parity in PARITIES:
            self._textures[source.name, parity] = textures[parity]
            self._textures[history.name, parity] = textures[1 - parity]

    def _share(self, name: str, storage: Texture | Buffer) -> None:
        for parity in PARITIES[: self.parities]:
            if isinstance(storage, Texture):
                self._textures[name, parity] = storage
            else:
                self._buffers[name, parity] = storage


def _create_slots(device: Device, plan: Plan) -> dict[tuple[int, TextureDesc], Texture]:
    """Every slot's texture, and one view of it for each other description among its tenants.

    Tenants alike share one texture object and with it their framebuffers: a driver pays for every change of either.
    A texture's label names all the resources that it carries in turn.
    """
    textures: dict[tuple[int, TextureDesc], Texture] = {}
    for index, slot in enumerate(plan.slots):
        alike: dict[TextureDesc, list[str]] = {}
        for name in slot.tenants:
            desc = plan.graph.resources[name].desc
            assert isinstance(desc, TextureDesc)
            alike.setdefault(desc, []).append(name)
        own = alike.pop(slot.desc, [f"slot {index}"])
        storage = textures[index, slot.desc] = create_texture(device, slot.desc, ", ".join(own))
        for desc, names in alike.items():
            textures[index, desc] = create_view(device, storage, desc, ", ".join(names))
    return textures


def load_texels(file: Path, desc: TextureDesc) -> Pixels:
    """An image file's texels in the layout of a texture format: rows bottom-up, the format's channels and range."""
    pixels = read_image(file)
    fmt = FORMATS[desc.format]
    values = pixels[..., : fmt.channels]
    if fmt.channel.value == "float":
        scaled = values.astype(np.float32) / (255.0 if values.dtype == np.uint8 else 1.0)
        return np.ascontiguousarray(scaled)
    if values.dtype != np.uint8:
        values = (np.clip(values, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    return np.ascontiguousarray(values)
