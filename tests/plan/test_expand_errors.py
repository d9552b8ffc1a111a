"""Every mistake that expansion can find, by its code."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from toy_nodes import codes, install_toys, write

from rendergraph.document.messages import MESSAGES, RenderGraphError
from rendergraph.plan.expand import expand
from rendergraph.scene.features import SceneFeatures


@pytest.fixture(autouse=True)
def _toys(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    install_toys(monkeypatch)
    for name in ("x.frag", "x.vert", "x.comp"):
        (tmp_path / name).touch()


A = "a: {format: rgba16f}"
MADE = "make: {node: toy_maker, write: {color: a}}"
OUT = "outputs: {image: {file: a.exr}}"


def passes(*entries: str, resources: str = "", rest: str = OUT) -> str:
    """A document of a few one-line passes."""
    body = "\n".join(f"  {entry}" for entry in entries)
    return f"resources: {{{resources}}}\npasses:\n{body}\n{rest}"


TO_IMAGE = "show: {node: toy_maker, write: {color: image}}"

GRAPHS: dict[str, tuple[str, list[str]]] = {
    "fine": (passes(TO_IMAGE), []),
    "undeclared read": (passes("p: {node: toy_filter, read: {color: nope}, write: {color: image}}"), ["RG212"]),
    "undeclared write": (passes(TO_IMAGE, MADE), ["RG212"]),
    "internal of no pass": (passes("p: {node: toy_filter, read: {color: q.x}, write: {color: image}}"), ["RG212"]),
    "output nobody writes": (passes(MADE, resources=A), ["RG213"]),
    "declared output nobody writes": (
        passes(MADE, resources="a: {format: rgba16f}, b: {format: r8}", rest="outputs: {b: {file: b.png}}"),
        ["RG213"],
    ),
    "internal output of no pass": (
        passes(TO_IMAGE, rest="outputs: {image: {file: a.exr}, q.x: {file: x.npy}}"),
        ["RG213"],
    ),
    "unused": (passes(TO_IMAGE, resources="a: {format: r8}"), ["RG214"]),
    "writes history": (
        passes(TO_IMAGE, "p: {node: toy_over, write: {color: last}}", resources="last: {previous: image}"),
        ["RG215"],
    ),
    "reads what it replaces": (passes("p: {node: toy_filter, read: {color: image}, write: {color: image}}"), ["RG216"]),
    "reads what it modifies": (
        passes(TO_IMAGE, "p: {node: toy_over, read: {color: image}, write: {color: image}}"),
        [],
    ),
    "reads what it blends over": (
        passes(
            TO_IMAGE, "p: {node: fullscreen, read: {u: image}, write: {c: image}, set: {shader: x.frag, blend: add}}"
        ),
        [],
    ),
    "reads what it draws": (
        passes("p: {node: fullscreen, read: {u: image}, write: {c: image}, set: {shader: x.frag}}"),
        ["RG216"],
    ),
    "writes twice": (
        passes("p: {node: fullscreen, write: {a: image, b: image}, set: {shader: x.frag}}"),
        ["RG217"],
    ),
    "after itself": (passes("p: {node: toy_maker, write: {color: image}, after: [p]}"), ["RG218"]),
    "after nobody": (passes("p: {node: toy_maker, write: {color: image}, after: [q]}"), ["RG218"]),
    "barrier names": (
        passes(TO_IMAGE, rest=f"{OUT}\nbarriers: [{{resource: no, after: show.none, before: show, kind: command}}]"),
        ["RG219", "RG219"],
    ),
    "no such internal": (
        passes(
            "q: {node: toy_inner, write: {color: a}}",
            "p: {node: toy_filter, read: {color: q.nope}, write: {color: image}}",
            resources=A,
        ),
        ["RG220"],
    ),
    "writes an internal": (
        passes("q: {node: toy_inner, write: {color: image}}", "p: {node: toy_over, write: {color: q.half}}"),
        ["RG220"],
    ),
    "no such internal output": (
        passes(
            "q: {node: toy_inner, write: {color: image}}", rest="outputs: {image: {file: a.exr}, q.x: {file: x.npy}}"
        ),
        ["RG220"],
    ),
    "circle of internals": (
        passes(
            "p: {node: toy_peek, read: {a: q.half}, write: {color: image}}",
            "q: {node: toy_peek, read: {a: p.half}, write: {color: a}}",
            resources=A,
        ),
        ["RG221"],
    ),
    "own internal": (passes("p: {node: toy_peek, read: {a: p.half}, write: {color: image}}"), ["RG221"]),
    "file missing": (passes("p: {node: toy_peek, write: {color: image}, set: {file: no.txt}}"), ["RG222"]),
    "file outside": (passes("p: {node: toy_peek, write: {color: image}, set: {file: ../x.frag}}"), ["RG222"]),
    "file absolute": (passes("p: {node: toy_peek, write: {color: image}, set: {file: /etc/hosts}}"), ["RG222"]),
    "file name too long": (
        passes(f"p: {{node: toy_peek, write: {{color: image}}, set: {{file: {'x' * 300}}}}}"),
        ["RG222"],
    ),
    "file is a folder": (passes("p: {node: toy_peek, write: {color: image}, set: {file: .}}"), ["RG222"]),
    "file in a table": (
        passes("p: {node: toy_peek, write: {color: image}, set: {table: {a: x.frag, b: no}}}"),
        ["RG222"],
    ),
    "shader missing": (passes("p: {node: fullscreen, write: {c: image}, set: {shader: no.frag}}"), ["RG222"]),
    "history of nothing": (
        passes(
            "p: {node: toy_filter, read: {color: last}, write: {color: image}}",
            resources="a: {format: rgba16f}, last: {previous: a}",
        ),
        ["RG223"],
    ),
    "no scene": (passes("p: {node: toy_scene, write: {color: image}}"), ["RG224"]),
    "no scene to draw": (
        passes("p: {node: draw, write: {c: image}, set: {vertex: x.vert, fragment: x.frag, queues: [opaque]}}"),
        ["RG224"],
    ),
    "node raises": (passes("p: {node: toy_raises, write: {color: image}}"), ["RG229"]),
    "node writes no output": (passes("p: {node: toy_writes_nothing, write: {color: image}}"), ["RG229"]),
    "node writes an input": (
        passes(MADE, "p: {node: toy_writes_input, read: {color: a}, write: {color: image}}", resources=A),
        ["RG229"],
    ),
    "node trespasses": (passes("p: {node: toy_trespasser, write: {color: image}}"), ["RG229"]),
    # ---- resources
    "like circle": (
        passes(TO_IMAGE, resources="a: {like: b}, b: {like: c}, c: {like: a}, d: {like: a}"),
        ["RG304"],
    ),
    "like itself": (passes(TO_IMAGE, resources="a: {like: a}"), ["RG304"]),
    "previous circle": (passes(TO_IMAGE, resources="a: {previous: b}, b: {previous: a}"), ["RG304"]),
    "like nobody": (passes(TO_IMAGE, resources="a: {like: b}"), ["RG305"]),
    "previous of nobody": (passes(TO_IMAGE, resources="a: {previous: b}"), ["RG305"]),
    "like a buffer": (passes(TO_IMAGE, resources="a: {like: b}, b: {bytes: 16}"), ["RG306"]),
    "previous of a history": (passes(TO_IMAGE, resources="a: {previous: b}, b: {previous: image}"), ["RG306"]),
    "too large": (
        passes(TO_IMAGE, resources="a: {format: r8, fixed: [2048, 16384]}, b: {like: a, scale: 2}"),
        ["RG307"],
    ),
    "too many mips": (passes(TO_IMAGE, resources="a: {format: r8, fixed: [256, 3], mips: 10}"), ["RG308"]),
    "too many bytes": (passes(TO_IMAGE, resources="a: {format: rgba32f, fixed: [16384, 16384], layers: 2}"), ["RG313"]),
    "two histories": (
        passes(
            "p: {node: toy_peek, read: {a: x, b: y}, write: {color: image}}",
            resources="x: {previous: image}, y: {previous: image}",
        ),
        ["RG315"],
    ),
    # ---- ports
    "format": (
        passes(MADE, "p: {node: toy_filter, read: {color: a}, write: {color: image}}", resources="a: {format: r8}"),
        ["RG320", "RG320"],
    ),
    "depth for colour": (passes(MADE, TO_IMAGE, resources="a: {format: d32f}"), ["RG320"]),
    "texture for buffer": (
        passes(MADE, "p: {node: toy_filter, read: {color: a, table: a}, write: {color: image}}", resources=A),
        ["RG321"],
    ),
    "buffer for texture": (
        passes(
            "p: {node: toy_filter, read: {color: a}, write: {color: image}}",
            "z: {node: clear, write: {target: a}}",
            resources="a: {bytes: 16}",
        ),
        ["RG321"],
    ),
    "buffer output undeclared": (
        passes("p: {node: exposure, read: {color: a}, write: {exposure: image}}", MADE, resources=A),
        ["RG321"],
    ),
    "samples": (passes(MADE, TO_IMAGE, resources="a: {format: rgba16f, samples: 4}"), ["RG322"]),
    "samples missing": (
        passes(MADE, "p: {node: toy_layered, read: {samples: a}, write: {color: image}}", resources=A),
        ["RG322"],
    ),
    "layers": (
        passes(MADE, "p: {node: toy_layered, read: {layers: a}, write: {color: image}}", resources=A),
        ["RG323"],
    ),
    "like port": (
        passes(
            MADE,
            "p: {node: toy_filter, read: {color: a}, write: {color: image}}",
            resources="a: {format: rgba16f, scale: 0.5}",
        ),
        ["RG324"],
    ),
    # ---- sub-passes
    "store to srgb": (
        passes("p: {node: compute, write: {u: a}, set: {shader: x.comp}}", TO_IMAGE, resources="a: {format: srgb8_a8}"),
        ["RG325"],
    ),
    "filtered integers": (
        passes(
            "z: {node: clear, write: {target: a}}",
            "p: {node: fullscreen, read: {u: a}, write: {c: image}, set: {shader: x.frag, filter: {u: linear}}}",
            resources="a: {format: r8ui}",
        ),
        ["RG325"],
    ),
    "compared colour": (
        passes(
            MADE,
            "p: {node: fullscreen, read: {u: a}, write: {c: image}, set: {shader: x.frag, filter: compare}}",
            resources=A,
        ),
        ["RG325"],
    ),
    "attachments of two sizes": (
        passes(
            "p: {node: fullscreen, write: {a: a, b: image}, set: {shader: x.frag}}",
            resources="a: {format: rgba16f, scale: 0.5}",
        ),
        ["RG326"],
    ),
    "attachments of two sample counts": (
        passes(
            "p: {node: draw, write: {a: image, b: a}, set: {vertex: x.vert, fragment: x.frag, vertices: 3}}",
            resources="a: {format: d32f, samples: 4}",
        ),
        ["RG326"],
    ),
    "no such level": (
        passes("p: {node: toy_stores, write: {color: a}}", TO_IMAGE, resources="a: {format: rgba8}"),
        ["RG327"],
    ),
    "both at once": (
        passes("p: {node: toy_stores, write: {color: a}}", TO_IMAGE, resources="a: {format: srgb8_a8}"),
        ["RG325", "RG327"],
    ),
    # ---- outputs
    "multisampled output": (
        passes(
            "p: {node: draw, write: {a: a}, set: {vertex: x.vert, fragment: x.frag, vertices: 3}}",
            resources="a: {format: rgba8, samples: 4}",
            rest="outputs: {a: {file: a.png}}",
        ),
        ["RG330"],
    ),
    "buffer output": (
        passes("z: {node: clear, write: {target: a}}", resources="a: {bytes: 16}", rest="outputs: {a: {file: a.png}}"),
        ["RG330"],
    ),
    "buffer as numbers": (
        passes("z: {node: clear, write: {target: a}}", resources="a: {bytes: 16}", rest="outputs: {a: {file: a.npy}}"),
        [],
    ),
    "format said twice": (
        passes(MADE, resources="a: {format: rgba8}", rest="outputs: {a: {file: x.png, format: rgba16f}}"),
        ["RG330"],
    ),
}


@pytest.mark.parametrize("name", GRAPHS)
def test_code(tmp_path: Path, name: str) -> None:
    text, expected = GRAPHS[name]
    assert codes(tmp_path, text) == expected


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"size": (0, 10)}, ["RG226"]),
        ({"size": (10, 16385)}, ["RG226"]),
        ({"size": (16384, 1)}, []),
        ({"frames": 0}, ["RG226"]),
        ({"size": (-1, 0), "frames": 10001}, ["RG226", "RG226", "RG226"]),
    ],
)
def test_sizes_from_outside(tmp_path: Path, options: dict[str, Any], expected: list[str]) -> None:
    assert codes(tmp_path, passes(TO_IMAGE), **options) == expected


def test_a_loaded_scene_makes_up_for_none_in_the_file(tmp_path: Path) -> None:
    text = passes("p: {node: toy_scene, write: {color: image}}")
    assert codes(tmp_path, text, features=SceneFeatures()) == []


def test_all_errors_come_at_once_in_file_order_at_their_places(tmp_path: Path) -> None:
    text = """resources:
  a: {format: rgba16f, fixed: [4, 4], mips: 9}
  b: {like: c}
passes:
  p: {node: toy_filter, read: {color: zz}, write: {color: image}}
  q: {node: toy_raises, write: {color: more}, after: [r]}
  s: {node: toy_raises, write: {color: more}}
outputs: {image: {file: a.exr}, more: {file: b.exr}}
"""
    with pytest.raises(RenderGraphError) as caught:
        expand(write(tmp_path, text))
    found = [(d.code, d.position.line, d.position.column) for d in caught.value.diagnostics if d.position]
    assert found == [("RG308", 3, 45), ("RG305", 4, 13), ("RG212", 6, 39), ("RG218", 7, 55), ("RG229", 8, 13)]


def test_a_wrong_resource_is_reported_once_and_silences_what_depends_on_it(tmp_path: Path) -> None:
    text = passes(
        "p: {node: toy_filter, read: {color: a}, write: {color: b}}",
        "q: {node: toy_filter, read: {color: b}, write: {color: image}}",
        resources="a: {format: rgba16f, fixed: [4, 4], mips: 9}, b: {like: a}, c: {previous: b}",
    )
    assert codes(tmp_path, text) == ["RG308"]


def test_an_internal_of_a_wrong_pass_is_not_reported_again(tmp_path: Path) -> None:
    text = passes(
        "q: {node: toy_inner, write: {color: nope}}",
        "p: {node: toy_filter, read: {color: q.half}, write: {color: image}}",
        rest="outputs: {image: {file: a.exr}, q.cut: {file: b.npy}}\n"
        "barriers: [{resource: q.half, after: q.down, before: p, kind: texture_fetch}]",
    )
    assert codes(tmp_path, text) == ["RG212"]


def test_every_code_of_expansion_is_tested() -> None:
    tested = {code for _, expected in GRAPHS.values() for code in expected} | {"RG226"}
    elsewhere = {"RG225", "RG227", "RG228"}  # user shader nodes; explain
    loading = {"RG301", "RG302", "RG303", "RG309"}
    files = {"RG310", "RG311", "RG312", "RG314"}
    own = {c for c in MESSAGES if "RG212" <= c <= "RG229" or "RG300" <= c <= "RG339"}
    assert own - elsewhere - loading - files == tested
