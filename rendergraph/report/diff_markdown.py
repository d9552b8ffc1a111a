"""A comparison as Markdown, for a pull request's comment or a job's summary."""

from __future__ import annotations

from rendergraph.measure.statistics import Verdict
from rendergraph.report.diff import Comparison
from rendergraph.report.diff_exact import Direction
from rendergraph.report.diff_text import image_sentence, interval, milliseconds, pass_label, percent, summary, why

_MARKS = {Direction.WORSE: "❌ worse", Direction.BETTER: "✅ better", Direction.CHANGED: "➖ changed"}
_VERDICTS = {
    Verdict.SLOWER: "❌ slower",
    Verdict.FASTER: "✅ faster",
    Verdict.INCONCLUSIVE: "❔ inconclusive",
    Verdict.UNCHANGED: "➖ unchanged",
}


def diff_markdown(comparison: Comparison, gate: str) -> str:
    """The whole comparison, worst first, without a newline at its end."""
    blocks = [
        f"### `rg diff {_code(comparison.before)} {_code(comparison.after)}`",
        f"**{_text(summary(comparison, gate))}**",
    ]
    blocks += [f"> {_text(found.text)}" for found in comparison.warnings]
    if comparison.exact:
        rows = [f"| {_MARKS[change.direction]} | {_text(change.text)} |" for change in comparison.exact]
        blocks.append("\n".join(["| | exact quantity |", "|---|---|", *rows]))
    if comparison.times:
        head = "| pass | verdict | before ms | after ms | shift ms | shift | interval ms | why |"
        rows = [
            f"| {_text(pass_label(e))} | {_VERDICTS[e.change.verdict]} | {milliseconds(e.change.before)} "
            f"| {milliseconds(e.change.after)} | {milliseconds(e.change.shift, sign=True)} | {percent(e)} "
            f"| {interval(e)} | {why(e)} |"
            for e in comparison.times
        ]
        blocks.append("\n".join([head, "|---|---|--:|--:|--:|--:|--:|---|", *rows]))
    if comparison.images:
        blocks.append("\n".join(f"- {_text(image_sentence(image))}" for image in comparison.images))
    return "\n\n".join(blocks)


def _text(text: str) -> str:
    """Text that means nothing else in Markdown or HTML, on one line."""
    for character in "\\`*_{}[]<>|#":
        text = text.replace(character, f"\\{character}")
    return " ".join(text.split())


def _code(text: str) -> str:
    return " ".join(text.replace("`", "'").split())
