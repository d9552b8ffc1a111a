"""What a device is, as data: the driver's facts and limits, and the counts of what has been made on it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from rendergraph.device import enums as e
from rendergraph.device.gl import GL

_LIMITS: Final = {
    name: getattr(e, name.upper())
    for name in (
        "max_texture_size", "max_3d_texture_size", "max_cube_map_texture_size", "max_array_texture_layers",
        "max_samples", "max_color_attachments", "max_combined_texture_image_units", "max_image_units",
        "max_shader_storage_block_size", "max_shader_storage_buffer_bindings", "shader_storage_buffer_offset_alignment",
        "max_uniform_block_size", "max_uniform_buffer_bindings", "uniform_buffer_offset_alignment",
        "max_compute_shared_memory_size", "max_compute_work_group_invocations",
    )
}  # fmt: skip
_SOFTWARE: Final = ("llvmpipe", "softpipe", "lavapipe", "swrast")


@dataclass(frozen=True, slots=True)
class DeviceInfo:
    """What the driver says of itself. ``version`` is the context's as 450; ``driver`` the whole GL_VERSION string."""

    index: int
    renderer: str
    vendor: str
    version: int
    driver: str
    glsl: str
    limits: dict[str, int]
    extensions: frozenset[str]

    @property
    def is_software(self) -> bool:
        """Whether a CPU rasteriser does the work."""
        return self.renderer.lower().startswith(_SOFTWARE)


@dataclass(slots=True)
class Counters:
    """What has been made or sent since the start; a steady frame adds nothing. Bytes are those handed to GL."""

    objects_created: int = 0
    programs_compiled: int = 0
    bytes_uploaded: int = 0

    def snapshot(self) -> Counters:
        """A copy, to subtract later."""
        return Counters(self.objects_created, self.programs_compiled, self.bytes_uploaded)

    def __sub__(self, earlier: Counters) -> Counters:
        return Counters(
            self.objects_created - earlier.objects_created,
            self.programs_compiled - earlier.programs_compiled,
            self.bytes_uploaded - earlier.bytes_uploaded,
        )


def describe(index: int, gl: GL, version: int) -> DeviceInfo:
    """Ask the current context for its facts; ``version`` is the context's as 450."""

    def text(name: int) -> str:
        return (gl.glGetString(name) or b"").decode(errors="replace")

    limits = {name: gl.integer(value) for name, value in _LIMITS.items()}
    limits |= {
        f"max_compute_work_group_count_{axis}": gl.integer(e.MAX_COMPUTE_WORK_GROUP_COUNT, i)
        for i, axis in enumerate("xyz")
    }
    extensions = frozenset(gl.glGetStringi(e.EXTENSIONS, i).decode() for i in range(gl.integer(e.NUM_EXTENSIONS)))
    return DeviceInfo(
        index, text(e.RENDERER), text(e.VENDOR), version, text(e.VERSION),
        text(e.SHADING_LANGUAGE_VERSION), limits, extensions,
    )  # fmt: skip
