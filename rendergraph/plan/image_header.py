"""Size of an image file from its header alone: validation must not decode pixels."""

from __future__ import annotations

import warnings
from pathlib import Path

SUFFIXES = (".png", ".jpg", ".jpeg", ".hdr")
_HEADER_BYTES = 1 << 16


def image_size(path: Path) -> tuple[int, int]:
    """Width and height in texels. Raises ``ValueError`` with what is wrong, ``OSError`` when unreadable."""
    if path.suffix.lower() not in SUFFIXES:
        raise ValueError(f"its name ends in none of {', '.join(SUFFIXES)}")
    if path.stat().st_size == 0:
        raise ValueError("the file is empty")
    return _hdr_size(path) if path.suffix.lower() == ".hdr" else _pillow_size(path)


def _pillow_size(path: Path) -> tuple[int, int]:
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            # Pillow warns of large images; the caller compares with the limit of a texture instead.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(path, formats=("PNG", "JPEG")) as image:
                return image.size
    except UnidentifiedImageError:
        raise ValueError("neither PNG nor JPEG data is in it") from None
    except Image.DecompressionBombError as error:
        raise ValueError(str(error)) from None
    except (SyntaxError, IndexError, TypeError) as error:
        raise ValueError(f"broken header: {error}") from None


def _hdr_size(path: Path) -> tuple[int, int]:
    """The resolution line of a Radiance file (G. Ward, "Real Pixels", Graphics Gems II): ``-Y height +X width``."""
    with path.open("rb") as file:
        head = file.read(_HEADER_BYTES)
    if not head.startswith(b"#?"):
        raise ValueError("not a Radiance file (no #? at its start)")
    _, blank, rest = head.partition(b"\n\n")
    words = rest.partition(b"\n")[0].split()
    if not blank or len(words) != 4 or words[0] != b"-Y" or words[2] != b"+X":
        raise ValueError("no resolution line of the form -Y height +X width")
    if not (words[1].isdigit() and words[3].isdigit()):
        raise ValueError("the resolution line holds no numbers")
    return int(words[3]), int(words[1])
