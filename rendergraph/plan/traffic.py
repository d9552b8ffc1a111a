"""Bytes a sub-pass moves by what it declares: each part of a resource it reads or writes, once.

The least the accesses can cost, not what caches and bandwidth compression make of it; a shader that fetches a texel
twice, or only some texels, declares the same. The scene's own vertices and textures are not declared and not counted.
"""

from __future__ import annotations

from rendergraph.document.formats import FORMATS
from rendergraph.plan.graph import (
    Access,
    BufferDesc,
    CopyBuffer,
    DispatchIndirect,
    DrawIndirect,
    Resource,
    SubPass,
    Target,
    TextureDesc,
    Usage,
)
from rendergraph.plan.plan import Plan

#: Writes that leave or overwrite earlier content without fetching it, whether or not it is needed.
_BLIND = frozenset({Usage.IMAGE_WRITE, Usage.STORAGE_WRITE, Usage.COPY_TO, Usage.CLEAR})
#: Four 32-bit words a draw (GL 4.5, 10.4), three a dispatch (19).
DRAW_ARGUMENTS, DISPATCH_ARGUMENTS = 16, 12


def declared_bytes(plan: Plan, subpass: SubPass) -> tuple[int, int]:
    """(read, written) bytes: format x size x mips x layers x samples of every access, the same part counted once.

    An attachment that keeps its content counts as read too: a depth test or blending fetches it.
    """
    read: dict[tuple[str, int, int], int] = {}
    written: dict[tuple[str, int, int], int] = {}
    for access in subpass.accesses:
        parts = _parts(plan.graph.resources[access.resource], access, subpass)
        if not access.usage.writes or (access.load and access.usage not in _BLIND):
            _merge(read, parts)
        if access.usage.writes:
            _merge(written, parts)
    return sum(read.values()), sum(written.values())


def _merge(into: dict[tuple[str, int, int], int], parts: dict[tuple[str, int, int], int]) -> None:
    for part, count in parts.items():
        into[part] = max(into.get(part, 0), count)


def _parts(resource: Resource, access: Access, subpass: SubPass) -> dict[tuple[str, int, int], int]:
    """The bytes of each (resource, mip, layer) an access touches; for arrays the layers apart, so that unions count."""
    desc = resource.desc
    if isinstance(desc, BufferDesc):
        return {(resource.name, 0, 0): _buffer_bytes(desc, access, subpass)}
    texel = FORMATS[desc.format].texel_bytes * desc.samples
    mips = range(desc.mips) if access.mip is None else (access.mip,)
    found: dict[tuple[str, int, int], int] = {}
    for mip in mips:
        level = max(1, desc.width >> mip) * max(1, desc.height >> mip) * texel
        layers = range(_layers(desc, mip)) if access.layer is None else (access.layer,)
        found |= {(resource.name, mip, layer): level for layer in layers}
    return found


def _layers(desc: TextureDesc, mip: int) -> int:
    return max(1, desc.layers >> mip) if desc.target is Target.D3 else desc.layers


def _buffer_bytes(desc: BufferDesc, access: Access, subpass: SubPass) -> int:
    work = subpass.work
    if access.usage is Usage.INDIRECT and isinstance(work, DrawIndirect):
        return DRAW_ARGUMENTS * work.count
    if access.usage is Usage.INDIRECT and isinstance(work, DispatchIndirect):
        return DISPATCH_ARGUMENTS
    if isinstance(work, CopyBuffer) and access.usage in (Usage.COPY_FROM, Usage.COPY_TO):
        return work.bytes
    return desc.bytes
