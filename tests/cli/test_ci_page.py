"""docs/ci.md: its workflows parse, install with pip alone, and their commands work where there is no OpenGL."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from rendergraph.document.load import load_document
from rendergraph.document.messages import MESSAGES
from rendergraph.document.models import BudgetModel
from rendergraph.plan.plan import PlanOptions
from rendergraph.plan.validate import plan_without_scene
from rendergraph.report.plan_lock import plan_lock, write_lock
from rendergraph.report.resources import resources_record
from tests.cli.refusal import RUN, write_graph

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/ci.md").read_text(encoding="utf-8")
BLOCKS = [yaml.safe_load(text) for text in re.findall(r"^```yaml\n(.*?)^```", PAGE, re.M | re.S)]
INSTALL = "pip install -r requirements.txt"


def github_commands() -> list[str]:
    job = next(block for block in BLOCKS if "jobs" in block)["jobs"]["graphs"]
    return [step["run"] for step in job["steps"] if "run" in step]


def gitlab_commands() -> list[str]:
    script: list[str] = next(block for block in BLOCKS if "graphs" in block)["graphs"]["script"]
    return [script[0], "\n".join(script[1:])]


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A repository with two graphs and their locks, and an ``rg`` on its own PATH."""
    for name in ("first", "second"):
        (tmp_path / "graphs").mkdir(exist_ok=True)
        write_graph(tmp_path / "graphs").rename(tmp_path / f"graphs/{name}.yaml")
        plan, _ = plan_without_scene(load_document(tmp_path / f"graphs/{name}.yaml"), PlanOptions())
        write_lock(tmp_path / f"graphs/{name}.lock.json", plan_lock(resources_record(plan)))
    subprocess.run(["git", "init", "--quiet", tmp_path], check=True)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/rg").write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -c {shlex.quote(RUN)} "$@"\n')
    (tmp_path / "bin/rg").chmod(0o755)
    return tmp_path


def run(folder: Path, command: str) -> subprocess.CompletedProcess[str]:
    """A step as a runner runs it, on a machine without EGL."""
    env = os.environ | {
        "PATH": f"{folder / 'bin'}:{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "GLCONTEXT_LINUX_LIBEGL": "/nonexistent",
        "GITHUB_STEP_SUMMARY": str(folder / "summary.md"),
    }
    return subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", command],
        cwd=folder,
        env=env,
        capture_output=True,
        text=True,
        check=False,
    )


def steps(folder: Path, commands: list[str]) -> list[int]:
    return [run(folder, command).returncode for command in commands if command != INSTALL]


@pytest.mark.parametrize("commands", [github_commands(), gitlab_commands()], ids=["github", "gitlab"])
def test_the_workflows_install_with_pip_alone_and_pass_without_opengl(repository: Path, commands: list[str]) -> None:
    assert commands[0] == INSTALL
    assert not any(word in "\n".join(commands[1:]) for word in ("apt", "pip", "docker", "rg render"))
    assert run(repository, "rg doctor").returncode == 3  # there is no OpenGL indeed
    assert set(steps(repository, commands)) == {0}


@pytest.mark.parametrize("commands", [github_commands(), gitlab_commands()], ids=["github", "gitlab"])
def test_the_workflows_fail_on_a_broken_graph_and_on_a_changed_plan(repository: Path, commands: list[str]) -> None:
    whole = (repository / "graphs/first.yaml").read_text()
    (repository / "graphs/first.yaml").write_text(whole.replace("rgba16f", "rgba32f"))
    assert 1 in steps(repository, commands)
    (repository / "graphs/first.yaml").write_text(whole.replace("rgba16f", "rgba17f"))
    assert steps(repository, commands)[0] == 1  # GitHub's validation, and GitLab's only step


def test_gitlab_s_report_is_written_when_it_fails(repository: Path) -> None:
    artifact = next(block for block in BLOCKS if "graphs" in block)["graphs"]["artifacts"]
    (repository / "graphs/first.yaml").write_text("rendergraph: 1\n")
    steps(repository, gitlab_commands())
    assert artifact["when"] == "always"
    assert "<failure" in (repository / artifact["reports"]["junit"]).read_text()


def test_every_other_command_of_the_page_is_one_of_the_tool_s() -> None:
    mentioned = set(re.findall(r"`?rg (\w+)", PAGE))
    assert mentioned <= {"validate", "plan", "render", "doctor"}
    options = set(re.findall(r"(?<![-|])(--[a-z][a-z-]*)", PAGE))
    shown = "".join(
        subprocess.run([sys.executable, "-c", RUN, name, "--help"], capture_output=True, text=True, check=True).stdout
        for name in ("plan", "render", "validate")
    )
    assert [option for option in sorted(options) if option not in shown] == []


def test_codes_and_budgets_of_the_page_exist() -> None:
    assert set(re.findall(r"RG\d{3}", PAGE)) <= set(MESSAGES)
    budget: dict[str, Any] = next(block for block in BLOCKS if "budget" in block)["budget"]
    BudgetModel.model_validate(budget)


def test_the_pre_commit_hook(repository: Path) -> None:
    (hook,) = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
    assert hook["id"] in PAGE
    assert (hook["types"], hook["require_serial"], hook["language"]) == (["yaml"], True, "python")
    assert re.search(hook["files"], "project/graphs/first.yaml")
    assert re.search(hook["files"], "graphs/first.yml")
    assert not re.search(hook["files"], "graphs/shaders/settings.yaml")
    files = "graphs/first.yaml graphs/second.yaml"
    assert run(repository, f"{hook['entry']} {files}").returncode == 0
    (repository / "graphs/second.yaml").write_text("rendergraph: 2\n")
    assert run(repository, f"{hook['entry']} {files}").returncode == 1
