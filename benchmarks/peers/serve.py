"""The renderers' side of the pipe: builds a renderer for the shot on the first line, then draws frames on request.

Runs in three environments, so it needs numpy and Pillow alone. One JSON object a line both ways; requests are
``{"do": "frame"}`` and ``{"do": "save", "file": path}``; end of input ends the worker.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt
from PIL import Image
from shot import Shot


class Renderer(Protocol):
    """One renderer, loaded."""

    about: dict[str, Any]  # versions, device, and what it draws

    def draw(self) -> None:
        """Draw a frame and wait until the device has finished it."""

    def read(self) -> npt.NDArray[np.uint8]:
        """Copy the frame's colour to the CPU: ``uint8[height, width, 3 or 4]``."""


def serve(build: Callable[[Shot, list[str]], Renderer], *, bottom_up: bool) -> None:
    """Answer requests until the input ends. ``bottom_up``: rows of :meth:`Renderer.read` start at the bottom."""
    # What libraries print must not reach the pipe.
    pipe = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    start = time.perf_counter_ns()
    renderer = build(Shot.from_json(sys.stdin.readline()), sys.argv[1:])
    print(json.dumps({**renderer.about, "load_ns": time.perf_counter_ns() - start}), file=pipe)
    for line in sys.stdin:
        request = json.loads(line)
        cpu, start = time.process_time_ns(), time.perf_counter_ns()
        renderer.draw()
        drawn = time.perf_counter_ns()
        pixels = renderer.read()
        end = time.perf_counter_ns()
        if request["do"] == "save":
            image = pixels[::-1, :, :3] if bottom_up else pixels[..., :3]
            Image.fromarray(np.ascontiguousarray(image)).save(request["file"])
        reply = {"draw_ns": drawn - start, "frame_ns": end - start, "cpu_ns": time.process_time_ns() - cpu}
        print(json.dumps(reply), file=pipe)
