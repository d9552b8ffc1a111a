"""The page's accuracy section: what each measure judged, its truth and the error between them, as small pictures."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rendergraph.measure.metrics import error_map, error_picture, picture_range
from rendergraph.measure.truth.judgement import Judgement, Pictures
from rendergraph.node.reference import Quantity
from rendergraph.report.accuracy_table import shown

F64 = npt.NDArray[np.float64]
_LONGEST_SIDE: Final = 256


@dataclass(slots=True)
class ErrorGallery:
    """Collects small pictures while passes are judged: pass :meth:`add` as ``judge_graph``'s ``show``."""

    pictures: dict[tuple[str, str], list[dict[str, str]]] = field(default_factory=dict)

    def add(self, found: Judgement) -> None:
        """Keep pictures of one measure."""
        self.pictures[found.pass_name, found.measure] = _pictures(found)


def accuracy_entries(record: Mapping[str, Any], gallery: ErrorGallery) -> list[dict[str, Any]]:
    """Everything the page says of each pass: its entry of the record, and for each measure its pictures."""
    entries = []
    for entry in record["passes"]:
        measures = [
            {
                **measure,
                "shown": shown(measure["value"]),
                "allowed": shown(measure["tolerance"]),
                "pictures": gallery.pictures.get((entry["name"], measure["name"]), []),
            }
            for measure in entry["measures"]
        ]
        entries.append({**entry, "measures": measures})
    return entries


def _pictures(found: Judgement) -> list[dict[str, str]]:
    """Judged, truth, error, and where FLIP is known its map: each a heading, a note and a data URI."""
    pictures = found.pictures
    if pictures is None or (pictures.mask is not None and not pictures.mask.any()):
        return []
    low, high = _range(found.quantity, pictures)
    views = [
        ("judged", "", _look(found.quantity, pictures.judged, low, high)),
        ("truth", "", _look(found.quantity, pictures.truth, low, high)),
    ]
    kinds = [("error", found.metric if found.metric != "flip" else "max")]
    if found.metrics.get("flip") is not None:
        kinds.append(("FLIP", "flip"))
    for heading, metric in kinds:
        errors = error_map(found.quantity, pictures.judged, pictures.truth, pictures.mask, metric)
        limits = (0.0, 1.0) if metric == "flip" else picture_range(errors)
        note = f"black 0 to pale {limits[1]:.3g}; grey: not known"
        views.append((heading, note, error_picture(_shrunk(errors), limits)))
    return [{"heading": heading, "note": note, "png": _png(pixels)} for heading, note, pixels in views]


def _range(quantity: Quantity, pictures: Pictures) -> tuple[float, float]:
    """What black and white are, the same for both pictures."""
    if quantity in (Quantity.DISPLAY, Quantity.SHARE):
        return 0.0, 1.0
    if quantity is Quantity.NORMAL:
        return -1.0, 1.0
    known = pictures.truth if pictures.mask is None else pictures.truth[pictures.mask]
    finite = known[np.isfinite(known)]
    low, high = (float(v) for v in np.percentile(finite, (0.5, 99.5))) if finite.size else (0.0, 1.0)
    low = min(low, 0.0) if quantity is Quantity.RADIANCE else low
    return (low, high) if high > low else (low, low + max(1.0, abs(low)))


def _look(quantity: Quantity, pixels: F64, low: float, high: float) -> npt.NDArray[np.uint8]:
    """Pixels as colours, NaN magenta; one channel is grey, two are red and green."""
    kept = _shrunk(pixels)[..., :3]
    ratio = np.clip((np.nan_to_num(kept, nan=low, posinf=high, neginf=low) - low) / (high - low), 0.0, 1.0)
    if quantity is Quantity.RADIANCE:
        ratio = np.where(ratio <= 0.0031308, ratio * 12.92, 1.055 * ratio ** (1 / 2.4) - 0.055)
    colours = np.zeros((*kept.shape[:2], 3), np.uint8)
    colours[..., : kept.shape[-1]] = (255.0 * ratio + 0.5).astype(np.uint8)
    if kept.shape[-1] == 1:
        colours[:] = colours[..., :1]
    colours[np.isnan(kept).any(axis=-1)] = (255, 0, 255)
    return colours


def _shrunk(pixels: F64) -> F64:
    """Some of the texels, so that the longer side is at most 256: never averaged, so that a wrong one stays wrong."""
    step = max(1, -(-max(pixels.shape[:2]) // _LONGEST_SIDE))
    return pixels[step // 2 :: step, step // 2 :: step] if min(pixels.shape[:2]) > step else pixels[:1, ::step]


def _png(pixels: npt.NDArray[np.uint8]) -> str:
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels[::-1])).save(buffer, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode()
