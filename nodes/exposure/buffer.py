"""The exposure buffer that nodes hand on: what it holds is said in shaders/exposure.glsl."""

from __future__ import annotations

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.node.builder import Builder
from rendergraph.plan.graph import BufferDesc, Resource

EXPOSURE_BYTES = 16


def require_exposure(b: Builder, resource: Resource) -> None:
    """Raise ``RenderGraphError`` (RG225) unless ``resource`` can hold an exposure."""
    assert isinstance(resource.desc, BufferDesc)
    if resource.desc.bytes < EXPOSURE_BYTES:
        problem = f"the exposure in '{resource.name}' needs {EXPOSURE_BYTES} bytes, and it has {resource.desc.bytes}"
        hint = f"declare it as {resource.name}: {{bytes: {EXPOSURE_BYTES}}}"
        raise RenderGraphError([diagnose("RG225", b.position, name=b.pass_name, problem=problem, hint=hint)])
