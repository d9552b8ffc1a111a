"""Runs the command line in this process and collects what it printed and how it exited."""

from collections.abc import Callable
from dataclasses import dataclass

import pytest

from rendergraph.cli import main


@dataclass(frozen=True)
class Outcome:
    """Exit code, data and messages of a command."""

    code: int
    out: str
    err: str


Rg = Callable[..., Outcome]


@pytest.fixture
def rg(capsys: pytest.CaptureFixture[str]) -> Rg:
    """``rg("plan", "graph.yaml")`` as a user would type it."""

    def run(*arguments: str) -> Outcome:
        capsys.readouterr()
        with pytest.raises(SystemExit) as exited:
            main(arguments)
        captured = capsys.readouterr()
        code = exited.value.code
        assert isinstance(code, int)
        return Outcome(code, captured.out, captured.err)

    return run
