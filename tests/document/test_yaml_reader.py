"""YAML text to data and positions, and everything that can be wrong with it."""

from __future__ import annotations

import time
from typing import Any

import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.document.positions import PositionMap
from rendergraph.document.yaml_reader import MAX_DEPTH, MAX_VALUES, Reading, read_yaml


def read(text: str) -> Reading:
    return read_yaml(text.encode("utf-8"), "g.yaml")


def problems(text: str) -> list[tuple[str, int, int]]:
    try:
        found = read(text).problems
    except RenderGraphError as error:
        found = list(error.diagnostics)
    return [(d.code, d.position.line, d.position.column) for d in found if d.position is not None]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("a: 1\nb: [x, 1e-3, {c: ~}]\n", {"a": 1, "b": ["x", 1e-3, {"c": None}]}),
        ("on: 1\nyes: 2\nn: 3\n", {"on": 1, "yes": 2, "n": 3}),
        ("a: '1'\nb: \"0x10\"\nc: |\n  12\n", {"a": "1", "b": "0x10", "c": "12\n"}),
        ("a: &x {k: 1}\nb: *x\nc: &s text\nd: *s\n", {"a": {"k": 1}, "b": {"k": 1}, "c": "text", "d": "text"}),
        ("%YAML 1.2\n---\na: 1\n...\n", {"a": 1}),
        ("a: {}\nb: []\n", {"a": {}, "b": []}),
        ("", None),
        ("# only a comment\n", None),
        ("just text", "just text"),
    ],
)
def test_data(text: str, value: Any) -> None:
    assert read(text).value == value


def test_merge_keys_add_what_is_missing() -> None:
    text = "a: &a {x: 1, y: 1}\nb: &b {y: 2, z: 2}\nc: {<<: [*a, *b], x: 0}\nd:\n  <<: *b\n  w: 3\n"
    text += "e: {<<: *b, '<<': kept}\n"
    value = read(text).value
    assert value["c"] == {"x": 0, "y": 1, "z": 2}
    assert value["d"] == {"w": 3, "y": 2, "z": 2}
    assert value["e"] == {"<<": "kept", "y": 2, "z": 2}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a: 1\na: 2\n", [("RG105", 2, 1)]),
        ("a: {b: 1, b: 2, b: 3}\n", [("RG105", 1, 11), ("RG105", 1, 17)]),
        ("1: a\n", [("RG106", 1, 1)]),
        ("{true: a, null: b, 1.5: c, 010: d}", [("RG106", 1, n) for n in (2, 11, 20, 28)]),
        ("? \n: e\n", [("RG106", 1, 2)]),
        ("? [a]\n: b\n", [("RG106", 1, 3)]),
        ("? {a: b}\n: b\n", [("RG106", 1, 3)]),
        ("a: &k x\n*k : y\n", [("RG106", 2, 1)]),
        ("a: !!python/object/apply:os.system [ls]\n", [("RG107", 1, 4)]),
        ("a: !thing 1\n!!str b: 1\n", [("RG107", 1, 4), ("RG107", 2, 1)]),
        ("a: !!map {b: 1}\n", [("RG107", 1, 4)]),
        ("a: *b\n", [("RG109", 1, 4)]),
        ("a: &a [1, *a]\n", [("RG109", 1, 11)]),
        ("a: {<<: 1}\n", [("RG109", 1, 9)]),
        ("a: &x [1]\nb: {<<: *x}\n", [("RG109", 2, 9)]),
        ("a: 1\n---\nb: 2\n", [("RG111", 2, 1)]),
        ("a: 010\n", [("RG112", 1, 4)]),
        ("a: [yes, Off, 'no', y]\n", [("RG113", 1, 5), ("RG113", 1, 10)]),
        ("a:\n\tb: 1\n", [("RG104", 2, 1)]),
        ("a: b: c\n", [("RG104", 1, 5)]),
        ("a: [1, 2\n", [("RG104", 2, 1)]),
        ("a: 'x\n", [("RG104", 2, 1)]),
        ("a: \x07\n", [("RG104", 1, 4)]),
        ("é: 1\nü: \x00\n", [("RG104", 2, 4)]),
        ('a: "\\ud800"\n', [("RG104", 1, 7)]),
        ("%YAML 9.0\n---\na: 1\n", [("RG104", 1, 1)]),
        ("a: 1\n b: 2\n", [("RG104", 2, 3)]),
        ("a: @x\n", [("RG104", 1, 4)]),
    ],
)
def test_problems_and_their_places(text: str, expected: list[tuple[str, int, int]]) -> None:
    assert problems(text) == expected


def test_problems_before_a_syntax_error_are_kept() -> None:
    assert problems("a: 010\na: 1\nb: [\n") == [("RG112", 1, 4), ("RG105", 2, 1), ("RG104", 4, 1)]


def test_duplicate_names_the_first_place() -> None:
    assert str(read("a: 1\nb: 2\na: 3\n").problems[0].data["first"]) == "g.yaml:1:1"


@pytest.mark.parametrize("opening", ["[", "{a: ", "- ", "? "])
def test_depth_is_limited(opening: str) -> None:
    started = time.perf_counter()
    assert [p[0] for p in problems(opening * 200_000)] in (["RG108"], ["RG106"])
    assert time.perf_counter() - started < 5


def test_depth_limit_is_exact() -> None:
    assert problems("[" * MAX_DEPTH + "]" * MAX_DEPTH) == []
    assert problems("[" * (MAX_DEPTH + 1) + "]" * (MAX_DEPTH + 1)) == [("RG108", 1, MAX_DEPTH + 1)]


def test_depth_counts_through_aliases() -> None:
    half = MAX_DEPTH // 2
    inner = "[" * half + "]" * half
    fits = f"a: &a {inner}\nb: {'[' * (half - 1)}*a{']' * (half - 1)}\n"
    assert problems(fits) == []
    assert [p[0] for p in problems(fits.replace("*a", "[*a]"))] == ["RG108"]
    chain = "a0: &a0 [x]\n" + "".join(f"a{i}: &a{i} [*a{i - 1}]\n" for i in range(1, MAX_DEPTH + 2))
    assert [p[0] for p in problems(chain)] == ["RG108"]


def test_alias_bomb() -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 12)]
    assert [p[0] for p in problems("\n".join(lines))] == ["RG103"]


def test_merge_bomb() -> None:
    keys = ", ".join(f"k{i}: 1" for i in range(1000))
    uses = "\n".join(f"m{i}: {{<<: *big}}" for i in range(1000))
    assert [p[0] for p in problems(f"big: &big {{{keys}}}\n{uses}\n")] == ["RG103"]


@pytest.mark.parametrize("text", ["a: &a {x}\n", "a: &a {{{x}: 1}}\n", "&a {x}: 1\n", "a: &a [{x}]\n"])
def test_long_texts_cannot_be_repeated_without_bound(text: str) -> None:
    bomb = text.replace("{x}", "x" * 900).replace("{{", "{").replace("}}", "}")
    assert [p[0] for p in problems(f"{bomb}b: [{'*a,' * 40_000}]\n")] == ["RG103"]
    assert problems(f"{bomb}b: [{'*a,' * 400}]\n") == []


def test_number_of_values_is_limited() -> None:
    assert [p[0] for p in problems("[" + "1," * (MAX_VALUES + 1) + "]")] == ["RG103"]


def test_positions() -> None:
    reading = read("a: 1\nb:\n  c: [x, {d: é, e: 2}]\n  f:\n  - g: 1\nh: &h {i: 1}\nj: *h\n")
    assert reading.root is not None
    where = PositionMap("g.yaml", reading.root)

    def at(*loc: str | int, key: bool = False) -> tuple[int, int]:
        found = where.find(loc, key=key)
        return found.line, found.column

    assert at() == (1, 1)
    assert at("a") == (1, 4)
    assert at("a", key=True) == (1, 1)
    assert at("b", "c", 0) == (3, 7)
    assert at("b", "c", 1, "e") == (3, 20)
    assert at("b", "c", 1, "e", key=True) == (3, 17)
    assert at("b") == (2, 1)  # a block mapping stands where its key does
    assert at("b", "f", 0, "g") == (5, 8)
    assert at("b", "nothing", "here") == (2, 1)
    assert at("a", "below a scalar") == (1, 1)
    assert at("j", "i") == (6, 11)  # what an alias repeats is written at its anchor


def test_both_parsers_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    import yaml

    from rendergraph.document import yaml_reader

    text = "a: &a {x: 1e-3, y: [1, no]}\nb: {<<: *a, z: '1'}\n"
    fast = read(text)
    monkeypatch.setattr(yaml_reader, "_LOADER", yaml.SafeLoader)
    slow = read(text)
    assert slow.value == fast.value
    assert [p.code for p in slow.problems] == [p.code for p in fast.problems]
    assert problems("a: [1\n") == [("RG104", 2, 1)]
    assert problems("a: \x01\n") == [("RG104", 1, 4)]
