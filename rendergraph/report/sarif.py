"""Findings as SARIF 2.1.0, which code scanning services read (OASIS, "Static Analysis Results Interchange Format")."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import PurePath
from typing import Any, Final
from urllib.parse import quote

import rendergraph
from rendergraph.document.messages import MESSAGES
from rendergraph.plan.explain import explain_code
from rendergraph.report.checked_graphs import CheckedGraph, Finding, ranked

SCHEMA: Final = "https://json.schemastore.org/sarif-2.1.0.json"


def sarif_log(graphs: Sequence[CheckedGraph]) -> dict[str, Any]:
    """One run with a rule for each code found and a result for each finding, worst first, as JSON-ready data."""
    findings = ranked(graphs)
    codes = sorted({finding.code for finding in findings})
    driver = {
        "name": "rendergraph",
        "version": rendergraph.__version__,
        "semanticVersion": rendergraph.__version__,
        "rules": [_rule(code) for code in codes],
    }
    return {
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [
            {
                "tool": {"driver": driver},
                "automationDetails": {"id": "rendergraph/validate/"},
                "columnKind": "unicodeCodePoints",
                "invocations": [_invocation(graphs)],
                "artifacts": [{"location": _artifact(file)} for file in sorted({graph.file for graph in graphs})],
                "results": [_result(finding, codes.index(finding.code)) for finding in findings],
            }
        ],
    }


def _invocation(graphs: Sequence[CheckedGraph]) -> dict[str, Any]:
    code = max((graph.exit_code for graph in graphs), default=0)
    return {"executionSuccessful": code < 2, "exitCode": code}


def _rule(code: str) -> dict[str, Any]:
    message, page = MESSAGES[code], explain_code(code)
    short = page.partition("\n")[0].partition("): ")[2]
    return {
        "id": code,
        "shortDescription": {"text": short},
        "fullDescription": {"text": message.explain or short},
        "help": {"text": page, "markdown": f"```text\n{page}\n```"},
        "defaultConfiguration": {"level": message.severity},
    }


def _result(finding: Finding, rule: int) -> dict[str, Any]:
    place: dict[str, Any] = {"artifactLocation": _artifact(finding.file)}
    if finding.line is not None:
        place["region"] = {"startLine": finding.line, "startColumn": finding.column}
    text = finding.message + (f"\nhelp: {finding.help}" if finding.help else "")
    return {
        "ruleId": finding.code,
        "ruleIndex": rule,
        "level": finding.severity,
        "message": {"text": text},
        "locations": [{"physicalLocation": place}],
        "partialFingerprints": {"rendergraph/v1": _fingerprint(finding)},
    }


def _artifact(file: str) -> dict[str, str]:
    """A path of the repository as a relative URI; one outside as an absolute one."""
    path = PurePath(file)
    return {"uri": path.as_uri()} if path.is_absolute() else {"uri": quote(file), "uriBaseId": "%SRCROOT%"}


def _fingerprint(finding: Finding) -> str:
    """The same for the same mistake after lines were added above it."""
    return hashlib.sha256("\0".join((finding.code, finding.file, finding.message)).encode()).hexdigest()[:32]
