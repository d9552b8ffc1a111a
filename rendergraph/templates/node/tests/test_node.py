"""The node's arithmetic, against numbers worked out by hand."""

from pathlib import Path

import numpy as np

from rendergraph.document.load import load_document
from rendergraph.run.render import RenderOptions, render_document

EXAMPLE = Path(__file__).resolve().parent.parent / "example.yaml"


def pixels(strength: float) -> np.ndarray:
    """The example's picture at a strength, as integers."""
    document = load_document(EXAMPLE, [f"passes.effect.set.strength={strength}"])
    return render_document(document, RenderOptions(samples=0)).images["image"].astype(int)


def test_full_strength_is_grey() -> None:
    image = pixels(1.0)
    assert np.ptp(image[..., :3], axis=-1).max() <= 1


def test_no_strength_keeps_colour() -> None:
    assert np.ptp(pixels(0.0)[..., :3], axis=-1).max() > 20
