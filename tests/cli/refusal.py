"""What every refusal owes the user, and the small graph that the tests break."""

import re
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from tests.cli.conftest import Outcome

SHADER = "#version 450\nout vec4 o_color;\nvoid main() { o_color = vec4(0.5, 0.25, 0.125, 1.0); }\n"
A = "  a: {format: rgba16f}\n"
PAINT = "  paint: {node: fullscreen, write: {o_color: a}, set: {shader: paint.frag}}\n"
SHOW = "  show: {node: tonemap, read: {color: a}, write: {color: image}, set: {curve: linear}}\n"
IMAGE = "{image: {file: image.png}}"


def write_graph(
    folder: Path,
    *,
    resources: str = A,
    passes: str = PAINT + SHOW,
    outputs: str = IMAGE,
    extra: str = "",
    shader: str | bytes = SHADER,
) -> Path:
    """A graph of two passes with parts replaced, and its shader ``paint.frag``."""
    text = shader if isinstance(shader, bytes) else shader.encode()
    (folder / "paint.frag").write_bytes(text)
    path = folder / "graph.yaml"
    path.write_text(
        f"rendergraph: 1\nframe: {{size: [32, 18]}}\n{extra}resources:\n{resources}"
        f"passes:\n{passes}outputs: {outputs}\n"
    )
    return path


def assert_refused(outcome: Outcome, exit_code: int, code: str, *named: str, folder: Path | None = None) -> None:
    """The exit code, the diagnostic's code, its ``help:`` line, every text it must name, and nothing left behind."""
    assert outcome.code == exit_code, outcome.err
    assert "Traceback" not in outcome.err
    assert code in re.findall(r"RG\d{3}", outcome.err)
    assert re.search(r"^  help: \S", outcome.err, re.MULTILINE)
    for text in named:
        assert text in outcome.err
    if folder is not None:
        assert not folder.exists() or not any(folder.iterdir())


def assert_misused(outcome: Outcome, *named: str) -> None:
    """A mistake of the command line: exit code 2, what is wrong, and where the usage is told."""
    assert outcome.code == 2, outcome.err
    assert "Traceback" not in outcome.err
    assert "--help" in outcome.err
    for text in named:
        assert text in outcome.err


RUN = "import sys; from rendergraph.cli import main; main(sys.argv[1:])"


def run_rg(
    arguments: Sequence[str | Path | bytes],
    *,
    env: dict[str, str] | None = None,
    before: Callable[[], None] | None = None,
    cwd: Path | None = None,
) -> Outcome:
    """``rg`` in a process of its own; ``before`` runs in it first."""
    done = subprocess.run(
        [sys.executable, "-c", RUN, *arguments], capture_output=True, env=env, preexec_fn=before, cwd=cwd, check=False
    )
    return Outcome(done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace"))
