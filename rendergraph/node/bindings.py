"""How a sub-pass uses resources: what its shader reads and writes under a name, and what it draws into."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rendergraph.plan.graph import Access, Usage

Color4 = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Binding:
    """How a shader uses a resource; made by the functions below, for ``bind=`` of the builder's methods."""

    resource: str
    usage: Usage
    load: bool = True
    mip: int | None = None
    layer: int | None = None
    aspect: str = "color"
    filter: str = "nearest"
    wrap: str = "clamp"


def sample(
    resource: str,
    filter: str = "nearest",
    *,
    wrap: str = "clamp",
    mip: int | None = None,
    layer: int | None = None,
    aspect: str = "color",
) -> Binding:
    """A texture read through a sampler. ``filter``: nearest, linear, mipmap, or compare (shadow sampler)."""
    return Binding(resource, Usage.SAMPLED, mip=mip, layer=layer, aspect=aspect, filter=filter, wrap=wrap)


def load_image(resource: str, *, mip: int = 0, layer: int | None = None) -> Binding:
    """An image read with ``imageLoad``."""
    return Binding(resource, Usage.IMAGE_READ, mip=mip, layer=layer)


def store_image(resource: str, *, mip: int | None = 0, layer: int | None = None, partial: bool = False) -> Binding:
    """An image written with ``imageStore``; ``partial`` when texels may be left as they were."""
    return Binding(resource, Usage.IMAGE_WRITE, load=partial, mip=mip, layer=layer)


def update_image(resource: str, *, mip: int = 0, layer: int | None = None) -> Binding:
    """An image both read and written, or used with atomics."""
    return Binding(resource, Usage.IMAGE_UPDATE, mip=mip, layer=layer)


def read_buffer(resource: str) -> Binding:
    """A shader storage block, read only."""
    return Binding(resource, Usage.STORAGE_READ)


def write_buffer(resource: str, *, partial: bool = False) -> Binding:
    """A shader storage block whose content is replaced."""
    return Binding(resource, Usage.STORAGE_WRITE, load=partial)


def update_buffer(resource: str) -> Binding:
    """A shader storage block both read and written, or used with atomics."""
    return Binding(resource, Usage.STORAGE_UPDATE)


def uniform_block(resource: str) -> Binding:
    """A buffer read as a uniform block."""
    return Binding(resource, Usage.UNIFORM)


@dataclass(frozen=True, slots=True)
class Attachment:
    """A colour or depth target of a draw: started from ``clear``, kept (``load``), or wholly overwritten (neither)."""

    resource: str
    clear: Color4 | None = None
    load: bool = False
    mip: int | None = None
    layer: int | None = None
    read_only: bool = False


def color(
    resource: str,
    *,
    clear: Color4 | None = None,
    load: bool = False,
    mip: int | None = None,
    layer: int | None = None,
) -> Attachment:
    """A colour attachment. Without ``clear`` and ``load`` the draw must cover every texel."""
    return Attachment(resource, clear, load, mip, layer)


def depth(
    resource: str,
    *,
    clear: float | None = None,
    load: bool = False,
    read_only: bool = False,
    layer: int | None = None,
) -> Attachment:
    """A depth attachment. ``clear`` is a distance in 0 (near) .. 1 (far), mirrored under reversed depth."""
    value = None if clear is None else (clear, 0.0, 0.0, 0.0)
    return Attachment(resource, value, load or read_only, None, layer, read_only)


def attachment_access(attachment: Attachment, usage: Usage) -> Access:
    """The access that drawing into an attachment is."""
    return Access(attachment.resource, usage, load=attachment.load, mip=attachment.mip, layer=attachment.layer)


def bound_accesses(bind: Mapping[str, Binding] | None) -> list[Access]:
    """The accesses of a draw or dispatch under the shader's names for them."""
    return [
        Access(b.resource, b.usage, name, b.load, b.mip, b.layer, b.aspect, b.filter, b.wrap)
        for name, b in (bind or {}).items()
    ]
