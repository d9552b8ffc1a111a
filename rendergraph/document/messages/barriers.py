"""RG4xx: barriers."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
    "RG401": Message(
        "error",
        "missing barrier: '{before}' uses '{resource}' after '{after}', with no {kind} barrier between them",
        "add `- {{resource: {resource}, after: {after}, before: {before}, kind: {kind}}}` to barriers:, or remove the "
        "section to have all barriers derived",
        "One of the two accesses is a shader store or atomic, which OpenGL does not order by itself (4.5 "
        "core, 7.13.2). "
        "The kind names how the resource is used next.",
    ),
    "RG402": Message(
        "warning",
        "redundant barrier: nothing calls for one on '{resource}' between '{after}' and '{before}'",
        "remove it",
        "OpenGL orders drawing, sampling, copies and clears by itself; only shader stores and atomics need barriers.",
    ),
    "RG403": Message(
        "warning",
        "barrier of the wrong kind: '{before}' needs {needed} on '{resource}' after '{after}', not {kind}",
        "state {needed} in place of {kind}",
        "A bit of glMemoryBarrier names how memory is used after it, not how it was written.",
    ),
    "RG404": Message(
        "note",
        "barrier on '{resource}' between '{after}' and '{before}': '{gone}' does not run",
        "nothing to do; it applies again when '{gone}' runs",
    ),
}
