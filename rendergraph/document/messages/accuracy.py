"""RG74x: references, and errors set against them."""

from typing import Final

from rendergraph.document.messages.message import Message

ROWS: Final[dict[str, Message]] = {
    "RG740": Message(
        "error",
        "'{resource}' does not grow with the frame: it cannot be supersampled",
        "give it a size relative to the frame, or judge the pass in a graph whose resources have one",
        "Some references (the one of antialiasing, for example) render a pass's input at several times the frame's "
        "size and average it back. That needs a resource whose width and height follow the frame's.",
    ),
}
