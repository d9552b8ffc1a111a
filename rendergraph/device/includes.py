"""The shader preprocessor: ``#include``, the variant's defines, and line numbers that lead back to the author's file.

GLSL's ``#line`` takes a source number that Mesa does not print, but large line numbers survive in every driver's
messages: line ``N`` of file ``i`` is numbered ``i * 100000 + N``.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.plan.graph import Position

#: Where ``#include <name>`` looks first: the library's shared GLSL.
SHARED: Final = Path(__file__).resolve().parent.parent / "shaders"
LINES_A_FILE: Final = 100_000
_MOST_INCLUDES: Final = 1000  # a chain of files that each include the next twice doubles at every step
_DIRECTIVE = re.compile(r"^\s*#\s*(include|version)\b(.*)$")
_INCLUDE = re.compile(r"^\s*(?:<([^<>\"]+)>|\"([^<>\"]+)\")\s*$")
_COMMENT = re.compile(r"//|/\*")


@dataclass(slots=True)
class FileTable:
    """The files of one expanded shader; file ids count from 1 in order of first inclusion."""

    paths: list[Path] = field(default_factory=list)

    def locate(self, line: int, column: int = 1) -> Position:
        """The author's place of a line number in the driver's message."""
        identity, inside = divmod(line, LINES_A_FILE)
        if not 1 <= identity <= len(self.paths):  # the lines before the first #line: #version and the defines
            identity, inside = 1, 1
        return Position(str(self.paths[identity - 1]), max(1, inside), max(1, column))


def preprocess(
    path: Path,
    defines: Sequence[tuple[str, str]] = (),
    include_dirs: Sequence[Path] = (),
    asked_by: Position | None = None,
) -> tuple[str, FileTable]:
    """The shader's text with includes expanded, and the table that maps its line numbers back.

    ``<name>`` is looked up in the shared folder, then in ``include_dirs``; ``"name"`` beside the including file. Every
    included file must lie in one of those folders or under the shader's own. A file's text counts once, however
    often it is included. Defines follow ``#version``, which defaults to 450. ``asked_by`` is where the graph names it.

    :raises RenderGraphError: RG510 unreadable, RG511 not found, RG512 a cycle, RG513 outside the allowed folders,
        RG514 a malformed directive.
    """
    roots = tuple(root.resolve() for root in (path.parent, SHARED, *include_dirs))
    expansion = _Expansion(roots, (SHARED, *include_dirs))
    body = expansion.expand(path, (), asked_by)
    head = [f"#version {expansion.version}", *(f"#define {name} {value}".rstrip() for name, value in defines)]
    return "\n".join([*head, *body, ""]), expansion.files


@dataclass(slots=True)
class _Expansion:
    roots: tuple[Path, ...]
    search: tuple[Path, ...]
    files: FileTable = field(default_factory=FileTable)
    version: str = "450"
    includes: int = 0

    def expand(self, path: Path, chain: tuple[tuple[Path, Position], ...], at: Position | None) -> list[str]:
        lines = _read(path, at)
        if path not in self.files.paths:
            self.files.paths.append(path)
        identity = self.files.paths.index(path) + 1
        base = identity * LINES_A_FILE
        body = [f"#line {base + 1}"]
        commented = False
        for number, line in enumerate(lines, 1):
            code, commented = _without_comments(line, commented)
            match = _DIRECTIVE.match(code)
            if match is None:
                # Only a comment can hold one here, and moderngl would expand it even there.
                body.append(line.replace("#include", "# include"))
            elif match[1] == "version":
                if chain or self.version_given(body):
                    here = Position(str(path), number, 1)
                    raise RenderGraphError([diagnose("RG514", here, text=line.strip())])
                self.version = match[2].strip()
                body.append("")
            else:
                here = Position(str(path), number, line.index("#") + 1)
                body += self._include(match[2], line, path, chain, here)
                body.append(f"#line {base + number + 1}")
        return body

    def version_given(self, body: list[str]) -> bool:
        """Whether ``#version`` comes too late: something but blank lines and comments is before it."""
        commented = False
        for line in body[1:]:
            code, commented = _without_comments(line, commented)
            if code.strip():
                return True
        return False

    def _include(
        self, text: str, line: str, path: Path, chain: tuple[tuple[Path, Position], ...], here: Position
    ) -> list[str]:
        match = _INCLUDE.match(text)
        if match is None:
            raise RenderGraphError([diagnose("RG514", here, text=line.strip())])
        chain = (*chain, (path, here))
        self.includes += 1
        found = self._find(match[1], match[2], path, chain, here)
        passed = [including.resolve() for including, _ in chain]
        if found.resolve() in passed or self.includes > _MOST_INCLUDES:
            steps = " -> ".join([*(including.name for including, _ in chain), found.name])
            raise RenderGraphError([diagnose("RG512", here, name=text.strip(), chain=steps)])
        body = self.expand(found, chain, here)
        guard = f"RG_INCLUDED_{self.files.paths.index(found) + 1}"
        return [f"#ifndef {guard}", f"#define {guard}", *body, "#endif"]

    def _find(
        self,
        shared: str | None,
        beside: str | None,
        path: Path,
        chain: tuple[tuple[Path, Position], ...],
        here: Position,
    ) -> Path:
        written = f"<{shared}>" if shared else f'"{beside}"'
        folders = self.search if shared else (path.parent,)
        said = {"name": written, "chain": _say(chain)}
        for folder in folders:
            candidate = Path(os.path.normpath(folder / (shared or beside or "")))
            # Refused before it is known to exist: a graph must not be able to probe the disk.
            if not any(candidate.resolve().is_relative_to(root) for root in self.roots):
                roots = ", ".join(str(root) for root in self.roots)
                raise RenderGraphError([diagnose("RG513", here, roots=roots, **said)])
            if candidate.is_file():
                return candidate
        raise RenderGraphError([diagnose("RG511", here, searched=", ".join(map(str, folders)), **said)])


def _say(chain: tuple[tuple[Path, Position], ...]) -> str:
    return "".join(f", included from {position}" for _, position in reversed(chain[:-1]))


def _read(path: Path, at: Position | None) -> list[str]:
    try:
        lines = path.read_text(encoding="utf-8-sig").split("\n")
    except UnicodeDecodeError as error:
        detail = f"byte 0x{error.object[error.start]:02X} at offset {error.start} is not UTF-8"
        raise _unreadable(path, at, detail, "save the shader as UTF-8 text") from None
    except OSError as error:
        raise _unreadable(path, at, error.strerror, "check the file and its permissions") from None
    if len(lines) >= LINES_A_FILE:
        raise _unreadable(path, at, f"more than {LINES_A_FILE - 1} lines", "split it into files that it includes")
    return lines


def _unreadable(path: Path, at: Position | None, detail: str | None, hint: str) -> RenderGraphError:
    return RenderGraphError([diagnose("RG510", at, file=path, detail=detail, hint=hint)])


def _without_comments(line: str, commented: bool) -> tuple[str, bool]:
    """A line's code, and whether a block comment is open at its end."""
    code = ""
    while line:
        if commented:
            _, closed, line = line.partition("*/")
            commented = not closed
            continue
        mark = _COMMENT.search(line)
        if mark is None or mark[0] == "//":
            return code + line[: mark.start() if mark else None], False
        code += line[: mark.start()] + " "
        line, commented = line[mark.end() :], True
    return code, commented
