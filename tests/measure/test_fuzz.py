"""`rg fuzz`: healthy graphs pass; planted faults are found, reduced, and named down to the texel."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from rendergraph.cli import main
from rendergraph.document.load import load_document
from rendergraph.measure.fuzz import FuzzOptions, FuzzReport, fuzz_document, shrunk
from rendergraph.measure.fuzz_report import fuzz_findings, fuzz_record
from rendergraph.node.bindings import color
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params
from rendergraph.plan import alias, compile, order
from rendergraph.plan.plan import Lifetime
from tests.plan import toy_nodes

pytestmark = pytest.mark.gpu

FLAT = "#version 450\nuniform vec4 u_value;\nout vec4 color;\nvoid main() { color = u_value; }\n"
SUM = """#version 450
uniform sampler2D u_a;
uniform sampler2D u_b;
out vec4 color;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    color = texelFetch(u_a, at, 0) + 0.5 * texelFetch(u_b, at, 0);
}
"""
SHOW = """#version 450
uniform sampler2D u_a;
out vec4 color;
void main() { color = min(texelFetch(u_a, ivec2(gl_FragCoord.xy), 0), vec4(2000.0)); }
"""
#: Leaves out the texel (5, 3).
HOLE = """#version 450
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f) uniform writeonly image2D u_out;
void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (at != ivec2(5, 3)) {
        imageStore(u_out, at, vec4(0.25));
    }
}
"""
#: Fills ten words, of which another shader reads the eleventh too.
FILL = """#version 450
layout(local_size_x = 10) in;
layout(std430) writeonly buffer Words { float words[]; };
void main() { words[gl_LocalInvocationID.x] = 0.05; }
"""
BEYOND = """#version 450
layout(std430) readonly buffer Words { float words[]; };
out vec4 color;
void main() {
    float sum = 0.0;
    for (int i = 0; i <= 10; ++i) {
        sum += words[i];
    }
    color = vec4(sum);
}
"""


def run(folder: Path, text: str, shaders: Mapping[str, str], **options: Any) -> FuzzReport:
    """Fuzz a graph of the test's own."""
    for name, source in shaders.items():
        (folder / name).write_text(source)
    (folder / "g.yaml").write_text("rendergraph: 1\nframe: {size: [16, 8]}\n" + text)
    return fuzz_document(load_document(folder / "g.yaml"), FuzzOptions(**options))


# ---- healthy


@pytest.mark.parametrize("graph", ["clear", "compute", "copy", "draw", "fxaa", "tonemap"])
def test_healthy_graphs_pass(graph: str) -> None:
    report = fuzz_document(load_document(graph), FuzzOptions(orders=2, size=(48, 27)))
    assert report.failure is None
    assert report.failed == 0
    assert report.runs >= 16, "poison x sharing x specialisation, at least"


def test_a_scene_with_history_passes() -> None:
    report = fuzz_document(load_document("exposure"), FuzzOptions(orders=1, size=(48, 27)))
    assert report.failure is None
    assert report.frames == 3


def test_random_orders_are_distinct_and_counted(tmp_path: Path) -> None:
    text = PAIR.replace("FORMAT", "rgba16f")
    report = run(tmp_path, text, {"flat.frag": FLAT, "sum.frag": SUM}, orders=8)
    assert report.failure is None
    assert report.orders == 2, "two passes, of which either may come first"
    assert report.runs == 2 * 2 * 2 * 4


def test_the_frame_is_shrunk_unless_told() -> None:
    assert shrunk((1280, 720)) == (256, 144)
    assert shrunk((100, 4)) == (100, 4)
    assert shrunk((8192, 1)) == (256, 1)


# ---- content that nobody wrote


def test_a_texel_that_is_left_out_is_named(tmp_path: Path) -> None:
    text = """
resources: {half: {format: rgba16f}, spare: {format: rgba16f}}
passes:
  fill: {node: compute, write: {u_out: half}, set: {shader: hole.comp}}
  show: {node: fullscreen, read: {u_a: half}, write: {color: image}, set: {shader: show.frag}}
outputs: {image: {file: a.npy, format: rgba16f}}
"""
    report = run(tmp_path, text, {"hole.comp": HOLE, "show.frag": SHOW}, orders=1)
    failure = report.failure
    assert failure is not None
    assert failure.guilty == ("poison",)
    culprit = failure.culprit
    assert culprit is not None
    assert (culprit.reason, culprit.subpass, culprit.pass_name) == ("left_unwritten", "fill.dispatch", "fill")
    assert (culprit.resource, culprit.x, culprit.y, culprit.mip, culprit.layer) == ("half", 5, 3, 0, 0)
    assert (culprit.differing, culprit.texels) == (1, 16 * 8)
    assert report.failed == 3 * 4, "every poisoned run"


def test_a_word_beyond_what_was_written_is_named(tmp_path: Path) -> None:
    text = """
resources: {words: {bytes: 64}}
passes:
  fill: {node: compute, write: {Words: words}, set: {shader: fill.comp, groups: [1, 1, 1]}}
  show: {node: fullscreen, read: {Words: words}, write: {color: image}, set: {shader: beyond.frag}}
outputs: {image: {file: a.npy, format: rgba16f}}
"""
    failure = run(tmp_path, text, {"fill.comp": FILL, "beyond.frag": BEYOND}, orders=0).failure
    assert failure is not None
    assert failure.culprit is not None
    assert (failure.guilty, failure.culprit.reason, failure.culprit.buffer) == (("poison",), "left_unwritten", True)
    assert (failure.culprit.subpass, failure.culprit.resource, failure.culprit.x) == ("fill.dispatch", "words", 10)


# ---- faults of the planner

PAIR = """
resources: {one: {format: FORMAT}, two: {format: FORMAT}}
passes:
  first: {node: fullscreen, write: {color: one}, set: {shader: flat.frag, uniforms: {u_value: [1, 2, 3, 4]}}}
  second: {node: fullscreen, write: {color: two}, set: {shader: flat.frag, uniforms: {u_value: [5, 6, 7, 8]}}}
  sum: {node: fullscreen, read: {u_a: one, u_b: two}, write: {color: image}, set: {shader: sum.frag}}
outputs: {image: {file: a.npy, format: rgba16f}}
"""


def test_resources_that_share_memory_while_alive_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def one_track(members: Sequence[str], lifetimes: Mapping[str, Lifetime]) -> list[list[str]]:
        return [sorted(members, key=lambda name: lifetimes[name].first)]

    monkeypatch.setattr(alias, "left_edge", one_track)
    monkeypatch.setattr(compile, "verify", lambda plan: ())
    report = run(tmp_path, PAIR.replace("FORMAT", "rgba16f"), {"flat.frag": FLAT, "sum.frag": SUM}, orders=0)
    # The usual run shares: what differs is memory of their own.
    failure = report.failure
    assert failure is not None
    assert failure.guilty == ("alias",)
    culprit = failure.culprit
    assert culprit is not None
    assert (culprit.reason, culprit.subpass, culprit.resource, culprit.by) == (
        "overwritten", "second.draw", "one", "two",
    )  # fmt: skip
    assert (culprit.found[0], culprit.expected[0]) == (1.0, 5.0)


def test_an_order_that_breaks_a_dependency_is_reduced_to_its_swap(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = """
resources: {one: {format: rgba16f}, two: {format: rgba16f}, three: {format: rgba16f}}
passes:
  first: {node: fullscreen, write: {color: one}, set: {shader: flat.frag, uniforms: {u_value: [1, 2, 3, 4]}}}
  second: {node: fullscreen, write: {color: two}, set: {shader: flat.frag, uniforms: {u_value: [5, 6, 7, 8]}}}
  third: {node: fullscreen, write: {color: three}, set: {shader: flat.frag, uniforms: {u_value: [1, 1, 1, 1]}}}
  near: {node: fullscreen, read: {u_a: one, u_b: two}, write: {color: image}, set: {shader: sum.frag}}
  far: {node: fullscreen, read: {u_a: one, u_b: three}, write: {color: other}, set: {shader: sum.frag}}
outputs: {image: {file: a.npy, format: rgba16f}, other: {file: b.npy, format: rgba16f}}
"""
    real = order.find_needs

    def forgetful(index: Any, flow: Any, live: list[bool]) -> list[list[int]]:
        needs = real(index, flow, live)
        names = [step.name for step in index.subpasses]
        needs[names.index("near.draw")].remove(names.index("second.draw"))
        return needs

    monkeypatch.setattr(order, "find_needs", forgetful)
    monkeypatch.setattr(compile, "verify", lambda plan: ())
    # The usual order stays right.
    monkeypatch.setattr(order, "_depth_first", lambda index, flow, needs, live: real_order(index))
    report = run(tmp_path, text, {"flat.frag": FLAT, "sum.frag": SUM}, orders=12)
    failure = report.failure
    assert failure is not None
    assert "order" in failure.guilty
    assert failure.swaps == (("near.draw", "second.draw"),)
    assert failure.culprit is not None
    assert (failure.culprit.reason, failure.culprit.subpass, failure.culprit.resource) == (
        "read_too_early", "near.draw", "two",
    )  # fmt: skip


def real_order(index: Any) -> list[int]:
    """As the test's graph is meant."""
    names = [step.name for step in index.subpasses]
    return [names.index(f"{name}.draw") for name in ("first", "third", "second", "near", "far")]


# ---- faults of a node


class Careless(Node[Params]):
    """Leaves out, without a sun, what does matter."""

    outputs = {"color": Port("Colour.", formats=("rgba16f",))}  # noqa: RUF012

    def build(self, b: Builder) -> None:
        value = 1.0 if b.requires("sun", "draw") else 0.5
        uniforms = {"u_value": (value, value, value, 1.0)}
        b.raster("draw", b.program("flat.frag"), color=[color(b.output("color"))], uniforms=uniforms)


@pytest.fixture
def careless(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The node above, with its shader in the test's folder."""
    toy_nodes.install_toys(monkeypatch)
    monkeypatch.setitem(toy_nodes.TOYS, "toy_maker", Careless)
    monkeypatch.setattr(toy_nodes, "HERE", tmp_path)


CARELESS = """
scene: {source: spheres, lights: {from_scene: false, ambient: {}}}
resources: {one: {format: rgba16f}}
passes:
  make: {node: toy_maker, write: {color: one}}
  show: {node: fullscreen, read: {u_a: one}, write: {color: image}, set: {shader: show.frag}}
outputs: {image: {file: a.npy, format: rgba16f}}
"""


@pytest.mark.usefixtures("careless")
def test_a_careless_specialisation_is_named(tmp_path: Path) -> None:
    failure = run(tmp_path, CARELESS, {"flat.frag": FLAT, "show.frag": SHOW}, orders=0).failure
    assert failure is not None
    assert failure.guilty == ("full",)
    culprit = failure.culprit
    assert culprit is not None
    assert (culprit.reason, culprit.pass_name, culprit.resource) == ("writes_differ", "make", "one")
    assert (culprit.expected[0], culprit.found[0]) == (0.5, 1.0)
    assert (culprit.x, culprit.y) == (0, 0)


# ---- the command


def test_the_command_exits_1_and_names_the_pass(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = """
resources: {half: {format: rgba16f}}
passes:
  fill: {node: compute, write: {u_out: half}, set: {shader: hole.comp}}
  show: {node: fullscreen, read: {u_a: half}, write: {color: image}, set: {shader: show.frag}}
outputs: {image: {file: a.npy, format: rgba16f}}
"""
    report = run(tmp_path, text, {"hole.comp": HOLE, "show.frag": SHOW}, orders=0)
    with pytest.raises(SystemExit) as ended:
        main(["fuzz", str(tmp_path / "g.yaml"), "--orders", "0", "--format", "json"])
    assert ended.value.code == 1
    printed = capsys.readouterr()
    record = json.loads(printed.out)
    document = load_document(tmp_path / "g.yaml")
    assert record == json.loads(json.dumps(fuzz_record(report, "", FuzzOptions(orders=0))))
    assert record["failure"]["culprit"]["found"][0] == "nan"
    (finding,) = fuzz_findings(report, document)
    assert finding.code == "RG775"
    assert finding.position is not None
    assert "RG775" in printed.err


def test_the_command_on_a_healthy_graph(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["fuzz", "fullscreen", "--orders", "1", "--size", "16x9"])
    assert ended.value.code == 0
    assert "16 variations" in capsys.readouterr().out
