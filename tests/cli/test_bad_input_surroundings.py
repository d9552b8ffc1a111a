"""What the tool stands on fails: no OpenGL, no permission, a full disk, a closed or broken stdout, odd file names."""

import ctypes
import errno
import os
import pty
import re
import resource
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import Rg
from tests.cli.refusal import PAINT, RUN, SHADER, assert_refused, run_rg, write_graph

APT_LINE = "sudo apt-get install -y --no-install-recommends libegl1 libgl1-mesa-dri"


# ---------------------------------------------------------------- no OpenGL


@pytest.mark.parametrize("command", [["render", "-o", "out", "graph.yaml"], ["doctor"]], ids=["render", "doctor"])
def test_without_opengl_the_line_to_type_is_given(tmp_path: Path, command: list[str]) -> None:
    write_graph(tmp_path)
    env = os.environ | {"GLCONTEXT_LINUX_LIBEGL": "/nonexistent"}
    outcome = run_rg(command, env=env, cwd=tmp_path)
    assert outcome.code == 3
    assert "RG501" in outcome.err + outcome.out
    assert APT_LINE in outcome.err + outcome.out
    assert "help:" in outcome.err + outcome.out
    assert "Traceback" not in outcome.err
    assert not (tmp_path / "out").exists()


def test_without_opengl_the_rest_works(tmp_path: Path) -> None:
    graph = str(write_graph(tmp_path))
    commands = [["validate", graph], ["plan", graph], ["graph", graph], ["explain", graph], ["nodes"], ["schema"]]
    code = "import sys; from rendergraph.cli import main\n"
    for command in commands:
        code += f"try: main({command!r})\nexcept SystemExit as ended: assert ended.code == 0, {command!r}\n"
    env = os.environ | {"GLCONTEXT_LINUX_LIBEGL": "/nonexistent"}
    done = subprocess.run([sys.executable, "-c", code], env=env, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


# ---------------------------------------------------------------- permission


def give_up_privileges() -> None:
    """Let root, too, be refused: drop CAP_DAC_OVERRIDE and CAP_DAC_READ_SEARCH before the program is started."""
    if os.geteuid() == 0:
        prctl, cap_bset_drop = ctypes.CDLL(None).prctl, 24
        for capability in (1, 2):
            prctl(cap_bset_drop, capability, 0, 0, 0)


@pytest.fixture
def locked(tmp_path: Path) -> Path:
    """A folder nobody may write into."""
    folder = tmp_path / "locked"
    folder.mkdir()
    folder.chmod(0o555)
    return folder


def test_no_permission_to_write_is_told_before_rendering(tmp_path: Path, locked: Path) -> None:
    graph = write_graph(tmp_path, shader="this shader would not even compile")
    for folder in (locked, locked / "deeper" / "still"):
        outcome = run_rg(["render", graph, "-o", folder], before=give_up_privileges)
        assert_refused(outcome, 2, "RG560", str(folder), "no permission", folder=locked)


def test_no_permission_to_write_a_new_graph(locked: Path) -> None:
    outcome = run_rg(["new", "graph", locked / "mine.yaml"], before=give_up_privileges)
    assert_refused(outcome, 2, "RG560", "mine.yaml", "no permission", folder=locked)


def test_no_permission_to_read(tmp_path: Path) -> None:
    graph = write_graph(tmp_path)
    graph.chmod(0)
    assert_refused(run_rg(["validate", graph], before=give_up_privileges), 2, "RG101", "graph.yaml", "no permission")
    graph.chmod(0o644)
    (tmp_path / "paint.frag").chmod(0)
    outcome = run_rg(["render", graph, "-o", tmp_path / "out"], before=give_up_privileges)
    assert_refused(outcome, 1, "RG510", "paint.frag", "graph.yaml:6:3", folder=tmp_path / "out")


@pytest.mark.parametrize("output", ["graph.yaml", "graph.yaml/deeper", "x" * 300])
def test_output_folders_that_cannot_be(rg: Rg, tmp_path: Path, output: str) -> None:
    graph = write_graph(tmp_path, shader="this would not compile")
    assert_refused(rg("render", str(graph), "-o", str(tmp_path / output)), 2, "RG560", output)


@pytest.mark.gpu
def test_an_output_folder_in_proc(rg: Rg, tmp_path: Path) -> None:
    outcome = rg("render", str(write_graph(tmp_path)), "-o", "/proc/rendergraph", "--samples", "0")
    assert_refused(outcome, 2, "RG560", "/proc/rendergraph")


@pytest.mark.gpu
def test_a_folder_in_the_place_of_an_image(rg: Rg, tmp_path: Path) -> None:
    (tmp_path / "out" / "image.png").mkdir(parents=True)
    outcome = rg("render", str(write_graph(tmp_path)), "-o", str(tmp_path / "out"), "--samples", "0")
    assert_refused(outcome, 2, "RG560", "image.png", "folder of that name")
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["image.png"]


# ---------------------------------------------------------------- the disk is full


def tiny_files() -> None:
    """No file may grow beyond 100 bytes: the write fails in the middle, as on a full disk."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))


@pytest.mark.gpu
@pytest.mark.parametrize("suffix", ["png", "npy", "exr"])
def test_a_write_that_fails_half_way_leaves_nothing(tmp_path: Path, suffix: str) -> None:
    if suffix == "exr":
        pytest.importorskip("OpenEXR")
    noisy = SHADER.replace("0.5,", "fract(sin(dot(gl_FragCoord.xy, vec2(12.9, 78.2))) * 43758.5),")
    graph = write_graph(tmp_path, shader=noisy, passes=PAINT, outputs="{a: {file: a." + suffix + "}}")
    out = tmp_path / "out"
    env = os.environ | {"MESA_SHADER_CACHE_DISABLE": "true"}
    outcome = run_rg(["render", graph, "-o", out, "--samples", "0"], before=tiny_files, env=env)
    assert_refused(outcome, 2, "RG560", f"a.{suffix}", folder=out)


@pytest.mark.gpu
@pytest.mark.parametrize("failure", [OSError(errno.ENOSPC, "full"), KeyboardInterrupt()], ids=["full", "Ctrl-C"])
def test_a_failure_between_two_files_leaves_whole_ones_only(
    rg: Rg, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failure: BaseException
) -> None:
    from rendergraph.run import image_files

    whole = image_files._write_png

    def write(path: Path, pixels: Any) -> None:
        if "second" in path.name:
            path.write_bytes(b"half")
            raise failure
        whole(path, pixels)

    monkeypatch.setattr(image_files, "_write_png", write)
    graph = write_graph(tmp_path, outputs="{a: {file: first.png}, image: {file: second.png}}")
    outcome = rg("render", str(graph), "-o", str(tmp_path / "out"), "--samples", "0")
    if isinstance(failure, OSError):
        assert_refused(outcome, 2, "RG560", "second.png", "the disk is full")
    else:
        assert outcome.code == 130
        assert outcome.err.strip() == "interrupted"
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["first.png"]


def test_memory_that_runs_out_is_told(rg: Rg, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def load(*_: Any, **__: Any) -> None:
        raise MemoryError("Unable to allocate 1.00 GiB")

    monkeypatch.setattr("rendergraph.document.load.load_document", load)
    outcome = rg("plan", str(write_graph(tmp_path)))
    assert_refused(outcome, 1, "RG526", "1.00 GiB", "--size")


@pytest.mark.gpu
def test_a_frame_beyond_memory_is_refused(tmp_path: Path) -> None:
    def little_memory() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))

    out = tmp_path / "out"
    outcome = run_rg(["render", write_graph(tmp_path), "--size", "16384x16384", "-o", out], before=little_memory)
    assert_refused(outcome, 1, "RG521" if "RG521" in outcome.err else "RG526", folder=out)


def test_exr_without_its_library_is_refused_before_rendering(
    rg: Rg, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "OpenEXR", None)
    graph = write_graph(tmp_path, shader="this would not compile", passes=PAINT, outputs="{a: {file: a.EXR}}")
    out = tmp_path / "out"
    outcome = rg("render", str(graph), "-o", str(out))
    assert_refused(outcome, 3, "RG562", "a.EXR", "graph.yaml:7:", "pip install 'rendergraph[exr]'", folder=out)


# ---------------------------------------------------------------- streams


def to_reader_that_left() -> None:
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)  # as Python has it
    reader, writer = os.pipe()
    os.close(reader)
    os.dup2(writer, 1)


def to_full_device() -> None:
    os.dup2(os.open("/dev/full", os.O_WRONLY), 1)


def closed() -> None:
    os.close(1)


@pytest.mark.parametrize("command", ["validate", "plan", "schema"])
def test_a_reader_of_stdout_that_left_is_no_error(tmp_path: Path, command: str) -> None:
    arguments = [command] if command == "schema" else [command, write_graph(tmp_path)]
    outcome = run_rg(arguments, before=to_reader_that_left)
    assert (outcome.code, outcome.err) == (0, "")


def test_findings_are_still_told_to_a_reader_of_stdout_that_left(tmp_path: Path) -> None:
    broken = write_graph(tmp_path, resources="  a: {format: r99}\n")
    assert run_rg(["validate", broken, "--format", "json"], before=to_reader_that_left).code == 1


@pytest.mark.parametrize("command", ["plan", "schema"])
def test_a_full_device_as_stdout(tmp_path: Path, command: str) -> None:
    arguments = [command] if command == "schema" else [command, write_graph(tmp_path)]
    outcome = run_rg(arguments, before=to_full_device)
    assert_refused(outcome, 2, "RG573", "the disk is full")


def test_a_closed_stdout(tmp_path: Path) -> None:
    outcome = run_rg(["plan", write_graph(tmp_path)], before=closed)
    assert (outcome.code, outcome.err) == (0, "")


@pytest.mark.gpu
def test_files_are_whole_when_all_streams_are_closed(tmp_path: Path) -> None:
    def all_closed() -> None:
        os.close(1)
        os.close(2)

    out = tmp_path / "out"
    assert run_rg(["render", write_graph(tmp_path), "-o", out, "--samples", "0"], before=all_closed).code == 0
    assert (out / "image.png").read_bytes().startswith(b"\x89PNG")
    assert (out / "timing.json").read_text().startswith("{")


def test_a_stdout_without_unicode(tmp_path: Path) -> None:
    outcome = run_rg(["plan", write_graph(tmp_path)], env=os.environ | {"PYTHONIOENCODING": "ascii"})
    assert outcome.code == 0, outcome.err
    assert "paint" in outcome.out


def on_terminal(arguments: list[str], env: dict[str, str]) -> str:
    """What a command writes to a terminal."""
    try:
        main, terminal = pty.openpty()
    except OSError:
        pytest.skip("no pseudo-terminals here")
    with subprocess.Popen([sys.executable, "-c", RUN, *arguments], stdout=terminal, stderr=terminal, env=env):
        os.close(terminal)
        text = b""
        try:
            while part := os.read(main, 65536):
                text += part
        except OSError:  # how Linux ends a terminal whose other side is closed
            pass
    os.close(main)
    return text.decode()


def test_no_color_is_honoured(tmp_path: Path) -> None:
    graph = str(write_graph(tmp_path))
    env = {key: value for key, value in os.environ.items() if key not in ("NO_COLOR", "FORCE_COLOR")}
    colour = "\x1b["
    env["TERM"] = "xterm-256color"
    coloured = on_terminal(["plan", graph], env)
    plain = on_terminal(["plan", graph], env | {"NO_COLOR": "1"})
    codes = re.compile(r"\x1b\[[0-9;]*?(?:3[0-9]|4[0-9]|9[0-7])[0-9;]*m")
    assert colour in coloured
    assert codes.search(coloured)
    assert not codes.search(plain)
    assert "paint" in plain


# ---------------------------------------------------------------- names


def test_file_names_that_are_not_utf_8(tmp_path: Path) -> None:
    folder = os.fsencode(tmp_path)
    write_graph(tmp_path).rename(os.fsdecode(folder + b"/caf\xe9.yaml"))
    outcome = run_rg(["validate", folder + b"/caf\xe9.yaml"])
    assert outcome.code == 0, outcome.err
    assert "valid" in outcome.out
    outcome = run_rg(["validate", folder + b"/caff\xe9.yaml"])
    assert_refused(outcome, 2, "RG100", "caf\\udce9.yaml")


@pytest.mark.gpu
def test_an_output_folder_whose_name_is_not_utf_8(tmp_path: Path) -> None:
    out = os.fsencode(tmp_path) + b"/out\xe9"
    outcome = run_rg(["render", write_graph(tmp_path), "-o", out, "--samples", "0"])
    assert outcome.code == 0, outcome.err
    assert sorted(p.name for p in Path(os.fsdecode(out)).iterdir()) == ["image.png", "resources.json", "timing.json"]
