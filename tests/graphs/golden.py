"""Golden images: compared on llvmpipe only, where rasterising is deterministic; elsewhere a run must merely succeed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from rendergraph.run.image_files import picture, read_image, write_image

FOLDER = Path(__file__).resolve().parent.parent / "goldens" / "llvmpipe"
TOLERANCE = 1  # of 255: one rounding step


def compare(name: str, pixels: npt.NDArray[np.generic], failures: Path, *, regenerate: bool) -> None:
    """Assert that an image equals its golden within one step; on failure leave both and an amplified difference.

    The difference picture shows ``(d / 255) ** 0.25``, so that a single step is plainly visible.
    """
    shown = picture(pixels)
    golden = FOLDER / f"{name}.png"
    if regenerate:
        write_image(golden, shown)
        return
    assert golden.is_file(), f"no golden image {golden.name}: run pytest --regenerate-goldens and look at it"
    expected = read_image(golden)[..., :3]
    assert shown.shape == expected.shape, f"{name}: size {shown.shape} against the golden's {expected.shape}"
    difference = np.abs(shown.astype(np.int16) - expected.astype(np.int16))
    if difference.max() <= TOLERANCE:
        return
    amplified = ((difference / 255.0) ** 0.25 * 255.0).astype(np.uint8)
    for suffix, shot in (("actual", shown), ("expected", expected), ("difference", amplified)):
        write_image(failures / f"{name}_{suffix}.png", shot)
    worst = np.unravel_index(int(difference.max(axis=-1).argmax()), difference.shape[:2])
    raise AssertionError(
        f"{name}: {int((difference.max(axis=-1) > TOLERANCE).sum())} pixels differ by up to {difference.max()} of 255, "
        f"worst at (x {worst[1]}, y {worst[0]}); see {failures}/{name}_difference.png"
    )
