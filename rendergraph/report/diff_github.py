"""A comparison as GitHub workflow commands: the worst as annotations, all of it in the job's summary.

GitHub shows 10 annotations of a kind a step, so the last one counts what is left over. Source: GitHub Docs, "Workflow
commands for GitHub Actions"; actions/toolkit, docs/problem-matchers.md, "Limitations".
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

from rendergraph.document.whole_files import cannot_write
from rendergraph.measure.statistics import Verdict
from rendergraph.report.diff import Comparison
from rendergraph.report.diff_markdown import diff_markdown
from rendergraph.report.diff_text import sentence, summary, time_sentence, why

CAP: Final = 10


def diff_annotations(comparison: Comparison, gate: str) -> str:
    """Errors for what fails the gate, warnings for other regressions, one notice for the rest."""
    failed = comparison.regressions(gate)
    tolerated = [found for found in comparison.regressions("all") if found not in failed]
    unknown = [
        f"{time_sentence(entry)} ({why(entry)})"
        for entry in comparison.times
        if entry.change.verdict is Verdict.INCONCLUSIVE
    ]
    lines = _commands("error", "regression", [sentence(found) for found in failed])
    warnings = [found.text for found in comparison.warnings] + [sentence(found) for found in tolerated]
    lines += _commands("warning", "not gated", warnings)
    lines += _commands("notice", "inconclusive", unknown)
    lines.append(_command("notice", "outcome", summary(comparison, gate)) if not failed else "")
    return "\n".join(line for line in lines if line)


def append_summary(comparison: Comparison, gate: str) -> None:
    """Add the comparison as Markdown to the file that ``$GITHUB_STEP_SUMMARY`` names, where it is set.

    Raises RenderGraphError RG560 when it cannot be written.
    """
    name = os.environ.get("GITHUB_STEP_SUMMARY")
    if name:
        try:
            with Path(name).open("a", encoding="utf-8") as file:
                file.write(f"{diff_markdown(comparison, gate)}\n")
        except OSError as error:
            raise cannot_write(Path(name), error) from None


def _commands(level: str, title: str, texts: list[str]) -> list[str]:
    cap = CAP - 1 if level == "notice" else CAP  # the summary is a notice too
    shown = texts if len(texts) <= cap else texts[: cap - 1]
    lines = [_command(level, title, text) for text in shown]
    if len(shown) < len(texts):
        lines.append(_command(level, title, f"and {len(texts) - len(shown)} more, see the job's summary"))
    return lines


def _command(level: str, title: str, text: str) -> str:
    return f"::{level} title={_property(f'rg diff: {title}')}::{_data(text)}"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
