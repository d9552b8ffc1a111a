"""Findings as CI systems read them: escaped, ranked, capped, with the repository's paths."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import unquote
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rendergraph.document.messages import MESSAGES, RenderGraphError
from rendergraph.report.checked_graphs import CheckedGraph, Finding, check_graphs, ranked, repository_path
from rendergraph.report.github import (
    CAP,
    MOST_ROWS,
    append_step_summary,
    escape_data,
    escape_property,
    github_lines,
    step_summary,
)
from rendergraph.report.junit import junit_xml
from rendergraph.report.sarif import sarif_log
from tests.cli.refusal import write_graph

NASTY = "50 % of\r\nlines: a,b::error::x ##[error] | `<b>` \x1b[31m \ufffe \U0001f600"


def finding(severity: str = "error", line: int | None = 3, code: str = "RG200", **changes: Any) -> Finding:
    values = {"message": "message", "help": "help", "file": "graphs/a.yaml", "column": line and 5} | changes
    return Finding(code=code, severity=severity, line=line, **values)


def graph(*findings: Finding, code: int = 1, file: str = "graphs/a.yaml") -> CheckedGraph:
    return CheckedGraph(file, file, (), tuple(findings), code)


# ---------------------------------------------------------------- ranking and paths


def test_errors_come_first_then_files_and_lines() -> None:
    found = [
        graph(finding("note", 1), finding("error", 9), finding("warning", 2)),
        graph(finding("error", 2, file="graphs/0.yaml"), finding("error", None)),
    ]
    order = [(f.severity, f.file, f.line) for f in ranked(found)]
    assert order == [
        ("error", "graphs/0.yaml", 2),
        ("error", "graphs/a.yaml", None),
        ("error", "graphs/a.yaml", 9),
        ("warning", "graphs/a.yaml", 2),
        ("note", "graphs/a.yaml", 1),
    ]


@pytest.fixture
def repository(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with a broken and a sound graph in ``graphs/``; the working directory is another of its folders."""
    root = tmp_path / "repository"
    (root / "graphs").mkdir(parents=True)
    subprocess.run(["git", "init", "--quiet", root], check=True)
    write_graph(root / "graphs").rename(root / "graphs/good.yaml")
    write_graph(root / "graphs", resources="  a: {format: rgba17f}\n", extra="budget: {flip: 0.1}\n")
    (root / "elsewhere").mkdir()
    monkeypatch.chdir(root / "elsewhere")
    return root


def test_paths_are_the_repository_s(repository: Path, tmp_path: Path) -> None:
    assert repository_path("../graphs/graph.yaml") == "graphs/graph.yaml"
    assert repository_path(repository / "graphs/graph.yaml") == "graphs/graph.yaml"
    outside = tmp_path / "outside.yaml"
    assert repository_path(outside) == str(outside)
    (repository / "link.yaml").symlink_to("graphs/graph.yaml")
    assert repository_path("../link.yaml") == "graphs/graph.yaml"


def test_checked_graphs(repository: Path) -> None:
    bad, good = check_graphs(["../graphs/graph.yaml", "../graphs/good.yaml"])
    assert (bad.exit_code, good.exit_code) == (1, 0)
    assert [f.code for f in bad.findings] == ["RG303"]
    assert (bad.findings[0].file, bad.findings[0].line) == ("graphs/graph.yaml", 5)
    assert good.findings == ()
    overridden = check_graphs(["../graphs/good.yaml"], ["resources.a.format=rgba17f"])[0].findings
    assert [(f.code, f.file, f.line) for f in overridden] == [("RG303", "graphs/good.yaml", None)]
    assert "--set resources.a.format=rgba17f" in overridden[0].message


# ---------------------------------------------------------------- GitHub


def parse_command(line: str) -> tuple[str, dict[str, str], str]:
    """A workflow command as GitHub's runner reads it."""
    found = re.fullmatch(r"::(\w+) ([^:]*)::(.*)", line)
    assert found, line

    def plain(text: str, *more: tuple[str, str]) -> str:
        for escape, character in (*more, ("%0D", "\r"), ("%0A", "\n"), ("%25", "%")):
            text = text.replace(escape, character)
        return text

    pairs = [pair.split("=", 1) for pair in found[2].split(",")]
    return (
        found[1],
        {key: plain(value, ("%3A", ":"), ("%2C", ",")) for key, value in pairs},
        plain(found[3]),
    )


def test_escapes_are_those_github_documents() -> None:
    assert escape_data("100%\r\n:,") == "100%25%0D%0A:,"
    assert escape_property("100%\r\n:,") == "100%25%0D%0A%3A%2C"


@given(st.text(max_size=60), st.text(max_size=30))
@settings(max_examples=100, deadline=None, derandomize=True)
def test_whatever_the_text_a_command_is_one_line_that_reads_back(message: str, file: str) -> None:
    line, _count = github_lines([graph(finding(message=message, file=file, help=""))])
    assert "\n" not in line
    assert "\r" not in line
    kind, properties, text = parse_command(line)
    assert (kind, properties["file"], text) == ("error", file, message)


def test_annotations_have_kind_file_and_place() -> None:
    lines = github_lines([graph(finding("warning"), finding("note", None), finding("error"))])
    commands = [parse_command(line) for line in lines[:-1]]
    assert [kind for kind, _, _ in commands] == ["error", "warning", "notice"]
    assert commands[0][1] == {"file": "graphs/a.yaml", "line": "3", "col": "5", "title": "rg validate RG200"}
    assert commands[2][1].keys() == {"file", "title"}
    assert commands[0][2] == "message\nhelp: help"


@pytest.mark.parametrize("count", [CAP - 1, CAP, CAP + 1, 40])
def test_no_kind_has_more_annotations_than_github_keeps(count: int) -> None:
    errors = [finding(line=n + 1, code="RG200" if n % 2 else "RG303", message=f"{n} ##[error]") for n in range(count)]
    lines = github_lines([graph(*errors, *(finding("note", n + 1) for n in range(3)))])
    commands = [parse_command(line) for line in lines if line.startswith("::")]
    shown = [command for command in commands if command[0] == "error"]
    assert len(shown) == min(count, CAP)
    assert sum(command[0] == "notice" for command in commands) == 3
    listed = [line for line in lines if line.startswith("- ")]
    if count <= CAP:
        assert not listed
        return
    rest = count - (CAP - 1)
    assert len(listed) == rest
    assert f"{rest} more errors" in shown[-1][1]["title"]
    assert sum(map(int, re.findall(r"RG\d+ x (\d+)", shown[-1][2]))) == rest
    assert not any("##[" in line for line in listed)  # the old form of a command, found anywhere in a line


def test_the_summary_is_appended_where_github_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("GITHUB_STEP_SUMMARY", raising=False)
    append_step_summary([graph(finding())])
    assert not list(tmp_path.iterdir())
    path = tmp_path / "summary.md"
    path.write_text("before\n")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(path))
    append_step_summary([graph(finding("warning"), finding(message=NASTY))])
    text = path.read_text()
    assert text.startswith("before\n")
    rows = [line for line in text.splitlines() if line.startswith("| ")]
    assert [row.split(" | ")[0] for row in rows] == ["| Severity", "| error", "| warning"]
    assert len(re.findall(r"(?<!\\)\|", rows[1])) == len(re.findall(r"(?<!\\)\|", rows[0]))
    assert "<b>" not in text
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(tmp_path / "no/such/folder/file"))
    with pytest.raises(RenderGraphError) as caught:
        append_step_summary([graph(finding())])
    assert caught.value.diagnostics[0].code == "RG560"


def test_the_summary_stays_below_github_s_limit() -> None:
    text = step_summary([graph(*(finding(message="x" * 5000, line=n + 1) for n in range(MOST_ROWS + 10)))])
    assert len(text.encode()) < 2**20
    assert "10 more" in text


# ---------------------------------------------------------------- SARIF


#: What the published schema lets each object of ours hold; it forbids all else.
ALLOWED = {
    "log": {"$schema", "version", "runs"},
    "run": {"tool", "automationDetails", "columnKind", "invocations", "artifacts", "results"},
    "driver": {"name", "version", "semanticVersion", "rules"},
    "rule": {"id", "shortDescription", "fullDescription", "help", "defaultConfiguration"},
    "invocation": {"executionSuccessful", "exitCode"},
    "result": {"ruleId", "ruleIndex", "level", "message", "locations", "partialFingerprints"},
    "location": {"physicalLocation"},
    "physicalLocation": {"artifactLocation", "region"},
    "artifactLocation": {"uri", "uriBaseId"},
    "region": {"startLine", "startColumn"},
}


def faults_of_sarif(log: Any) -> list[str]:
    """What breaks the structure that SARIF 2.1.0 prescribes (OASIS standard, sections 3.13 to 3.52)."""
    faults: list[str] = []

    def need(holds: bool, what: str) -> None:
        if not holds:
            faults.append(what)

    def text(value: Any, where: str) -> None:
        need(isinstance(value, dict) and isinstance(value.get("text"), str) and value["text"] != "", f"{where}.text")

    def only(kind: str, value: dict[str, Any]) -> None:
        need(value.keys() <= ALLOWED[kind], f"{kind} has {sorted(value.keys() - ALLOWED[kind])}")

    only("log", log)
    need(isinstance(log, dict) and log.get("version") == "2.1.0", "version")
    need("sarif-2.1.0" in str(log.get("$schema")), "$schema")
    need(isinstance(log.get("runs"), list) and len(log["runs"]) == 1, "runs")
    for run in log.get("runs") or []:
        driver = run.get("tool", {}).get("driver", {})
        only("run", run)
        only("driver", driver)
        need(bool(driver.get("name")), "driver.name")
        need(re.fullmatch(r"\d+\.\d+\.\d+", str(driver.get("semanticVersion"))) is not None, "semanticVersion")
        rules = driver.get("rules", [])
        need(len({rule.get("id") for rule in rules}) == len(rules), "rule ids are not distinct")
        for rule in rules:
            only("rule", rule)
            need(re.fullmatch(r"RG\d{3}", str(rule.get("id"))) is not None, "rule.id")
            for part in ("shortDescription", "fullDescription", "help"):
                text(rule.get(part), f"rule.{part}")
            need(
                rule.get("defaultConfiguration", {}).get("level") in ("none", "note", "warning", "error"), "rule level"
            )
        need(run.get("columnKind") in ("utf16CodeUnits", "unicodeCodePoints"), "columnKind")
        for invocation in run.get("invocations", []):
            only("invocation", invocation)
            need(isinstance(invocation.get("executionSuccessful"), bool), "executionSuccessful")
        need(isinstance(run.get("results"), list), "results")
        for result in run.get("results") or []:
            only("result", result)
            index = result.get("ruleIndex", -1)
            need(0 <= index < len(rules) and rules[index]["id"] == result.get("ruleId"), "ruleIndex")
            need(result.get("level") in ("none", "note", "warning", "error"), "level")
            text(result.get("message"), "message")
            need(len(result.get("locations", [])) == 1, "locations")
            for location in result.get("locations", []):
                place = location.get("physicalLocation", {})
                only("location", location)
                only("physicalLocation", place)
                only("artifactLocation", place["artifactLocation"])
                only("region", place.get("region", {}))
                uri = place.get("artifactLocation", {}).get("uri", "")
                need(re.fullmatch(r"[A-Za-z0-9._~%!$&'()*+,;=:@/-]+", uri) is not None, f"uri {uri}")
                need(uri.startswith("file:///") == ("uriBaseId" not in place["artifactLocation"]), "uriBaseId")
                region = place.get("region", {"startLine": 1, "startColumn": 1})
                need(region.get("startLine", 0) >= 1 and region.get("startColumn", 0) >= 1, "region")
    return faults


def sarif_of_many() -> dict[str, Any]:
    return sarif_log([
        graph(finding(), finding("warning", 7, "RG113"), finding("note", None, message=NASTY)),
        graph(finding(file="graphs/a b,ü#1.yaml"), finding(file="/else/where.yaml"), code=2, file="graphs/b.yaml"),
    ])  # fmt: skip


def test_sarif_has_the_published_structure() -> None:
    log = sarif_of_many()
    assert faults_of_sarif(log) == []
    results = log["runs"][0]["results"]
    assert [r["level"] for r in results] == ["error", "error", "error", "warning", "note"]
    uris = {unquote(r["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]) for r in results}
    assert uris == {"graphs/a.yaml", "graphs/a b,ü#1.yaml", "file:///else/where.yaml"}
    assert log["runs"][0]["invocations"] == [{"executionSuccessful": False, "exitCode": 2}]
    assert faults_of_sarif(sarif_log([graph(code=0)])) == []


@pytest.mark.parametrize(
    "spoil",
    [
        lambda log: log.update(version="2.0.0"),
        lambda log: log["runs"][0]["results"][0].update(file="graphs/a.yaml"),
        lambda log: log.update(runs=[]),
        lambda log: log["runs"][0]["tool"]["driver"].pop("name"),
        lambda log: log["runs"][0]["tool"]["driver"]["rules"][0]["help"].update(text=""),
        lambda log: log["runs"][0]["tool"]["driver"]["rules"].pop(),
        lambda log: log["runs"][0]["results"][0].update(level="fatal"),
        lambda log: log["runs"][0]["results"][0].update(ruleIndex=2),
        lambda log: log["runs"][0]["results"][0]["message"].pop("text"),
        lambda log: log["runs"][0]["results"][1]["locations"][0]["physicalLocation"]["region"].update(startLine=0),
        lambda log: log["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"].update(
            uri="a b"
        ),
    ],
)
def test_the_check_of_the_structure_can_fail(spoil: Callable[[Any], Any]) -> None:
    log = sarif_of_many()
    spoil(log)
    assert faults_of_sarif(log)


def test_every_code_makes_a_rule() -> None:
    findings = [finding(MESSAGES[code].severity, code=code) for code in MESSAGES]
    assert faults_of_sarif(sarif_log([graph(*findings)])) == []


def test_a_fingerprint_survives_lines_added_above() -> None:
    def mark(made: Finding) -> str:
        return str(sarif_log([graph(made)])["runs"][0]["results"][0]["partialFingerprints"])

    assert mark(finding(line=3)) == mark(finding(line=30))
    assert mark(finding()) != mark(finding(message="another"))


# ---------------------------------------------------------------- JUnit


def test_junit_has_one_case_a_graph() -> None:
    good, warned = graph(code=0, file="graphs/g.yaml"), graph(finding("warning"), code=0, file="graphs/w.yaml")
    bad, unreadable = graph(finding(), finding(line=8)), graph(finding(code="RG100"), code=2, file="graphs/u.yaml")
    root = ElementTree.fromstring(junit_xml([good, warned, bad, unreadable]))
    suite = root[0]
    assert (root.tag, suite.tag) == ("testsuites", "testsuite")
    for element in (root, suite):
        assert [element.get(key) for key in ("tests", "failures", "errors")] == ["4", "1", "1"]
    cases = {case.get("name"): case for case in suite}
    assert list(cases) == ["graphs/g.yaml", "graphs/w.yaml", "graphs/a.yaml", "graphs/u.yaml"]
    assert all(case.tag == "testcase" and case.get("classname") for case in suite)
    assert [child.tag for child in cases["graphs/g.yaml"]] == []
    assert [child.tag for child in cases["graphs/w.yaml"]] == ["system-out"]
    failure = cases["graphs/a.yaml"].find("failure")
    assert failure is not None
    assert failure.get("type") == "RG200"
    assert "graphs/a.yaml:3:5" in str(failure.text)
    assert "graphs/a.yaml:8:5" in str(failure.text)
    assert [child.tag for child in cases["graphs/u.yaml"]] == ["error"]


@given(st.text(max_size=60))
@settings(max_examples=100, deadline=None, derandomize=True)
def test_whatever_the_text_junit_is_well_formed(text: str) -> None:
    made = junit_xml([graph(finding(message=text, help=text, file=f"graphs/{text}"), finding("note", message=text))])
    assert ElementTree.fromstring(made.encode()).tag == "testsuites"
