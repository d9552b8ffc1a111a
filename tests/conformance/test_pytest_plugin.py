"""`pytest --rg-node` in the folder of somebody else's package."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from tests.conformance.tidy_node import FILES

PLUGIN = "rendergraph.conformance.pytest_plugin"


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package `tidy_package.tidy` as if installed; its folder."""
    folder = tmp_path / "tidy_package" / "tidy"
    folder.mkdir(parents=True)
    (folder.parent / "__init__.py").touch()
    for name, text in FILES.items():
        (folder / name).write_text(text)
    facts = tmp_path / "tidy-0.1.dist-info"
    facts.mkdir()
    (facts / "METADATA").write_text("Metadata-Version: 2.1\nName: tidy\nVersion: 0.1\n")
    (facts / "entry_points.txt").write_text("[rendergraph.nodes]\ntidy = tidy_package.tidy\n")
    return folder


def run_pytest(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    root = folder.parent.parent
    path = os.pathsep.join([str(root), str(Path(__file__).parent.parent.parent)])
    installed = any(entry.value == PLUGIN for entry in entry_points(group="pytest11"))
    plugin = [] if installed else ["-p", PLUGIN]
    command = [sys.executable, "-m", "pytest", *plugin, "-p", "no:cacheprovider", "-ra", "-v", *arguments]
    return subprocess.run(
        command, cwd=root, env=os.environ | {"PYTHONPATH": path}, capture_output=True, text=True, timeout=120
    )


@pytest.mark.gpu
def test_a_good_package_passes(package: Path) -> None:
    done = run_pytest(package, "--rg-node", "tidy_package.tidy")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "10 passed" in done.stdout


@pytest.mark.gpu
def test_a_bad_one_fails_with_code_and_reason_and_no_traceback(package: Path) -> None:
    (package / "README.md").unlink()
    done = run_pytest(package, "--rg-node", "tidy", "-k", "readme or parameters")
    assert done.returncode == 1
    assert "1 failed, 1 passed, 8 deselected" in done.stdout
    assert "RG781 no_readme" in done.stdout
    assert "Traceback" not in done.stdout
    assert "pytest_plugin.py" not in done.stdout


def test_an_unknown_node_is_a_wrong_use(package: Path) -> None:
    done = run_pytest(package, "--rg-node", "tidy_package.tiddy")
    assert done.returncode == 4
    assert "RG794" in done.stderr
    assert "Traceback" not in done.stderr


def test_the_plugin_imports_nothing_heavy_until_asked() -> None:
    script = (
        f"import sys, {PLUGIN}\n"
        "heavy = {'numpy', 'moderngl', 'pydantic', 'typer', 'rich', 'yaml', 'rendergraph.document'}\n"
        "print(sorted(heavy & sys.modules.keys()))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (done.stdout.strip(), done.stderr) == ("[]", "")


def test_it_is_declared_as_a_plugin() -> None:
    text = (Path(__file__).parent.parent.parent / "pyproject.toml").read_text()
    assert f'[project.entry-points.pytest11]\nrendergraph = "{PLUGIN}"' in text
