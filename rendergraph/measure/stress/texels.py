"""The first bad texel of an output, with what the inputs hold there."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from rendergraph.measure.stress.outcome import BadTexel
from rendergraph.node.reference import PassRun

Bools = npt.NDArray[np.bool_]


def first_bad(run: PassRun, port: str, good: Bools) -> BadTexel | None:
    """The first texel, from the lower left on and layer by layer, that is not ``good`` (bool[h, w, c] or
    ``[layers, h, w, c]``) in all channels.
    """
    bad = ~good.all(axis=-1)
    if not bad.any():
        return None
    place = np.unravel_index(int(np.argmax(bad)), bad.shape)
    layer, y, x = (0, *place) if len(place) == 2 else place
    return texel_at(run, port, int(x), int(y), int(layer))


def texel_at(run: PassRun, port: str, x: int, y: int, layer: int = 0) -> BadTexel:
    """A texel of an output, and what the inputs and, where it is modified, the output itself held there before."""
    content = run.outputs[port]
    image = content[layer] if content.ndim == 4 else content
    height, width = image.shape[:2]
    inputs = {}
    for name, held in (*run.inputs.items(), *((f"{p} before", b) for p, b in run.before.items())):
        if held.ndim < 3:
            continue
        seen = held[min(layer, len(held) - 1)] if held.ndim == 4 else held
        # Of another size: where the same place of the image lies.
        row, column = y * seen.shape[0] // height, x * seen.shape[1] // width
        inputs[name] = tuple(float(v) for v in seen[row, column])
    return BadTexel(port, x, y, layer, tuple(float(v) for v in image[y, x]), inputs)


def finite_inputs(run: PassRun) -> bool:
    """Whether everything that a pass found before it ran was finite."""
    found = [c for c in (*run.inputs.values(), *run.before.values()) if c.dtype.kind == "f"]
    return all(bool(np.isfinite(content).all()) for content in found)
