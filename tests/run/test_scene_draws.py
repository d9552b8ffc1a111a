"""Draws of the scene: every camera gets its own batches, and every batch the state and textures of its materials."""

from __future__ import annotations

import numpy as np
import pytest

from rendergraph.device.context import Device
from rendergraph.run.geometry import SceneGeometry
from rendergraph.run.vertex_inputs import ATTRIBUTES, INSTANCES, STRIDES, VERTEX_INPUTS
from rendergraph.scene.gpu_layout import INSTANCE
from rendergraph.scene.scene import Alpha, Camera, Image, Instance, Material, Mesh, Scene, TextureUse


def two_panes() -> Scene:
    """Two blended boxes on the x axis whose textures lie in different arrays; the second is double-sided."""
    arrays = {
        name: np.zeros((3, width), np.float32)
        for name, width in (("positions", 3), ("normals", 3), ("tangents", 4), ("uv0", 2), ("uv1", 2), ("colors", 4))
    }
    return Scene(
        "panes", **arrays, indices=np.zeros(3, np.uint32),
        meshes=[Mesh(0, 3, 0, k, (4.0 * k, 0.0, 0.0), (4.0 * k + 1.0, 1.0, 1.0)) for k in range(2)],
        instances=[Instance(k, np.eye(4)) for k in range(2)],
        materials=[
            Material(alpha=Alpha.BLENDED, double_sided=bool(k), base_color_texture=TextureUse(k)) for k in range(2)
        ],
        images=[Image(np.zeros((side, side, 4), np.uint8), srgb=True) for side in (4, 8)],
    )  # fmt: skip


@pytest.mark.gpu
def test_batches_follow_the_camera(device: Device) -> None:
    """Seen from the other side the panes change places, and with them culling and textures."""
    cameras = [Camera((x, 0.0, 0.0), (2.0, 0.0, 0.0)) for x in (-5.0, 9.0)]
    geometry = SceneGeometry(device, two_panes(), cameras, frozenset({1, 3}))
    first, second = (texture.glo for texture in geometry.textures)
    seen = {}
    for frame in range(2):
        geometry.begin_frame(frame)
        for replays in (1, 3):
            batches = geometry.batches("blended", replays)
            assert [(b.count, b.triangles) for b in batches] == [(1, replays)] * 2
            seen[frame] = [(b.double_sided, b.textures) for b in batches]
    assert seen[0] == [(True, ((0, second),)), (False, ((0, first),))]
    assert seen[1] == seen[0][::-1]


def test_inputs_of_the_instance_lie_where_its_layout_has_them() -> None:
    fields = {"in_world": "world", "in_normal_rows": "normal", "in_material_flags": "material"}
    for name, field in fields.items():
        assert (VERTEX_INPUTS[name].stream, VERTEX_INPUTS[name].offset) == (INSTANCES, INSTANCE.fields[field][1])
    assert INSTANCE.fields["flags"][1] == INSTANCE.fields["material"][1] + 4


def test_inputs_of_a_vertex_fill_its_row_without_overlap() -> None:
    rows = sorted((i.offset, 4 * i.components) for i in VERTEX_INPUTS.values() if i.stream == ATTRIBUTES)
    ends = [offset + size for offset, size in rows]
    assert [offset for offset, _ in rows] == [0, *ends[:-1]]
    assert ends[-1] == STRIDES[ATTRIBUTES]
