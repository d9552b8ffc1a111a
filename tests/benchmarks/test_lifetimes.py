"""The table of memory in the docs is of the graphs that are shipped, as they are planned today."""

from pathlib import Path

import pytest

from benchmarks.lifetimes import main

PAGE = Path(__file__).resolve().parents[2] / "docs" / "lifetimes.md"


def test_the_table_is_current(capsys: pytest.CaptureFixture[str]) -> None:
    main()
    written = PAGE.read_text(encoding="utf-8")
    assert capsys.readouterr().out == written, "write it anew: python -m benchmarks.lifetimes > docs/lifetimes.md"
