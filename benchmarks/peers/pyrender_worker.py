"""pyrender's worker: `pyrender_worker.py [shadow] [samples=N]`.

Three things of pyrender are replaced, two of them in its favour. It lights by the four nearest point lights; here by
all. Its read-back always fetches colour and depth and turns depth into metres; here colour alone, as the other two read
it. It draws into four samples a pixel; `samples` tells otherwise.
"""

from __future__ import annotations

import os

os.environ["PYOPENGL_PLATFORM"] = "egl"

from importlib.metadata import version
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenGL
import OpenGL.EGL  # PyOpenGL 3.1.10 cannot import this with its checks off

OpenGL.ERROR_CHECKING = False  # a glGetError after every call would count against it
# ruff: noqa: E402

import pyrender
import pyrender.renderer as internals
import trimesh
from OpenGL import GL
from pyrender.constants import RenderFlags
from serve import serve
from shot import Shot, look_at, strength


class Pyrender:
    """The scene as trimesh loads it, in pyrender's off-screen renderer."""

    def __init__(self, shot: Shot, arguments: list[str]) -> None:
        self.size = shot.size
        self.flags = RenderFlags.SHADOWS_DIRECTIONAL if "shadow" in arguments else RenderFlags.NONE
        samples = next((int(a.removeprefix("samples=")) for a in arguments if a.startswith("samples=")), 4)
        internals.MAX_N_LIGHTS = len(shot.points)
        internals.Renderer._read_main_framebuffer = lambda renderer, *_, **__: self._resolve(renderer)
        allocate = internals.glRenderbufferStorageMultisample
        internals.glRenderbufferStorageMultisample = lambda target, _, *rest: allocate(
            target, samples if samples > 1 else 0, *rest
        )
        self.scene = pyrender.Scene.from_trimesh_scene(
            trimesh.load(shot.scene), bg_color=[0, 0, 0, 1], ambient_light=shot.ambient
        )
        # trimesh keeps no alpha mode, and pyrender then blends every material; say so of those that need it.
        for mesh in self.scene.meshes:
            for primitive in mesh.primitives:
                primitive.material.alphaMode = "BLEND" if primitive.material.baseColorFactor[3] < 1 else "OPAQUE"
        camera = pyrender.PerspectiveCamera(yfov=shot.fov, znear=0.05, zfar=100.0)
        self.scene.add(camera, pose=look_at(shot.position, shot.target))
        color, intensity = strength(shot.sun_irradiance)
        origin = tuple(-c for c in shot.sun_direction)
        self.scene.add(
            pyrender.DirectionalLight(color=color, intensity=intensity), pose=look_at(origin, (0.0, 0.0, 0.0))
        )
        for point in shot.points:
            color, intensity = strength(point.intensity)
            pose = np.eye(4)
            pose[:3, 3] = point.position
            self.scene.add(pyrender.PointLight(color=color, intensity=intensity), pose=pose)
        self.renderer = pyrender.OffscreenRenderer(*shot.size)
        self.draw()
        self.about: dict[str, Any] = {
            "version": version("pyrender"),
            "device": " ".join(GL.glGetString(name).decode() for name in (GL.GL_RENDERER, GL.GL_VERSION)),
            "samples": samples,
        }

    def _resolve(self, renderer: internals.Renderer) -> None:
        width, height = self.size
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, renderer._main_fb_ms)
        GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, renderer._main_fb)
        GL.glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL.GL_COLOR_BUFFER_BIT, GL.GL_NEAREST)
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, renderer._main_fb)
        GL.glFinish()

    def draw(self) -> None:
        """See :class:`serve.Renderer`."""
        self.renderer.render(self.scene, self.flags)
        # pyrender lets go of its context after every frame.
        self.renderer._platform.make_current()

    def read(self) -> npt.NDArray[np.uint8]:
        """See :class:`serve.Renderer`."""
        width, height = self.size
        pixels = GL.glReadPixels(0, 0, width, height, GL.GL_RGBA, GL.GL_UNSIGNED_BYTE)
        return np.frombuffer(pixels, np.uint8).reshape(height, width, 4)


if __name__ == "__main__":
    serve(Pyrender, bottom_up=True)
