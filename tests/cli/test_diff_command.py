"""`rg diff` as it is typed: exit codes, gates, formats, refusals."""

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Rg
from tests.cli.refusal import assert_misused, assert_refused
from tests.report.diff_records import bench, resources, samples, timing, write


@pytest.fixture(autouse=True)
def _no_ci(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CI", raising=False)
    monkeypatch.delenv("GITHUB_STEP_SUMMARY", raising=False)


@pytest.fixture
def slower(tmp_path: Path) -> tuple[str, str]:
    """The same graph, a pass slower: nothing exact differs."""
    before = timing({"light": samples(2.0)})
    after = timing({"light": samples(3.0, seed=2)})
    return write(tmp_path / "a.json", before), write(tmp_path / "b.json", after)


def test_equal_records_pass(rg: Rg, slower: tuple[str, str]) -> None:
    outcome = rg("diff", slower[0], slower[0])
    assert outcome.code == 0, outcome.err
    assert "no regression" in outcome.out


def test_a_regression_exits_1_and_names_the_pass(rg: Rg, slower: tuple[str, str]) -> None:
    outcome = rg("diff", *slower)
    assert outcome.code == 1
    assert outcome.out.index("light") < outcome.out.index("whole frame")


@pytest.mark.parametrize(
    ("ci", "gate", "code"),
    [
        ("", None, 1),
        ("true", None, 0),
        ("1", None, 0),
        ("false", None, 1),
        ("true", "time", 1),
        ("true", "all", 1),
        ("", "exact", 0),
    ],
)
def test_gates(
    rg: Rg, slower: tuple[str, str], monkeypatch: pytest.MonkeyPatch, ci: str, gate: str | None, code: int
) -> None:
    monkeypatch.setenv("CI", ci)
    assert rg("diff", *slower, *(["--gate", gate] if gate else [])).code == code


def test_ci_fails_on_exact_regressions(rg: Rg, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CI", "true")
    a = write(tmp_path / "a.json", resources())
    b = write(tmp_path / "b.json", resources(alias=False))
    assert rg("diff", a, b).code == 1
    assert rg("diff", b, a).code == 0


def test_one_bench_file_compares_its_sides(rg: Rg, tmp_path: Path) -> None:
    path = write(tmp_path / "bench.json", bench(1.2))
    outcome = rg("diff", path, "--format", "json")
    assert outcome.code == 1
    assert json.loads(outcome.out)["times"][0]["name"] == "light.shade"
    assert rg("diff", f"{path}@A", f"{path}@A").code == 0


@pytest.mark.parametrize("form", ["text", "json", "markdown", "github"])
def test_every_format_has_the_same_exit_code(rg: Rg, slower: tuple[str, str], form: str) -> None:
    outcome = rg("diff", *slower, "--format", form)
    assert outcome.code == 1
    assert "light" in outcome.out


def test_floors_decide_what_counts(rg: Rg, slower: tuple[str, str]) -> None:
    assert rg("diff", *slower, "--floor", "70").code == 0
    assert rg("diff", *slower, "--floor-us", "2000").code == 0
    assert rg("diff", *slower, "--floor", "10", "--floor-us", "0").code == 1


def test_force(rg: Rg, slower: tuple[str, str], tmp_path: Path) -> None:
    other = write(tmp_path / "c.json", timing({"light": samples(2.0)}, size=[8, 8]))
    assert_refused(rg("diff", slower[0], other), 2, "RG736", "size")
    outcome = rg("diff", slower[0], other, "--force")
    assert outcome.code == 0
    assert "RG739" in outcome.err


def test_refusals(rg: Rg, slower: tuple[str, str], tmp_path: Path) -> None:
    assert_refused(rg("diff", slower[0], str(tmp_path / "gone.json")), 2, "RG730", "gone.json")
    assert_refused(rg("diff", slower[0]), 2, "RG737")
    path = write(tmp_path / "r.json", resources())
    assert_refused(rg("diff", path, path, "--gate", "time"), 2, "RG737", "time")
    cut = tmp_path / "cut.json"
    cut.write_text(Path(slower[0]).read_text()[:300])
    assert_refused(rg("diff", str(cut), slower[0]), 2, "RG731", "cut.json")


def test_misuse(rg: Rg, slower: tuple[str, str]) -> None:
    assert_misused(rg("diff"))
    assert_misused(rg("diff", *slower, "--gate", "some"), "--gate")
    assert_misused(rg("diff", *slower, "--alpha", "2"), "--alpha")
    assert_misused(rg("diff", *slower, "--floor", "-1"), "--floor")


def test_a_single_frame_is_no_verdict(rg: Rg, tmp_path: Path) -> None:
    one = write(tmp_path / "a.json", timing({"light": [1.0]}, frame=[1.0]))
    far = write(tmp_path / "b.json", timing({"light": [9.0]}, frame=[9.0]))
    outcome = rg("diff", one, far)
    assert outcome.code == 0
    assert "RG738" in outcome.err
    assert "inconclusive" in outcome.out
    assert "unchanged" not in outcome.out
