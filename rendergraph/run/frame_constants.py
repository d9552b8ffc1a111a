"""The ``Frame`` uniform block of every frame of a run, packed before the first: steady state uploads nothing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rendergraph.plan.graph import Frame
from rendergraph.scene.cameras import projection_matrix, view_matrix
from rendergraph.scene.scene import Camera, Scene

_MATRICES = (
    "view", "projection", "view_projection", "inverse_view", "inverse_projection", "inverse_view_projection",
    "previous_view_projection",
)  # fmt: skip
_VECTORS = (
    "camera", "viewport", "sun_direction", "sun_irradiance", "ambient_sky", "ambient_ground", "scene_min", "scene_max",
)  # fmt: skip

#: Mirrors ``Frame`` in shaders/frame.glsl (std140: mat4 and vec4 members only, so no padding inside).
FRAME_BLOCK = np.dtype(
    [(name, np.float32, (4, 4)) for name in _MATRICES]
    + [(name, np.float32, (4,)) for name in _VECTORS]
    + [("counts", np.uint32, (4,))]
)

#: Bytes from one frame's block to the next: uniform ranges may start only at multiples of 256 (the GL maximum).
STRIDE = -(-FRAME_BLOCK.itemsize // 256) * 256


@dataclass(frozen=True, slots=True)
class View:
    """A camera's matrices in float64, ``[row, column]``, world to view and view to clip."""

    view: npt.NDArray[np.float64]
    projection: npt.NDArray[np.float64]


def camera_view(camera: Camera, frame: Frame) -> View:
    """The matrices of a camera for a frame's aspect ratio and depth convention."""
    aspect = frame.width / frame.height
    return View(view_matrix(camera), projection_matrix(camera, aspect, frame.depth == "reversed"))


def pack_frames(frame: Frame, scene: Scene | None, cameras: list[Camera]) -> bytes:
    """Blocks of all frames, ``STRIDE`` bytes apart. ``cameras`` holds one camera a frame."""
    packed = np.zeros(len(cameras), dtype=np.dtype({"names": ["block"], "formats": [FRAME_BLOCK], "itemsize": STRIDE}))
    previous: npt.NDArray[np.float64] | None = None
    for index, camera in enumerate(cameras):
        block = packed[index]["block"]
        view = camera_view(camera, frame)
        view_projection = view.projection @ view.view
        matrices = {
            "view": view.view,
            "projection": view.projection,
            "view_projection": view_projection,
            "inverse_view": np.linalg.inv(view.view),
            "inverse_projection": np.linalg.inv(view.projection),
            "inverse_view_projection": np.linalg.inv(view_projection),
            "previous_view_projection": view_projection if previous is None else previous,
        }
        for name, matrix in matrices.items():
            block[name] = matrix.T  # GLSL is column-major
        previous = view_projection
        block["camera"] = (*camera.position, camera.near)
        block["viewport"] = (frame.width, frame.height, 1.0 / frame.width, 1.0 / frame.height)
        block["sun_direction"][3] = camera.far or 0.0
        block["counts"] = (index, frame.seed, 0, 0)
        if scene is not None:
            _pack_scene(block, scene)
    return packed.tobytes()


def _pack_scene(block: npt.NDArray[np.void], scene: Scene) -> None:
    if scene.sun is not None:
        direction = np.asarray(scene.sun.direction, dtype=np.float64)
        block["sun_direction"][:3] = -direction / np.linalg.norm(direction)
        block["sun_irradiance"][:3] = scene.sun.irradiance
    else:
        block["sun_direction"][:3] = (0.0, 1.0, 0.0)
    if scene.ambient is not None:
        block["ambient_sky"][:3] = scene.ambient.sky
        block["ambient_ground"][:3] = scene.ambient.ground
    low, high = scene.bounds()
    block["scene_min"][:3] = low
    block["scene_max"][:3] = high
    block["counts"][2:] = (len(scene.lights), len(scene.instances))
