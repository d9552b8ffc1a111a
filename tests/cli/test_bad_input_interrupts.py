"""Ctrl-C at every stage of a render, and two renders into one folder at once."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from tests.cli.refusal import RUN, write_graph

pytestmark = pytest.mark.gpu

#: The command line, with each step of the progress bar as a line on stderr.
TALKING = """
import sys
from contextlib import contextmanager
from rendergraph.cli import console, main

@contextmanager
def progress_bar():
    yield lambda stage, done, total: print(f"<{stage} {done}>", file=sys.stderr, flush=True)

console.progress_bar = progress_bar
main(sys.argv[1:])
"""


def interrupt_at(moment: str, arguments: list[str]) -> tuple[int, str]:
    """The exit code and stderr of a command sent SIGINT when its progress reaches ``moment``."""
    with subprocess.Popen(
        [sys.executable, "-c", TALKING, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None
        text = ""
        for line in process.stderr:
            text += line
            if line.strip() == moment:
                process.send_signal(signal.SIGINT)
        process.wait(timeout=60)
        return process.returncode, text


@pytest.mark.parametrize(
    ("moment", "graph"),
    [("<planning 0>", "deferred_shading"), ("<compiling 3>", "deferred_shading"), ("<rendering 3>", "own")],
)
def test_ctrl_c(tmp_path: Path, moment: str, graph: str) -> None:
    out = tmp_path / "out"
    (tmp_path / "own").mkdir()
    own = str(write_graph(tmp_path / "own", outputs="{image: {file: 'frame_{frame}.png'}}"))
    code, text = interrupt_at(
        moment,
        [
            "render", own if graph == "own" else graph, "-o", str(out), "--samples", "0",
            "--scene", "cornell", "--size", "32x18", "--frames", "2000",
        ],
    )  # fmt: skip
    assert moment in text  # or nothing was interrupted
    assert code == 130
    assert text.endswith("interrupted\n")
    assert "Traceback" not in text
    assert "Exception ignored" not in text
    finished = sorted(out.iterdir()) if out.exists() else []
    if moment.startswith("<rendering"):  # frames are written as they come: those before the interruption, each whole
        assert 3 <= len(finished) < 2000
    else:
        assert not finished
    for number, path in enumerate(finished):
        assert path.name == f"frame_{number:04d}.png"
        with Image.open(path) as image:
            image.load()


def test_ctrl_c_while_a_variant_is_compiled_by_the_driver(tmp_path: Path) -> None:
    """The first frame is where software drivers translate shaders, inside a call that Python cannot break off."""
    out = tmp_path / "out"
    arguments = ["render", "deferred_shading", "--scene", "cornell", "--size", "32x18", "-o", str(out)]
    code, text = interrupt_at("<rendering 0>", arguments)
    assert code == 130
    assert "Traceback" not in text
    assert not out.exists()


def test_two_renders_into_one_folder(tmp_path: Path) -> None:
    graph, out = str(write_graph(tmp_path)), tmp_path / "out"
    command = [sys.executable, "-c", RUN, "render", graph, "-o", str(out), "--samples", "0"]
    runs = [subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    for run in runs:
        _, err = run.communicate(timeout=60)
        assert run.returncode == 0, err
    assert sorted(path.name for path in out.iterdir()) == ["image.png", "resources.json", "timing.json"]
    with Image.open(out / "image.png") as image:
        image.load()
    assert json.loads((out / "timing.json").read_text())["schema"]
