"""RG78x: what every node must show; RG79x: specialisation and scenes that change."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
    "RG790": Message(
        "error", "nothing of the scene '{scene}' is called '{name}'", "{hint}",
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
