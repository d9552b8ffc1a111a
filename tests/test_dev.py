"""The `./dev` script where it can install nothing: it must say what to type, and exit with 3."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

#: What the script itself needs; everything else is missing on the machine that the test makes up.
TOOLS = ("bash", "dirname", "env", "sed")


def machine(folder: Path, **commands: str) -> Path:
    """A folder to be the whole PATH: the script's own tools, and stubs given as shell bodies."""
    path = folder / "bin"
    path.mkdir()
    for tool in TOOLS:
        (path / tool).symlink_to(shutil.which(tool) or tool)
    for name, body in commands.items():
        stub = path / name.replace("_", "-")
        stub.write_text(f"#!{path}/bash\n{body}\n")
        stub.chmod(0o755)
    return path


def dev(path: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run the script with nobody at the terminal."""
    environment = {**os.environ, "PATH": str(path)}
    command = [str(ROOT / "dev"), *arguments]
    return subprocess.run(  # the tree is not touched: every case stops before uv
        command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, timeout=60
    )


@pytest.mark.parametrize("arguments", [(), ("dmeo",)])
def test_usage(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    result = dev(machine(tmp_path), *arguments)
    assert result.returncode == 2
    assert "./dev demo" in result.stderr


@pytest.mark.parametrize(
    ("commands", "line"),
    [
        # Debian, an ordinary user without sudo.
        ({"id": "echo 1000", "dpkg_query": "exit 1"}, "su -c 'apt-get update && apt-get install -y"),
        # Debian, a user whose sudo asks for a password that nobody is there to type.
        (
            {"id": "echo 1000", "dpkg_query": "exit 1", "sudo": "exit 1"},
            "sudo apt-get update && sudo apt-get install -y",
        ),
        # Debian, root, but the network or the disk fails.
        ({"id": "echo 0", "dpkg_query": "exit 1", "apt_get": "exit 100"}, "    apt-get update && apt-get install -y"),
    ],
)
def test_prints_the_line_to_type(tmp_path: Path, commands: dict[str, str], line: str) -> None:
    result = dev(machine(tmp_path, **commands), "demo")
    assert result.returncode == 3
    assert line in result.stderr
    assert "--no-install-recommends libegl1 libgl1-mesa-dri" in result.stderr


def test_no_debian(tmp_path: Path) -> None:
    result = dev(machine(tmp_path, id="echo 0"), "setup")
    assert result.returncode == 3
    assert "python3" in result.stderr


def test_present_packages_are_not_installed_again(tmp_path: Path) -> None:
    commands = {
        "id": "echo 0",
        "dpkg_query": "printf installed",
        "apt_get": f"touch {tmp_path}/called",
        "uv": "exit 1",  # ends the run where the environment would begin
    }
    result = dev(machine(tmp_path, **commands), "demo")
    assert result.returncode == 3
    assert "uv sync --locked" in result.stderr
    assert not (tmp_path / "called").exists()
