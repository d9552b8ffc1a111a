"""`rg new`: what it writes works as it is, whatever the name."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Rg
from tests.cli.refusal import assert_refused, run_rg


@pytest.mark.gpu
def test_a_new_graph_renders(rg: Rg, tmp_path: Path) -> None:
    assert rg("new", "graph", str(tmp_path / "my_frame")).code == 0
    out = tmp_path / "out"
    outcome = rg("render", str(tmp_path / "my_frame.yaml"), "-o", str(out), "--size", "32x18", "--samples", "0")
    assert outcome.code == 0, outcome.err
    assert (out / "my_frame.png").exists()


@pytest.mark.parametrize(
    "name", ["123", "null", 'a, b: {c} "d', "it's # here", "-", "$name", "ünï", "new\nline", "x.yml", "caf\udce9"]
)
def test_a_new_graph_of_any_name_is_valid(rg: Rg, tmp_path: Path, name: str) -> None:
    assert rg("new", "graph", str(tmp_path / name)).code == 0
    (path,) = tmp_path.iterdir()
    outcome = rg("validate", str(path))
    assert (outcome.code, outcome.err) == (0, "")


@pytest.mark.parametrize("arguments", [["graph", "x/y.yaml"], ["node", "y", "--folder", "x"]])
def test_no_folder_is_made_on_the_way(
    rg: Rg, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    outcome = rg("new", *arguments)
    assert outcome.code == 2
    assert "RG574" in outcome.err
    assert not any(tmp_path.iterdir())
    (tmp_path / "x").mkdir()
    assert rg("new", *arguments).code == 0


def test_a_name_too_long_for_the_file_system_is_refused(rg: Rg, tmp_path: Path) -> None:
    outcome = rg("new", "graph", str(tmp_path / ("n" * 300)))
    assert (outcome.code, "RG560" in outcome.err) == (2, True)


@pytest.fixture
def installed(rg: Rg, tmp_path: Path) -> dict[str, str]:
    """The environment of a process that sees a new node's package as if it were installed."""
    assert rg("new", "node", "my_blur", "--folder", str(tmp_path)).code == 0
    package = tmp_path / "my_blur"
    facts = tmp_path / "site" / "rendergraph_my_blur-0.1.0.dist-info"
    facts.mkdir(parents=True)
    (facts / "METADATA").write_text("Metadata-Version: 2.1\nName: rendergraph-my-blur\nVersion: 0.1.0\n")
    (facts / "entry_points.txt").write_text("[rendergraph.nodes]\nmy_blur = rendergraph_my_blur\n")
    return os.environ | {"PYTHONPATH": f"{package}{os.pathsep}{tmp_path / 'site'}"}


@pytest.mark.gpu
def test_a_new_node_passes_its_own_test(tmp_path: Path, installed: dict[str, str]) -> None:
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests"]
    done = subprocess.run(command, cwd=tmp_path / "my_blur", env=installed, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert "2 passed" in done.stdout


def test_a_new_node_is_listed_and_its_example_is_valid(tmp_path: Path, installed: dict[str, str]) -> None:
    outcome = run_rg(["nodes", "my_blur"], env=installed)
    assert outcome.code == 0, outcome.err
    assert "strength" in outcome.out
    assert run_rg(["validate", tmp_path / "my_blur" / "example.yaml"], env=installed).code == 0


def test_a_node_that_cannot_be_imported_is_told_apart(tmp_path: Path, installed: dict[str, str]) -> None:
    (tmp_path / "my_blur" / "rendergraph_my_blur" / "__init__.py").write_text("import no_such_module_at_all\n")
    example = tmp_path / "my_blur" / "example.yaml"
    outcome = run_rg(["validate", example], env=installed)
    assert outcome.code == 1
    assert "RG207" in outcome.err
    assert "no_such_module_at_all" in outcome.err
    assert "example.yaml:13:" in outcome.err
    assert "Traceback" not in outcome.err
    listed = run_rg(["nodes"], env=installed)
    assert listed.code == 0, listed.err
    assert "tonemap" in listed.out
    assert "RG207" in listed.err
    assert run_rg(["schema"], env=installed).code == 0
    assert_refused(run_rg(["nodes", "my_blur"], env=installed), 1, "RG207", "no_such_module_at_all")
