"""RG78x: what every node must show; RG79x: specialisation and scenes that change."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
    "RG780": Message(
        "error",
        "{node} misses the demand `graph`: {text}",
        "put NODE.yaml into `graphs/` (a package: `graphs/NODE.yaml`, `NODE.yaml` or `example.yaml` by the "
        "node); `rg validate` tells the rest",
        "A graph of its own is what a node's reader runs first, and what all other demands are tried on.",
    ),
    "RG781": Message(
        "error",
        "{node} misses the demand `readme`: {text}",
        "write the section; nodes/fxaa/README.md has all of them",
        "A node's README says in its first sentence what it does, then `**Pick it**` and `**Not**` (or `**Do "
        "not**`, `**Pick another**`), `**Cost.**`, `**Accuracy.**` with a figure, and `**Source.**`.",
    ),
    "RG782": Message(
        "error",
        "{node} misses the demand `parameters`: {text}",
        "declare it with knob(default, help, unit=..., ge=..., le=..., accurate=...)",
        "Checks, the JSON Schema, `rg nodes`, sweep axes and the node's page are made from the field. "
        '`accurate="neither"` says that no value is more accurate than another.',
    ),
    "RG783": Message(
        "error",
        "{node} misses the demand `reference`: {text}",
        "look at the error map: `rg render GRAPH --reference --html`; the shader or its reference is wrong, "
        "or the stated error was never true",
        "A node's accuracy is what its reference finds on its own graph, never above what the node states. An "
        "`exact` node's outputs equal their truth.",
    ),
    "RG784": Message(
        "error",
        "{node} misses the demand `knobs`: {text}",
        "drop `accurate` from a knob that buys no accuracy, or correct its direction; `rg sweep GRAPH --over "
        "PASS.KNOB` shows more values",
        "Three values of each quality knob, and the axes in `accuracy_axes`, are judged on the node's own "
        "graph: no ideal measure may rise, and one must fall. Less than half a percent counts as nothing.",
    ),
    "RG785": Message(
        "error",
        "{node} misses the demand `extremes`: {text}",
        "see `rg stress {node}`, which shows the first bad texel with its inputs",
        "Each common extreme and each that the node declares is tried on its own graph: finite, within "
        "`bounds`, no light made from nothing, its invariants, its error, no driver error.",
    ),
    "RG786": Message(
        "error",
        "{node} misses the demand `plan`: {text}",
        "make build() a function of parameters, ports and features alone, and declare every access",
        "The independent verifier passes the plan in the usual and in random legal orders; a file whose "
        "passes are listed otherwise gives the same plan.",
    ),
    "RG787": Message(
        "error",
        "{node} misses the demand `poison`: {text}",
        "clear what is not overwritten whole, or declare that it is loaded; `rg fuzz GRAPH` says more",
        "Transients hold whatever was there before. Filled with NaN, infinities or 1000 before their first "
        "use, they must give the same image.",
    ),
    "RG788": Message(
        "error",
        "{node} misses the demand `sharing`: {text}",
        "declare every read and write; `rg fuzz GRAPH` says more",
        "A transient that shares memory with another, and one that does not, must give the same image.",
    ),
    "RG789": Message(
        "error",
        "{node} misses the demand `specialisation`: {text}",
        "ask b.requires() or b.sees() for exactly what the shader leaves out; `rg fuzz GRAPH` says more",
        "What a scene does not need is left out; the image must not tell.",
    ),
    "RG794": Message(
        "error",
        "no node is called '{name}', and no installed package's entry point names such a module",
        "{hint}",
        '`[project.entry-points."rendergraph.nodes"]` with `mynode = "mypackage.mynode"`, then `pip install -e .`.',
    ),
    "RG795": Message("error", "there is no demand '{name}'", "{hint}"),
    "RG790": Message(
        "error",
        "nothing of the scene '{scene}' is called '{name}'",
        "{hint}",
        "`hide` takes the names of nodes (drawn instances) and of materials, as the scene's file gives them.",
    ),
    "RG791": Message(
        "note",
        "the change at frame {frame} never comes: there are {count} frames",
        "raise frame.count, or remove the change",
    ),
    "RG792": Message(
        "note",
        "from frame {frame} on, {resource} starts from zeros: the plan before has no such history",
        "connect it so that both scenes need it, or let the passes that read it start from nothing",
        "A scene that changes gets another plan at a frame boundary. What last frame left is handed on where both "
        "plans have it, with one size and format; else it is cleared, as before the first frame.",
    ),
    "RG793": Message("error", "the graph has no scene that could change", "give it a `scene:`"),
}
