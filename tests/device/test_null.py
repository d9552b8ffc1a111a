"""The null device says what a plan would do, in order, without GL."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from rendergraph.device.null import NullDevice
from rendergraph.plan.graph import (
    Access,
    BufferDesc,
    Dispatch,
    Frame,
    Fullscreen,
    Graph,
    Kind,
    Program,
    Resource,
    SubPass,
    TextureDesc,
    Usage,
)
from rendergraph.plan.plan import (
    Barrier,
    BufferRange,
    Hazard,
    Lifetime,
    MemoryTotals,
    Plan,
    PlanOptions,
    TextureSlot,
)


def small_plan() -> Plan:
    """A dispatch that stores an image and a buffer, and a draw that samples them, with the barrier between."""
    desc = TextureDesc("rgba16f", 64, 32)
    resources = {
        "lit": Resource("lit", desc),
        "counts": Resource("counts", BufferDesc(512)),
        "image": Resource("image", TextureDesc("rgba8", 64, 32), Kind.PERSISTENT),
        "old": Resource("old", TextureDesc("rgba8", 64, 32), Kind.HISTORY, previous_of="image"),
    }
    light = SubPass(
        "light.shade",
        "light",
        (
            Access("lit", Usage.IMAGE_WRITE, "u_lit", load=False, mip=0),
            Access("counts", Usage.STORAGE_WRITE, "Counts", load=False),
            Access("old", Usage.SAMPLED, "u_old"),
        ),
        Dispatch(8, 4),
        Program((("compute", Path("light.comp")),)),
    )
    tonemap = SubPass(
        "tonemap.apply",
        "tonemap",
        (Access("image", Usage.COLOR, load=False), Access("lit", Usage.SAMPLED, "u_lit")),
        Fullscreen(),
        Program((("fragment", Path("tonemap.frag")), ("vertex", Path("fullscreen.vert")))),
        clears={"image": (0.0, 0.0, 0.0, 1.0)},
    )
    hazard = Hazard("lit", "lit", "light.shade", "tonemap.apply", "texture_fetch")
    return Plan(
        graph=Graph(Frame(64, 32), resources, {}, ("image",)),
        options=PlanOptions(),
        order=(light, tonemap),
        culled=(),
        lifetimes={"lit": Lifetime(0, 1), "counts": Lifetime(0, 0), "image": Lifetime(1, 1), "old": Lifetime(0, 0)},
        slots=(TextureSlot(desc, ("lit",)),),
        slot_of={"lit": 0},
        buffer_of={"counts": BufferRange(256, 512)},
        heap_bytes=768,
        barriers=(Barrier(1, 0x8, True, (hazard,)),),
        totals=MemoryTotals(0, 0, 0, 0, 0, 0),
    )


def test_every_command_in_order() -> None:
    device = NullDevice()
    assert device.execute(small_plan()) == [
        "allocate slot 0: rgba16f 2d 64x32x1 mips 1",
        "allocate heap: 768 bytes",
        "view lit: slot 0 as rgba16f",
        "range counts: heap 256+512",
        "allocate image: rgba8 2d 64x32x1 mips 1",
        "allocate old: rgba8 2d 64x32x1 mips 1",
        "begin light.shade",
        "bind u_lit = image_write lit mip 0",
        "bind Counts = storage_write counts",
        "bind u_old = sampled old",
        "program light.comp",
        "Dispatch 8 4 1",
        "end light.shade",
        "barrier 0x8 + texture",
        "begin tonemap.apply",
        "attach color image clear (0.0, 0.0, 0.0, 1.0)",
        "bind u_lit = sampled lit",
        "program tonemap.frag fullscreen.vert",
        "Fullscreen",
        "end tonemap.apply",
        "swap image old",
    ]
    assert len(device.log) == 21
    device.execute(small_plan())
    assert len(device.log) == 42


def test_it_needs_no_gl() -> None:
    script = "import sys; import rendergraph.device.null; print('numpy' in sys.modules, 'moderngl' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]
