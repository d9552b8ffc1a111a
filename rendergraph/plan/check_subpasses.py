"""What the sub-passes of one pass do with resources: what OpenGL would refuse, and nodes that break their word."""

from __future__ import annotations

from typing import Any

from rendergraph.document.formats import FORMATS
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node
from rendergraph.plan.findings import Findings
from rendergraph.plan.graph import Access, BufferDesc, DrawScene, Resource, SubPass, Target, TextureDesc, Usage

_IMAGE = frozenset({Usage.IMAGE_READ, Usage.IMAGE_WRITE, Usage.IMAGE_UPDATE})
_BUFFER = frozenset({
    Usage.STORAGE_READ, Usage.STORAGE_WRITE, Usage.STORAGE_UPDATE,
    Usage.UNIFORM, Usage.INDIRECT, Usage.VERTEX, Usage.INDEX,
})  # fmt: skip
_ATTACHMENT = frozenset({Usage.COLOR, Usage.DEPTH, Usage.DEPTH_READ})
_TEXTURE = _IMAGE | _ATTACHMENT | {Usage.SAMPLED}


class NodeError(Exception):
    """A node's sub-passes contradict what it declares."""


def check_subpasses(name: str, node: Node[Any], builder: Builder, has_scene: bool, findings: Findings) -> None:
    """Report what pass ``name`` may not do. Raises ``NodeError`` for a defect of the node."""
    inputs = {resource.name for resource in builder.inputs.values()}
    outputs = {resource.name for resource in builder.outputs.values()}
    visible = {r.name: r for r in (*builder.inputs.values(), *builder.outputs.values(), *builder.resources.values())}
    written: set[str] = set()
    for subpass in builder.subpasses:
        for access in subpass.accesses:
            if access.resource not in visible:
                raise NodeError(f"{subpass.name} touches '{access.resource}', which it is not connected to")
            if access.usage.writes:
                written.add(access.resource)
                if access.resource in inputs and access.resource not in outputs:
                    raise NodeError(f"{subpass.name} writes the input '{access.resource}'")
            _check_access(name, access, visible[access.resource], findings)
        _check_attachments(name, subpass, visible, findings)
        if isinstance(subpass.work, DrawScene) and not has_scene:
            findings.add("RG224", "passes", name, key=True, name=name, node=node.name)
    # What a node adds to may stay as it is: a scene without glass leaves the transparent pass nothing to do.
    missing = [port for port, r in builder.outputs.items() if r.name not in written and not node.modifies(port)]
    if missing:
        raise NodeError(f"no sub-pass writes the output {' and '.join(sorted(missing))}")


def _check_access(name: str, access: Access, resource: Resource, findings: Findings) -> None:
    desc, usage = resource.desc, access.usage
    problem, hint, format = "", "", "buffer"
    if isinstance(desc, BufferDesc):
        if usage in _TEXTURE:
            problem, hint = "which takes a texture", "give the resource a format: instead of bytes:"
    else:
        row, format = FORMATS[desc.format], desc.format
        if usage in _BUFFER:
            problem, hint = "which takes a buffer", "give the resource bytes: instead of a format:"
        elif usage in _IMAGE and row.image is None:
            problem, hint = (
                "which OpenGL refuses for this format",
                "use rgba8, rgba16f, r32ui or another storable format",
            )
        elif usage is Usage.COLOR and row.depth:
            problem, hint = "but it is a depth format", "use a colour format"
        elif usage in (Usage.DEPTH, Usage.DEPTH_READ) and not row.depth:
            problem, hint = "but it is a colour format", "use d32f"
        elif usage is Usage.SAMPLED and access.filter != "nearest" and (row.sampler or desc.samples > 1):
            kind = "multisampled" if desc.samples > 1 else "integer"
            problem, hint = f"but {kind} textures are never filtered", "use filter: nearest"
        elif usage is Usage.SAMPLED and access.filter == "compare" and not row.depth:
            problem, hint = "but only depth is compared", "use filter: linear"
        _check_range(name, access, resource, desc, findings)
    if problem:
        what = usage.value if access.filter == "nearest" else f"{usage.value} ({access.filter})"
        findings.add(
            "RG325", "passes", name, key=True,
            name=name, resource=resource.name, format=format, usage=what, problem=problem, hint=hint,
        )  # fmt: skip


def _check_range(name: str, access: Access, resource: Resource, desc: TextureDesc, findings: Findings) -> None:
    if access.mip is None and access.layer is None:
        return
    layers = {Target.CUBE: 6, Target.CUBE_ARRAY: 6 * desc.layers}.get(desc.target, desc.layers)
    for part, index, count in (("mip", access.mip, desc.mips), ("layer", access.layer, max(layers, desc.layers))):
        if index is not None and index >= count:
            findings.add(
                "RG327",
                "passes",
                name,
                key=True,
                name=name,
                part=part,
                index=index,
                resource=resource.name,
                count=count,
            )


def _check_attachments(name: str, subpass: SubPass, visible: dict[str, Resource], findings: Findings) -> None:
    """All attachments of a draw have one size and one number of samples (GL 4.5, 9.4.2: else incomplete or cropped)."""
    first: tuple[str, str] | None = None
    for access in subpass.accesses:
        desc = visible[access.resource].desc
        if access.usage not in _ATTACHMENT or not isinstance(desc, TextureDesc):
            continue
        shape = _shape(desc, access)
        if first is None:
            first = access.resource, shape
        elif shape != first[1]:
            findings.add(
                "RG326", "passes", name, key=True,
                name=name, first=first[0], first_is=first[1], second=access.resource, second_is=shape,
            )  # fmt: skip


def _shape(desc: TextureDesc, access: Access) -> str:
    level = access.mip or 0
    layers = 1 if access.layer is not None else desc.layers
    text = f"{max(1, desc.width >> level)} x {max(1, desc.height >> level)}"
    return (
        text + (f" x {layers} layers" if layers > 1 else "") + (f", {desc.samples} samples" if desc.samples > 1 else "")
    )
