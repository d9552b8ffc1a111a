"""pygfx's worker: `pygfx_worker.py [shadow] [scale=N] [ppaa=NAME]`; run with lavapipe as the only Vulkan driver."""

from __future__ import annotations

import math
from importlib.metadata import version
from typing import Any

import numpy as np
import numpy.typing as npt
import pygfx as gfx
import wgpu
from serve import serve
from shot import Shot, look_at, strength


class Pygfx:
    """The scene as pygfx's glTF loader gives it, drawn into a texture."""

    def __init__(self, shot: Shot, arguments: list[str]) -> None:
        given = dict(a.partition("=")[::2] for a in arguments)
        shadow = "shadow" in given
        self.size = shot.size
        width, height = shot.size
        self.target = gfx.Texture(
            dim=2, size=(width, height, 1), format="rgba8unorm-srgb", usage=wgpu.TextureUsage.COPY_SRC
        )
        self.renderer = gfx.WgpuRenderer(
            self.target,
            pixel_scale=float(given["scale"]) if "scale" in given else None,
            ppaa=given.get("ppaa", "default"),
        )
        self.scene = gfx.Scene()
        self.scene.add(gfx.Background.from_color("#000"))
        model = gfx.load_gltf(shot.scene, quiet=True)
        room = model.scene if model.scene is not None else model.scenes[0]
        for thing in room.iter():
            thing.cast_shadow = thing.receive_shadow = shadow
        self.scene.add(room)
        self._light(shot, shadow)
        # pygfx's angle spans the mean of width and height.
        aspect = width / height
        fov = 2 * math.atan(math.tan(shot.fov / 2) * (1 + aspect) / 2)
        self.camera = gfx.PerspectiveCamera(math.degrees(fov), aspect, depth_range=(0.05, 100.0))
        self.camera.world.matrix = look_at(shot.position, shot.target)
        self.device = self.renderer.device
        self.about: dict[str, Any] = {
            "version": version("pygfx"),
            "wgpu": version("wgpu"),
            "device": f"{self.device.adapter.summary}, {self.device.adapter.info['description']}",
            "internal size": [int(n) for n in self.renderer.physical_size],
            "anti-aliasing": self.renderer.ppaa,
        }

    def _light(self, shot: Shot, shadow: bool) -> None:
        self.scene.add(gfx.AmbientLight(_color(shot.ambient), math.pi))  # pygfx takes irradiance
        color, intensity = strength(shot.sun_irradiance)
        sun = gfx.DirectionalLight(_color(color), intensity, cast_shadow=shadow)
        low, high = self.scene.get_world_bounding_box()
        centre, reach = (low + high) / 2, float(np.linalg.norm(high - low))
        sun.local.position = centre - np.asarray(shot.sun_direction) * reach / 2
        sun.target.local.position = centre
        sun.shadow.camera.width = sun.shadow.camera.height = reach
        sun.shadow.camera.depth_range = (0.0, reach)
        sun.shadow.bias, sun.shadow.cull_mode = 0.003, "none"
        self.scene.add(sun)
        for point in shot.points:
            color, intensity = strength(point.intensity)
            light = gfx.PointLight(_color(color), intensity, distance=point.radius, decay=2)
            light.local.position = point.position
            self.scene.add(light)

    def draw(self) -> None:
        """See :class:`serve.Renderer`."""
        self.renderer.render(self.scene, self.camera)
        self.device._poll_wait()  # on_submitted_work_done_sync of wgpu 0.32 raises TypeError

    def read(self) -> npt.NDArray[np.uint8]:
        """See :class:`serve.Renderer`."""
        width, height = self.size
        data = self.device.queue.read_texture(
            {"texture": self.target._wgpu_object, "mip_level": 0, "origin": (0, 0, 0)},
            {"offset": 0, "bytes_per_row": 4 * width, "rows_per_image": height},
            (width, height, 1),
        )
        return np.frombuffer(data, np.uint8).reshape(height, width, 4)


def _color(linear: npt.ArrayLike) -> gfx.Color:
    return gfx.Color.from_physical(*np.asarray(linear, float))


if __name__ == "__main__":
    serve(Pygfx, bottom_up=False)
