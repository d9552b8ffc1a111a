"""``--set passes.blur.set.radius=2``: values from the command line laid over those of the file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.document.positions import Branch, Mark, Place, start, to_position
from rendergraph.document.suggest import did_you_mean
from rendergraph.document.yaml_reader import read_yaml
from rendergraph.plan.graph import Position

USAGE = 2  # exit code
SET_PREFIX = "--set "  # how the positions of an override name their file
_NAMED = ("passes", "resources", "outputs")  # sections whose keys the author makes up


def apply_overrides(data: Any, root: Branch, overrides: Sequence[str]) -> tuple[Any, Branch, list[Diagnostic]]:
    """``data`` and its places with every override applied in order; neither is changed in place.

    The third value lists what is wrong with values that can still be read. Raises ``RenderGraphError``, exit code 2:
    RG130 no ``=``, RG131 a path that leads nowhere, and the codes of YAML syntax for the value.
    """
    problems: list[Diagnostic] = []
    errors: list[Diagnostic] = []
    for argument in overrides:
        try:
            override = _parse(argument, problems)
            data, root = _write(data, root, override)
        except RenderGraphError as error:
            errors += error.diagnostics
    if errors:
        raise RenderGraphError(errors, USAGE)
    return data, root, problems


@dataclass(frozen=True, slots=True)
class _Override:
    argument: str
    path: str
    value: Any
    place: Place

    @property
    def position(self) -> Position:
        return Position(SET_PREFIX + self.argument, 1, 1)

    def dead_end(self, problem: str, hint: str) -> RenderGraphError:
        return RenderGraphError([diagnose("RG131", self.position, path=self.path, problem=problem, hint=hint)])


def _parse(argument: str, problems: list[Diagnostic]) -> _Override:
    path, equals, _ = argument.partition("=")
    file = SET_PREFIX + argument
    if not equals or not all(path.strip().split(".")) or len(argument) > 100_000:
        shown = argument if len(argument) <= 60 else argument[:57] + "..."
        raise RenderGraphError([diagnose("RG130", Position(file, 1, 1), argument=shown)])
    # Blanks in place of the path: the parser then counts columns as the author sees them in the argument.
    text = " " * (len(path) + 1) + argument[len(path) + 1 :]
    reading = read_yaml(text.encode("utf-8", "replace"), file)
    problems += reading.problems
    after_equals = Position(file, 1, len(path) + 2)
    return _Override(argument, path.strip(), reading.value, _placed(reading.root or after_equals, file))


def _placed(place: Place, file: str) -> Place:
    """The same places with the argument's name in them, to stand among those of the file."""
    if not isinstance(place, Branch):
        return to_position(file, place)
    children: dict[str | int, tuple[Mark | Position | None, Place]] = {
        part: (None if key is None else to_position(file, key), _placed(value, file))
        for part, (key, value) in place.children.items()
    }
    return Branch(to_position(file, place.mark), children)


def _write(data: Any, root: Branch, override: _Override) -> tuple[Any, Branch]:
    parts = _parts(override.path, data)
    _check_named(parts, data, override)
    new_data, new_root = _copied(data), Branch(root.mark, dict(root.children))
    at_data, at_place = new_data, new_root
    for depth, part in enumerate(parts):
        if isinstance(at_data, list) and part not in _keys(at_data):
            raise override.dead_end(f"the list has {len(at_data)} entries", "give an index, counted from 0")
        key: Mark | Position | None = None if isinstance(at_data, list) else override.position
        if depth == len(parts) - 1:
            at_data[part] = override.value
            at_place.children[part] = (key, override.place)
            break
        child = at_data[part] if part in _keys(at_data) else None
        if child is not None and not isinstance(child, (dict, list)):
            where = ".".join(map(str, parts[: depth + 1]))
            raise override.dead_end(
                f"'{where}' holds no keys", "shorten the path, or give a whole mapping as the value"
            )
        key, place = at_place.children.get(part, (key, override.position))
        branch = Branch(start(place), dict(place.children) if isinstance(place, Branch) else {})
        at_data[part] = _copied(child) if child is not None else {}
        at_place.children[part] = (key, branch)
        at_data, at_place = at_data[part], branch
    return new_data, new_root


def _parts(path: str, data: Any) -> list[str | int]:
    """The path's keys. A key may itself hold dots (``outputs.light.histogram.file``): the longest that exists wins."""
    words = path.split(".")
    parts: list[str | int] = []
    while words:
        taken = 1
        part: str | int = words[0]
        if isinstance(data, list):
            part = int(words[0]) if words[0].isascii() and words[0].isdigit() and len(words[0]) < 9 else words[0]
        elif isinstance(data, dict):
            fits = (n for n in range(min(len(words), 8), 0, -1) if ".".join(words[:n]) in data)
            taken = next(fits, 1)
            if taken == 1 and words[0] not in data and parts == ["outputs"] and len(words) > 1:
                taken = _output_words(words)
            part = ".".join(words[:taken])
        parts.append(part)
        data = data[part] if part in _keys(data) else None
        words = words[taken:]
    return parts


def _output_words(words: list[str]) -> int:
    """A new output of a node's internal resource has dots in its name: all but a last ``file`` or ``format``."""
    return len(words) - 1 if words[-1] in ("file", "format") else len(words)


def _check_named(parts: list[str | int], data: Any, override: _Override) -> None:
    if len(parts) < 3 or parts[0] not in _NAMED or (parts[0] == "outputs" and len(parts) == 3):
        return
    section = data.get(parts[0]) if isinstance(data, dict) else None
    names = section if isinstance(section, dict) else {}
    if parts[1] not in names:
        problem = f"there is no '{parts[1]}' under {parts[0]}"
        raise override.dead_end(problem, did_you_mean(str(parts[1]), names, "there are: {choices}"))


def _keys(container: Any) -> Any:
    return range(len(container)) if isinstance(container, list) else container if isinstance(container, dict) else ()


def _copied(container: Any) -> Any:
    return list(container) if isinstance(container, list) else dict(container)
