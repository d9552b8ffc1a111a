"""Which memory barriers a plan needs: no more, and none by guess.

OpenGL orders its commands by itself, except for shader stores and atomics on images and storage buffers ("incoherent"
accesses; 4.5 core, section 7.13.2). A ``glMemoryBarrier`` bit names how memory is used *after* it. It is needed

- between an incoherent write and any later access (the later one would not see, or would race with, the write);
- between any access and a later incoherent write (stores wait for earlier accesses only across a barrier).

``glTextureBarrier`` is needed before a draw that samples what it also renders to, after earlier rendering to it (9.3.1).
Everything is derived on storage, so tenants of one slot guard each other; and around the frame boundary, since frame
N's tail runs into frame N+1's head, with history swapped in between.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from rendergraph.plan.graph import Decision, Graph, SubPass
from rendergraph.plan.place_barriers import place
from rendergraph.plan.plan import Barrier, Hazard
from rendergraph.plan.storage import Touch, cell_histories

#: Bits of ``glMemoryBarrier`` by kind. The texture barrier is a call of its own and has no bit.
BITS = {
    "vertex_attrib": 0x1,
    "element_array": 0x2,
    "uniform": 0x4,
    "texture_fetch": 0x8,
    "shader_image": 0x20,
    "command": 0x40,
    "texture_update": 0x100,
    "buffer_update": 0x200,
    "framebuffer": 0x400,
    "shader_storage": 0x2000,
    "texture_barrier": 0,
}
