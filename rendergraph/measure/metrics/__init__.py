"""How far an image is from the truth: docs/metrics.md tells what each metric means and when it misleads."""

from rendergraph.measure.metrics.compare import as_json, compare, error_map, worst_texel
from rendergraph.measure.metrics.flip import PIXELS_PER_DEGREE, Flip, flip, flip_version
from rendergraph.measure.metrics.images import ImageError, compare_images
from rendergraph.measure.metrics.picture import error_picture, picture_range, write_error_picture
from rendergraph.measure.metrics.table import HEADLINE, LARGER_IS_BETTER, METRICS, unit

__all__ = [
    "HEADLINE",
    "LARGER_IS_BETTER",
    "METRICS",
    "PIXELS_PER_DEGREE",
    "Flip",
    "ImageError",
    "as_json",
    "compare",
    "compare_images",
    "error_map",
    "error_picture",
    "flip",
    "flip_version",
    "picture_range",
    "unit",
    "worst_texel",
    "write_error_picture",
]
