"""`rg validate --format ...` as CI systems run it."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.cli.conftest import Rg
from tests.cli.refusal import assert_misused, write_graph

FORMATS = ("text", "json", "github", "sarif", "junit")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository with one graph of two errors, one sound one, and none called ``missing.yaml``."""
    subprocess.run(["git", "init", "--quiet", tmp_path], check=True)
    (tmp_path / "graphs").mkdir()
    write_graph(tmp_path / "graphs").rename(tmp_path / "graphs/good.yaml")
    write_graph(tmp_path / "graphs", resources="  a: {format: rgba17f}\n", outputs="{image: {fil: x.png}}")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("GITHUB_STEP_SUMMARY", raising=False)
    return tmp_path


@pytest.mark.parametrize("format", FORMATS)
def test_exit_codes_are_the_same_in_every_format(rg: Rg, folder: Path, format: str) -> None:
    good, bad = "graphs/good.yaml", "graphs/graph.yaml"
    assert rg("validate", good, "--format", format).code == 0
    assert rg("validate", good, bad, "--format", format).code == 1
    assert rg("validate", bad, "missing.yaml", good, "--format", format).code == 2
    assert_misused(rg("validate", good, "--format", "xml"))


def test_data_is_on_stdout_and_whole(rg: Rg, folder: Path) -> None:
    arguments = ("validate", "graphs/graph.yaml", "graphs/good.yaml", "--format")
    outcomes = {format: rg(*arguments, format) for format in FORMATS}
    assert all(not outcome.err for format, outcome in outcomes.items() if format != "text")
    codes = [entry["code"] for entry in json.loads(outcomes["json"].out)]
    assert codes == ["RG303", "RG120", "RG121"]
    assert {entry["file"] for entry in json.loads(outcomes["json"].out)} == {"graphs/graph.yaml"}
    assert re.findall(r"^::error file=graphs/graph.yaml,.*(RG\d+)::", outcomes["github"].out, re.M) == codes
    results = json.loads(outcomes["sarif"].out)["runs"][0]["results"]
    assert [result["ruleId"] for result in results] == codes
    root = ElementTree.fromstring(outcomes["junit"].out)
    assert (root.get("tests"), root.get("failures")) == ("2", "1")


def test_errors_are_first_in_text_too(rg: Rg, folder: Path) -> None:
    unused = "  a: {format: rgba16f}\n  unused: {format: r8}\n"
    late = "barriers: [{resource: a, after: nowhere, before: show, kind: uniform}]\n"
    path = write_graph(folder / "graphs", resources=unused)
    path.write_text(path.read_text() + late)
    found = re.findall(r"RG\d{3}", rg("validate", str(path)).err)
    assert found.index("RG219") < found.index("RG214") if "RG214" in found else found == ["RG219"]


def test_github_gets_a_summary(rg: Rg, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(folder / "summary.md"))
    rg("validate", "graphs/graph.yaml", "--format", "sarif")
    assert not (folder / "summary.md").exists()
    rg("validate", "graphs/graph.yaml", "--format", "github")
    assert "RG303" in (folder / "summary.md").read_text()


def test_exact_budgets_are_checked_and_flip_is_noted(rg: Rg, folder: Path) -> None:
    path = write_graph(folder / "graphs", extra="budget: {transient_mib: 0.001, flip: 0.1}\n")
    outcome = rg("validate", str(path))
    assert (outcome.code, re.findall(r"RG\d{3}", outcome.err)) == (1, ["RG703", "RG709"])
    outcome = rg("validate", "deferred_shading", "--set", "budget.transient_mib=1")
    assert (outcome.code, re.findall(r"RG\d{3}", outcome.err)) == (0, ["RG705"])


def test_no_format_imports_numpy_or_moderngl(folder: Path) -> None:
    code = (
        "import sys; from rendergraph.cli import main\n"
        f"for format in {FORMATS}:\n"
        "    try:\n"
        "        main(['validate', 'graphs/graph.yaml', 'deferred_shading', '--format', format])\n"
        "    except SystemExit as e:\n"
        "        assert e.code == 1, e.code\n"
        "    assert not {'numpy', 'moderngl'} & set(sys.modules), format"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
