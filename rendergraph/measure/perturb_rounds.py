"""How many rounds the perturbed runs take: apart, since the parent process needs the number and no OpenGL."""

from typing import Final

ROUNDS: Final = 7
#: Frames back to back: enough that the wait at the end of a round is a small part of it.
FRAMES: Final = 6
