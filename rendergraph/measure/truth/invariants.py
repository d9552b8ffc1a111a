"""What must hold of a pass whatever its truth is: the node's own ``invariants(run)``, and the bounds of its outputs."""

from __future__ import annotations

from typing import Any

import numpy as np

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.truth.judge import broken, reference_module
from rendergraph.node.contract import Node
from rendergraph.node.reference import PassRun


def broken_invariants(name: str, node: type[Node[Any]], run: PassRun) -> tuple[str, ...]:
    """A sentence for each invariant that does not hold.

    :raises RenderGraphError: RG744 where the node's own check fails.
    """
    found = list(out_of_bounds(node, run))
    module = reference_module(node)
    check = getattr(module, "invariants", None)
    if check is not None:
        try:
            found += [str(sentence) for sentence in check(run)]
        except RenderGraphError:
            raise
        except Exception as error:  # somebody's code, which may fail in any way
            raise broken(name, node, f"invariants: {type(error).__name__}: {error}") from error
    return tuple(found)


def out_of_bounds(node: type[Node[Any]], run: PassRun) -> list[str]:
    """Outputs that leave the bounds their node declares; NaN does."""
    found = []
    for port, (low, high) in node.bounds.items():
        content = run.outputs.get(port)
        if content is None or content.size == 0 or content.dtype.kind != "f":
            continue
        inside = (content >= low) & (content <= high)
        if not inside.all():
            place = np.unravel_index(int(np.argmin(inside)), inside.shape)
            where = ", ".join(str(int(i)) for i in place)
            found.append(
                f"{port} holds {float(content[place]):g} at [{where}], outside {low:g} to {high:g}, as do "
                f"{int((~inside).sum()) - 1} more values"
            )
    return found
