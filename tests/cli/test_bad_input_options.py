"""Mistakes on the command line itself."""

from pathlib import Path

import pytest

from tests.cli.conftest import Rg
from tests.cli.refusal import PAINT, SHOW, A, assert_misused, assert_refused, run_rg, write_graph


@pytest.mark.parametrize(
    "arguments",
    [
        ["--size", "0x5"],
        ["--size", "-3x5"],
        ["--size", "16385x5"],
        ["--size", "axb"],
        ["--size", "10x"],
        ["--size", "10"],
        ["--size", "²x3"],
        ["--size", "9" * 5000 + "x3"],
        ["--size", ""],
        ["--frames", "0"],
        ["--frames", "10001"],
        ["--frames", "x"],
        ["--order", "best"],
        ["--format", "xml"],
        ["--order-seed", "-1"],
        ["--nonsense"],
        ["another.yaml"],
    ],
    ids=lambda arguments: " ".join(arguments)[:20],
)
def test_nonsense_for_an_option(rg: Rg, tmp_path: Path, arguments: list[str]) -> None:
    graph = str(write_graph(tmp_path))
    assert_misused(rg("plan", graph, *arguments), *arguments[:1])
    assert_misused(rg("render", graph, "-o", str(tmp_path / "out"), *arguments), *arguments[:1])
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "arguments", [["--samples", "-1"], ["--samples", "1001"], ["--device", "-1"], ["--device", "x"]], ids=" ".join
)
def test_nonsense_for_an_option_of_render(rg: Rg, tmp_path: Path, arguments: list[str]) -> None:
    assert_misused(rg("render", str(write_graph(tmp_path)), *arguments))


@pytest.mark.parametrize(
    ("override", "exit_code", "code", "named"),
    [
        ("nonsense", 2, "RG130", "path=value"),
        ("", 2, "RG130", "path=value"),
        ("=3", 2, "RG130", "path=value"),
        ("a..b=1", 2, "RG130", "a..b"),
        ("passes.nope.set.x=3", 2, "RG131", "paint, show"),
        ("outputs.nope.file=x.png", 1, "RG213", "image"),
        ("passes.show.set.curve=[1", 2, "RG104", "bracket"),
        ("passes.show.set.curve=banana", 1, "RG205", "agx"),
        ("passes.show.set.crv=agx", 1, "RG204", "curve"),
        ("frame.size=banana", 1, "RG122", "[a, b]"),
        ("frame.count=0", 1, "RG123", "at least 1"),
        ("frame.count=.nan", 1, "RG122", "frame.count"),
        ("outputs.image.file=../x.png", 1, "RG127", "../x.png"),
        ("rendergraph=2", 1, "RG124", "rendergraph"),
        ("frame={size: [1, 1], size: [2, 2]}", 1, "RG105", "size"),
    ],
)
def test_overrides_that_make_no_sense(
    rg: Rg, tmp_path: Path, override: str, exit_code: int, code: str, named: str
) -> None:
    out = tmp_path / "out"
    outcome = rg("render", str(write_graph(tmp_path)), "-o", str(out), "--set", override)
    assert_refused(outcome, exit_code, code, f"--set {override}:", named)
    assert not out.exists()


@pytest.mark.parametrize(
    ("scene", "code", "named"),
    [
        ("sphers", "RG650", "'spheres'"),
        ("/etc/passwd", "RG650", ".glb"),
        ("gone.glb", "RG651", "working directory"),
        ("x" * 300 + ".glb", "RG651", "too long"),
        (".", "RG650", ".glb"),
    ],
)
def test_scenes_that_are_not_there(rg: Rg, tmp_path: Path, scene: str, code: str, named: str) -> None:
    outcome = rg("render", str(write_graph(tmp_path)), "-o", str(tmp_path / "out"), "--scene", scene)
    assert_refused(outcome, 2, code, named)
    assert not (tmp_path / "out").exists()


def test_captures_of_nothing_of_the_culled_and_over_an_output(rg: Rg, tmp_path: Path) -> None:
    spare = "  lost: {node: clear, write: {target: spare}}\n"
    graph = str(write_graph(tmp_path, resources=A + "  spare: {format: r8}\n", passes=PAINT + SHOW + spare))
    out = tmp_path / "out"
    assert_refused(rg("render", graph, "-o", str(out), "--capture", "nothing"), 2, "RG564", "'nothing'", "a, image")
    assert_refused(rg("render", graph, "-o", str(out), "--capture", "spare"), 2, "RG564", "'spare'")
    over = rg("render", graph, "-o", str(out), "--capture", "a", "--set", "outputs.image.file=a.png")
    assert_refused(over, 2, "RG568", "a.png", "--set outputs.image.file=a.png:")
    assert not out.exists()


@pytest.mark.gpu
def test_a_device_that_is_not_there() -> None:
    outcome = run_rg(["render", "deferred_shading", "--size", "32x18", "--scene", "cornell", "--device", "99"])
    assert_refused(outcome, 3, "RG503", "99", "rg doctor")


@pytest.mark.parametrize(
    ("arguments", "code", "named"),
    [
        (["explain", "RG999"], "RG227", "RG999"),
        (["explain", "RG9999"], "RG227", "RG9999"),
        (["explain", "deferred_shading", "ghost", "--scene", "cornell"], "RG228", "ghost"),
        (["explain", "gone.yaml"], "RG100", "gone.yaml"),
        (["nodes", "tonemp"], "RG570", "'tonemap'"),
        (["new", "node", "class"], "RG572", "'class'"),
        (["new", "node", "../x"], "RG572", "'../x'"),
        (["new", "graph", "/dev/null/x.yaml"], "RG560", "/dev/null/x.yaml"),
        (["new", "node", "blur", "--folder", "/dev/null"], "RG560", "/dev/null/blur"),
    ],
)
def test_other_commands(rg: Rg, arguments: list[str], code: str, named: str) -> None:
    assert_refused(rg(*arguments), 2, code, named)


@pytest.mark.parametrize("arguments", [["render"], ["validate"], ["nonsense"], ["new", "thing"], ["graph"]])
def test_commands_without_what_they_need(rg: Rg, arguments: list[str]) -> None:
    assert_misused(rg(*arguments))
