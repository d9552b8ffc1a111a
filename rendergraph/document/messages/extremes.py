"""RG765 to RG779: stress and fuzzing."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
    "RG765": Message(
        "error",
        "{extreme}: {name} ({node}) fails: {text}{where}",
        "run it alone with `rg stress {target} --only {extreme}`; a check that cannot hold is left out in the node's "
        "`extremes` with a reason (`skips`)",
        "`rg stress` runs a graph at numerical extremes and checks every pass: finite, within the node's bounds, no "
        "more light out than in, the node's invariants, and the error that its reference allows.",
    ),
    "RG766": Message(
        "error",
        "{extreme}: the run ends with an error instead of a picture: {text}",
        "make the node bear it, or refuse it: declare the code as `refused` of its extreme",
    ),
    "RG767": Message(
        "error",
        "{extreme}: {text}",
        "refuse it in the node's build(), or drop `refused` from its extreme",
    ),
    "RG768": Message("error", "'{name}' is neither a node, nor a shipped graph, nor a file", "{hint}"),
    "RG769": Message("error", "there is no extreme '{name}' here", "{hint}; `rg stress TARGET --list` lists them"),
    "RG770": Message("error", "no process can try the extremes: {reason}", "try `--no-isolate`, and see `rg doctor`"),
    "RG771": Message(
        "error",
        "the node '{name}' has no graph of its own to be tried on",
        "name a graph that uses it, or put example.yaml beside the node",
    ),
    "RG772": Message(
        "error",
        "{extreme}: {text}",
        "run it alone with `rg stress {target} --only {extreme} --no-isolate` under a debugger, or raise --timeout",
    ),
    "RG775": Message(
        "error",
        "{output} differs in frame {frame} ({failed} of {runs} variations): it hangs on {guilty}; {blame}",
        "write every texel that is read later, declare what is read (update:, blend:), and give passes whose order "
        "matters an after:",
        "`rg fuzz` runs a graph in random legal orders, with transient resources filled with NaN, infinity or 1000, "
        "with and without sharing of memory, and with and without specialisation. The image must not change by a bit.",
    ),
    "RG776": Message(
        "error",
        "a variation that must not matter ends with an error, and hangs on {guilty}: {reason}",
        "run it alone with `rg render --full`, `--no-alias` or `--order random` to see the whole message",
    ),
}
