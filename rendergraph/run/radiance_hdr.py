"""Radiance HDR (RGBE) files: flat and run-length-encoded scanlines, -Y +X orientation.

The format is Greg Ward's, "Real Pixels", Graphics Gems II, 1991.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from rendergraph.document.messages import RenderGraphError, diagnose

MAX_PIXELS = 1 << 28


def read_hdr(path: Path) -> npt.NDArray[np.float32]:
    """Linear radiance, ``float32[height, width, 3]``, first row on top. RenderGraphError RG563 when malformed."""
    try:
        data = path.read_bytes()
        width, height, body = _header(data)
        rgbe = _scanlines(data, body, width, height)
    except (OSError, ValueError, IndexError) as error:
        raise RenderGraphError([diagnose("RG563", path=str(path), reason=str(error))], 2) from None
    scale = np.ldexp(np.float32(1.0), rgbe[..., 3].astype(np.int32) - 136).astype(np.float32)
    return rgbe[..., :3].astype(np.float32) * np.where(rgbe[..., 3:] > 0, scale[..., None], np.float32(0.0))


def _header(data: bytes) -> tuple[int, int, int]:
    if not data.startswith(b"#?"):
        raise ValueError("not a Radiance file")
    end = data.find(b"\n\n")
    if end < 0:
        raise ValueError("header never ends")
    line_end = data.find(b"\n", end + 2)
    words = data[end + 2 : line_end].split()
    if len(words) != 4 or words[0] != b"-Y" or words[2] != b"+X":
        raise ValueError("only -Y +X orientation is read")
    height, width = int(words[1]), int(words[3])
    if not 0 < width * height <= MAX_PIXELS:
        raise ValueError(f"bad size {width} x {height}")
    return width, height, line_end + 1


def _scanlines(data: bytes, start: int, width: int, height: int) -> npt.NDArray[np.uint8]:
    body = np.frombuffer(data, dtype=np.uint8)[start:]
    if len(body) < 4 or body[0] != 2 or body[1] != 2 or width < 8 or width > 32767:
        if len(body) < width * height * 4:
            raise ValueError("truncated")
        return body[: width * height * 4].reshape(height, width, 4)
    out = np.empty((height, 4, width), dtype=np.uint8)
    at = 0
    for row in range(height):
        if body[at] != 2 or body[at + 1] != 2 or int(body[at + 2]) << 8 | int(body[at + 3]) != width:
            raise ValueError(f"bad scanline {row}")
        at += 4
        for channel in range(4):
            x = 0
            while x < width:
                count = int(body[at])
                if count > 128:  # a run
                    count -= 128
                    out[row, channel, x : x + count] = body[at + 1]
                    at += 2
                else:
                    out[row, channel, x : x + count] = body[at + 1 : at + 1 + count]
                    at += 1 + count
                x += count
                if count == 0 or x > width:
                    raise ValueError(f"bad run in scanline {row}")
    return out.transpose(0, 2, 1)
