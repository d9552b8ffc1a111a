"""A comparison in words: one line a finding, used by every format."""

from __future__ import annotations

from typing import Final

from rendergraph.measure.statistics import Verdict
from rendergraph.report.diff import Comparison, TimeChange
from rendergraph.report.diff_exact import ExactChange
from rendergraph.report.diff_images import ImageChange

_REASONS: Final = {
    "no_samples": "no samples",
    "too_few_samples": "too few samples",
    "dependent": "the samples resemble each other: too few independent ones",
    "too_noisy": "too noisy to tell",
    "inside_floor": "within",
    "beyond_floor": "beyond",
}


def pass_label(entry: TimeChange) -> str:
    """The pass's name; the whole frame has none."""
    return entry.name or "whole frame"


def percent(entry: TimeChange) -> str:
    """The shift as a share of the time before; empty when not known."""
    relative = entry.change.relative
    return "" if relative is None else f"{100 * relative:+.1f} %"


def milliseconds(value: float | None, *, sign: bool = False) -> str:
    """Milliseconds to the microsecond; empty when not known."""
    return "" if value is None else f"{value:{'+' if sign else ''}.3f}"


def interval(entry: TimeChange) -> str:
    """The shift's confidence interval."""
    low, high = entry.change.low, entry.change.high
    if low is None or high is None:
        return ""
    return f"{low:+.3f} .. {high:+.3f}"


def why(entry: TimeChange) -> str:
    """Why the verdict is what it is."""
    text = _REASONS[entry.change.reason]
    if entry.change.reason in ("inside_floor", "beyond_floor"):
        return f"{text} ±{entry.change.floor:.3f} ms"
    return text


def time_sentence(entry: TimeChange) -> str:
    """``pass light is slower: 1.200 -> 1.500 ms, +0.300 ms (+25.0 %), interval +0.280 .. +0.320 ms``."""
    change, name = entry.change, pass_label(entry)
    subject = f"{'sub-pass' if '.' in entry.name else 'pass'} {name}" if entry.name else name
    if change.before is None or change.after is None or change.shift is None:
        return f"{subject}: {change.verdict.value}, {why(entry)}"
    text = f"{subject} is {change.verdict.value}: {change.before:.3f} -> {change.after:.3f} ms"
    text += f", shift {change.shift:+.3f} ms ({percent(entry)})"
    if change.low is not None:
        text += f", interval {interval(entry)} ms"
    return text


def image_sentence(image: ImageChange) -> str:
    """``image frame.png is different: RMSE 0.0200, max 0.5 at (3, 4), 25 % of texels``."""
    said = {
        "missing": "was written only before",
        "extra": "is written only after",
        "resized": "has another size or type",
        "identical": "is identical",
        "close": "is close",
        "different": "is different",
    }[image.status]
    if image.error is None or image.status == "identical":
        return f"image {image.name} {said}"
    error = image.error
    psnr = "" if error.psnr is None else f", PSNR {error.psnr:.1f} dB"
    x, y = error.worst_texel
    return (
        f"image {image.name} {said}: RMSE {error.rmse:.4f}{psnr}, max {error.max:.4f} at ({x}, {y}), "
        f"{100 * error.differing:.1f} % of texels"
    )


def sentence(found: ExactChange | TimeChange | ImageChange) -> str:
    """Any finding as one line."""
    if isinstance(found, TimeChange):
        return time_sentence(found)
    return image_sentence(found) if isinstance(found, ImageChange) else found.text


def summary(comparison: Comparison, gate: str) -> str:
    """The last line: how many of what, and whether the gate holds."""
    failed = len(comparison.regressions(gate))
    counts = {verdict: sum(e.change.verdict is verdict for e in comparison.times) for verdict in Verdict}
    exact = len(comparison.exact)
    parts = [f"{exact} exact difference{'s' if exact != 1 else ''}"] if "exact" in comparison.compared else []
    if "time" in comparison.compared:
        parts.append("times: " + ", ".join(f"{count} {verdict.value}" for verdict, count in counts.items() if count))
    if "images" in comparison.compared:
        differ = sum(image.status != "identical" for image in comparison.images)
        parts.append(f"{differ} of {len(comparison.images)} images differ")
    verdict = f"{failed} regression{'s' if failed != 1 else ''}" if failed else "no regression"
    return f"{verdict} (gate {gate}); {'; '.join(parts)}"
