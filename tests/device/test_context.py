"""Opening and closing the device, and every way an environment can be unfit: each in a process of its own."""

from __future__ import annotations

import _ctypes
import ctypes
import json
import os
import subprocess
import sys

import pytest

from rendergraph.device.context import APT_LINE, Device, open_device
from rendergraph.device.info import Counters
from rendergraph.document.messages import RenderGraphError

OPEN = """
import json
from rendergraph.device.context import open_device
from rendergraph.document.messages import RenderGraphError
try:
    device = open_device({index})
    print(json.dumps({{"renderer": device.info.renderer}}))
except RenderGraphError as error:
    first = error.diagnostics[0]
    found = {{"code": first.code, "exit": error.exit_code, "help": first.help, "data": first.data}}
    print(json.dumps(found, default=str))
"""


def run(script: str, **environment: str) -> dict:
    """The JSON a script prints last, run in a process of its own with variables added."""
    done = subprocess.run(
        [sys.executable, "-c", script],
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def mesa(device: Device) -> None:
    if not device.info.is_software:
        pytest.skip("Mesa's variables simulate the fault")


def test_no_egl_library(tmp_path) -> None:
    for library in (str(tmp_path / "libEGL.so.1"), __file__):  # missing, and not a library
        found = run(OPEN.format(index=None), GLCONTEXT_LINUX_LIBEGL=library)
        assert (found["code"], found["exit"]) == ("RG501", 3)
        assert APT_LINE in found["help"]


def test_egl_without_a_driver(device: Device, tmp_path) -> None:
    mesa(device)
    found = run(OPEN.format(index=None), __EGL_VENDOR_LIBRARY_FILENAMES=str(tmp_path / "none.json"))
    assert (found["code"], found["exit"]) == ("RG502", 3)
    assert APT_LINE in found["help"]


@pytest.mark.parametrize("index", [63, -1])
def test_no_such_device(device: Device, index: int) -> None:
    found = run(OPEN.format(index=index))
    assert (found["code"], found["exit"]) == ("RG503", 3)


def test_opengl_too_old(device: Device) -> None:
    mesa(device)
    found = run(OPEN.format(index=None), MESA_GL_VERSION_OVERRIDE="3.3")
    assert (found["code"], found["exit"]) == ("RG504", 3)


def test_a_missing_extension_is_named(device: Device) -> None:
    mesa(device)
    found = run(OPEN.format(index=None), MESA_EXTENSION_OVERRIDE="-GL_ARB_shader_draw_parameters")
    assert (found["code"], found["exit"]) == ("RG505", 3)
    assert found["data"]["missing"] == "GL_ARB_shader_draw_parameters"


def test_the_environment_may_pick_the_device(device: Device) -> None:
    assert "renderer" in run(OPEN.format(index=None), GLCONTEXT_DEVICE_INDEX=str(device.info.index))
    assert run(OPEN.format(index=None), GLCONTEXT_DEVICE_INDEX="63")["code"] == "RG503"
    assert "renderer" in run(OPEN.format(index=device.info.index), GLCONTEXT_DEVICE_INDEX="63"), "the argument wins"


def test_every_device_is_enumerated_once(device: Device) -> None:
    script = """
import json
from rendergraph.device import context
found = list(
    (index, what.info.renderer if isinstance(what, context.Device) else what.diagnostics[0].code)
    for index, what in context.enumerate_devices()
)
print(json.dumps({"found": found, "open": context._open is not None}))
"""
    found = run(script, GLCONTEXT_DEVICE_INDEX="0")
    assert [index for index, _ in found["found"]] == list(range(len(found["found"])))
    assert device.info.renderer in [renderer for _, renderer in found["found"]]
    assert len(found["found"]) < 32
    assert found["open"] is False


def test_one_device_a_process(device: Device) -> None:
    assert open_device() is device
    assert open_device(device.info.index) is device
    with pytest.raises(RenderGraphError) as caught:
        open_device(device.info.index + 1)
    assert caught.value.diagnostics[0].code == "RG506"
    assert caught.value.exit_code == 3


def test_facts(device: Device) -> None:
    assert device.info.version >= 450
    assert "GL_ARB_shader_draw_parameters" in device.info.extensions
    assert device.info.limits["max_texture_size"] >= 16384
    assert device.info.driver
    assert device.info.glsl


def test_only_egl_is_loaded(device: Device) -> None:
    mesa(device)
    script = (
        OPEN.format(index=None)
        + "maps = open('/proc/self/maps').read()\n"
        + "print(json.dumps({n: n in maps for n in ('libGL.so', 'libGLX', 'libEGL')}))"
    )
    assert run(script) == {"libGL.so": False, "libGLX": False, "libEGL": True}


def test_close_deletes_everything_and_can_open_again(device: Device) -> None:
    script = """
import json, pathlib, tempfile
from rendergraph.device import context
from rendergraph.device.buffers import create_buffer
from rendergraph.device.clock import ClockProof, TimestampClock
from rendergraph.device.context import open_device
from rendergraph.device.framebuffers import create_framebuffer
from rendergraph.device.includes import SHARED
from rendergraph.device.programs import compile_program
from rendergraph.device.samplers import sampler
from rendergraph.device.textures import create_texture, create_view
from rendergraph.plan.graph import Program, TextureDesc
device = open_device()
texture = create_texture(device, TextureDesc("rgba8", 4, 4), "t")
create_view(device, texture, texture.desc, "v")
create_framebuffer(device, [(texture, 0, None)], None, "f")
create_buffer(device, 16, "b")
sampler(device, "linear", "clamp", True)
clock = TimestampClock(device, ClockProof("agree", 64))
clock.begin_frame(); clock.begin(0); clock.end(0); clock.end_frame()
shader = pathlib.Path(tempfile.mkdtemp(), "a.frag")
shader.write_text("out vec4 o; void main() { o = vec4(1); }")
program = compile_program(device, Program((("fragment", shader), ("vertex", SHARED / "fullscreen.vert")))).glo
alive = lambda: {kind: [n for n in range(1, 64) if getattr(device.gl, f"glIs{kind}")(n)]
                 for kind in ("Texture", "Framebuffer", "Buffer", "Sampler", "Query", "Program")}
before = alive()
assert all(before.values()), before
class Kept:
    # the context stays current after close, so that it can be asked what is left
    def __init__(self, ctx): self.ctx = ctx
    def gc(self): self.ctx.gc()
    def release(self): pass
real = device.ctx
device.ctx = Kept(real)
device.close()
left = alive()
real.release()
again = open_device()
create_texture(again, TextureDesc("rgba8", 4, 4), "t")
again.check()
again.close()
print(json.dumps({"left": left, "owned": len(device.owned), "open": context._open is None}))
"""
    found = run(script)
    assert {kind: names for kind, names in found["left"].items() if names} == {}
    assert found["owned"] == 0
    assert found["open"] is True


def test_waiting_lets_other_threads_run(device: Device) -> None:
    def holds_the_gil(function: object) -> bool:
        return bool(type(function)._flags_ & _ctypes.FUNCFLAG_PYTHONAPI)

    assert holds_the_gil(ctypes.PYFUNCTYPE(None)(lambda: None))
    assert not holds_the_gil(device.gl.glFinish)
    assert not holds_the_gil(device.gl.glClientWaitSync)


def test_counters_subtract() -> None:
    later = Counters(5, 3, 100)
    earlier = later.snapshot()
    later.objects_created += 2
    assert later - earlier == Counters(2, 0, 0)
