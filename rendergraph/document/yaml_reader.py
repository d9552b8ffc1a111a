"""YAML text to plain data and positions, in one pass over the parser's events.

Reading events rather than composed nodes keeps hostile input harmless (the parser is lazy, so depth, size and alias
limits stop it early and nothing recurses) and is more than twice as fast. Sources: YAML 1.2.2, chapters 3, 6 and 10.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Final

import yaml
from yaml.events import (
    AliasEvent,
    DocumentEndEvent,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
    StreamEndEvent,
)

from rendergraph.document.messages import Diagnostic, RenderGraphError, diagnose
from rendergraph.document.positions import Branch, Mark, Place, to_position
from rendergraph.document.yaml_anchors import AliasError, Anchored, find_anchored, merge, merge_sources
from rendergraph.document.yaml_errors import syntax_error, unprintable
from rendergraph.document.yaml_scalars import YAML_1_1_BOOLEANS, AmbiguousNumberError, resolve

MAX_DEPTH: Final = 64
MAX_VALUES: Final = 500_000
_LONG: Final = 64  # characters of text that count as one value more, so that repeated long texts stay bounded too

_LOADER: Final[Any] = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_MERGE: Final = "<<"


@dataclass(frozen=True, slots=True)
class Reading:
    """A parsed file. ``value`` and ``root`` are ``None`` for a file without content. Data may share aliased parts, so
    it must not be changed in place.
    """

    value: Any
    root: Place | None
    problems: list[Diagnostic]


@dataclass(slots=True)
class _Open:
    """A mapping or list being read. ``key`` is the mapping key whose value comes next."""

    container: Any
    branch: Branch
    anchor: str | None
    before: int
    key: str | None = None
    key_mark: Mark | None = None
    height: int = 0
    merging: bool = False  # the key is `<<`
    merges: list[tuple[dict[str, Any], Branch]] = field(default_factory=list)


def read_yaml(data: bytes, file: str) -> Reading:
    """Parse UTF-8 ``data``; ``file`` names it in positions.

    Mistakes that leave the rest readable are listed in ``problems``. Raises ``RenderGraphError`` where reading cannot
    go on: RG103 too many values, RG104 syntax, RG106 a key that is a mapping or list, RG108 depth, RG109 aliases,
    RG111 a second document.
    """
    problems: list[Diagnostic] = []
    try:
        loader = _LOADER(data)
        return _Reader(loader.get_event, file, problems).read()
    except _Stop as stop:
        raise RenderGraphError([*problems, stop.diagnostic]) from None
    except yaml.MarkedYAMLError as error:
        raise RenderGraphError([*problems, syntax_error(error, data, file)]) from None
    except yaml.reader.ReaderError as error:
        raise RenderGraphError([*problems, unprintable(error, data, file)]) from None


class _Stop(Exception):  # noqa: N818
    """Reading cannot go on."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__()
        self.diagnostic = diagnostic


class _Reader:
    def __init__(self, next_event: Callable[[], Any], file: str, problems: list[Diagnostic]) -> None:
        self.next_event = next_event
        self.file = file
        self.problems = problems
        self.anchors: dict[str, Anchored] = {}
        self.values = 0

    def read(self) -> Reading:
        self.next_event()  # stream start
        if type(self.next_event()) is StreamEndEvent:
            return Reading(None, None, self.problems)
        value, place = self._document()
        event = self.next_event()
        if type(event) is not StreamEndEvent:
            raise self._stop("RG111", event.start_mark)
        return Reading(value, place, self.problems)

    def _document(self) -> tuple[Any, Place]:
        next_event = self.next_event
        stack: list[_Open] = []
        top: _Open | None = None
        while True:
            event = next_event()
            kind = type(event)
            if kind is ScalarEvent:
                if top is not None and top.key is None and type(top.container) is dict:
                    top.key, top.key_mark = self._key(event, top), event.start_mark
                    continue
                value, place = self._scalar(event), event.start_mark
            elif kind is MappingEndEvent or kind is SequenceEndEvent:
                assert top is not None
                value, place, height = top.container, top.branch, top.height + 1
                self._close(stack.pop())
                top = stack[-1] if stack else None
                if top is not None and top.height < height:
                    top.height = height
            elif kind is AliasEvent:
                value, place = self._alias(event, stack)
            elif kind is MappingStartEvent or kind is SequenceStartEvent:
                top = self._start(event, kind is MappingStartEvent, top, len(stack))
                stack.append(top)
                continue
            elif kind is DocumentEndEvent:
                return value, place
            else:
                raise AssertionError(f"unexpected {kind.__name__}")

            if top is not None:
                self._add(top, value, place, event)

    def _add(self, top: _Open, value: Any, place: Place, event: Any) -> None:
        self.values += 1
        if self.values > MAX_VALUES:
            raise self._stop("RG103", event.start_mark, what="number of values", limit=MAX_VALUES)
        if type(top.container) is list:
            top.branch.children[len(top.container)] = (None, place)
            top.container.append(value)
        elif top.merging:
            self._merge(top, value, place, event)
        else:
            assert top.key is not None
            top.container[top.key] = value
            top.branch.children[top.key] = (top.key_mark, place)
            top.key = None

    # ---------------------------------------------------------------- scalars and keys

    def _scalar(self, event: Any) -> Any:
        text: str = event.value
        if event.tag is not None:
            self._report("RG107", event.start_mark, tag=_shown(event.tag))
        value: Any = text
        if event.implicit[0]:
            try:
                value = resolve(text)
            except AmbiguousNumberError as error:
                value = error.guess
                self._report("RG112", event.start_mark, text=_shown(text), problem=error.problem, hint=error.hint)
            if text in YAML_1_1_BOOLEANS:
                self._report("RG113", event.start_mark, text=text, boolean=YAML_1_1_BOOLEANS[text])
        self._count_text(event, value)
        return value

    def _key(self, event: Any, top: _Open) -> str:
        key: str = event.value
        mark = event.start_mark
        if event.tag is not None:
            self._report("RG107", mark, tag=_shown(event.tag))
        if event.implicit[0]:
            if key == _MERGE:
                top.merging = True
                return key
            if not _is_text(key):
                shown = _shown(key) if key else "nothing"
                self._report("RG106", mark, found=shown, hint=f"quote it: '{shown}'" if key else "write a name")
        self._count_text(event, key)
        if key in top.branch.children:
            first = top.branch.children[key][0]
            assert first is not None
            self._report("RG105", mark, key=_shown(key), first=to_position(self.file, first))
        return key

    def _count_text(self, event: Any, value: Any) -> None:
        extra = len(event.value) // _LONG
        self.values += extra
        if event.anchor is not None:
            self.anchors[event.anchor] = Anchored(value, event.start_mark, 1 + extra, 0)

    # ---------------------------------------------------------------- containers and aliases

    def _start(self, event: Any, mapping: bool, parent: _Open | None, depth: int) -> _Open:
        if depth >= MAX_DEPTH:
            raise self._stop("RG108", event.start_mark, limit=MAX_DEPTH)
        mark = event.start_mark
        if parent is not None and type(parent.container) is dict:
            if parent.key is None:
                found = "a mapping" if mapping else "a list"
                raise self._stop("RG106", mark, found=found, hint="write a name as the key")
            if not event.flow_style and parent.key_mark is not None:
                mark = parent.key_mark  # a block mapping would seem to start at its first key, a line too low
        if event.tag is not None:
            self._report("RG107", event.start_mark, tag=_shown(event.tag))
        opened = _Open({} if mapping else [], Branch(mark, {}), event.anchor, self.values)
        if event.anchor is not None:
            self.anchors[event.anchor] = Anchored(opened.container, opened.branch, 0, -1)
        return opened

    def _close(self, closed: _Open) -> None:
        if closed.merges:
            merge(closed.container, closed.branch, closed.merges)
        if closed.anchor is not None:
            values = self.values - closed.before + 1
            self.anchors[closed.anchor] = Anchored(closed.container, closed.branch, values, closed.height + 1)

    def _alias(self, event: Any, stack: list[_Open]) -> tuple[Any, Place]:
        top = stack[-1] if stack else None
        if top is not None and top.key is None and type(top.container) is dict:
            raise self._stop("RG106", event.start_mark, found=f"the alias *{event.anchor}", hint="write the name out")
        try:
            anchored = find_anchored(self.anchors, event.anchor)
        except AliasError as error:
            raise self._stop("RG109", event.start_mark, problem=error.problem, hint=error.hint) from None
        if len(stack) + anchored.height > MAX_DEPTH:
            raise self._stop("RG108", event.start_mark, limit=MAX_DEPTH)
        if top is not None:
            top.height = max(top.height, anchored.height)
        self.values += anchored.values - 1  # `_add` counts one
        return anchored.value, anchored.place

    def _merge(self, top: _Open, value: Any, place: Place, event: Any) -> None:
        top.key, top.merging = None, False
        sources = merge_sources(value, place)
        if sources is None:
            problem, hint = "a merge key takes a mapping or a list of mappings", "write `<<: *anchor`"
            self._report("RG109", event.start_mark, problem=problem, hint=hint)
            return
        self.values += sum(1 + len(key) // _LONG for source, _ in sources for key in source)
        top.merges += sources

    # ---------------------------------------------------------------- diagnostics

    def _report(self, code: str, mark: Mark, **data: Any) -> None:
        self.problems.append(diagnose(code, to_position(self.file, mark), **data))

    def _stop(self, code: str, mark: Mark, **data: Any) -> _Stop:
        return _Stop(diagnose(code, to_position(self.file, mark), **data))


@lru_cache(4096)  # keys repeat from pass to pass
def _is_text(key: str) -> bool:
    try:
        return type(resolve(key)) is str
    except AmbiguousNumberError:
        return False


def _shown(text: str) -> str:
    return text if len(text) <= 40 else text[:37] + "..."
