"""Where a scene comes from: a shipped scene's name, or a glTF file. Imports no numpy, so that validation can ask."""

from __future__ import annotations

from pathlib import Path

from rendergraph.document.messages import Diagnostic, diagnose
from rendergraph.document.suggest import closest, did_you_mean
from rendergraph.plan.graph import Position
from rendergraph.scene import procedural

_SUFFIXES = (".glb", ".gltf")


def source_problem(source: str, root: Path, position: Position | None, *, base: str) -> Diagnostic | None:
    """What keeps ``source`` from being opened: RG650 for what is neither a shipped scene nor a .gltf or .glb, RG651
    for a file that is not there. Files are relative to ``root``, which messages call ``base``.
    """
    if source in procedural.SHIPPED:
        return None
    if Path(source).suffix.lower() not in _SUFFIXES:
        otherwise = "name a shipped scene ({choices}) or a .gltf or .glb file"
        return diagnose("RG650", position, source=source, hint=did_you_mean(source, procedural.SHIPPED, otherwise))
    path = root / source
    try:
        reason = "it is a folder" if path.is_dir() else None if path.is_file() else "there is no such file"
    except (OSError, ValueError) as error:  # a name too long, or one with a NUL
        reason = str(error)
    if reason is None:
        return None
    return diagnose("RG651", position, path=str(path), reason=reason, hint=_nearest_file(path, base))


def _nearest_file(path: Path, base: str) -> str:
    """A help line: the scene file beside ``path`` with the nearest name."""
    otherwise = f"check the path: it is relative to {base}"
    try:
        beside = [
            entry.name for entry in path.parent.iterdir() if entry.suffix.lower() in _SUFFIXES and entry.is_file()
        ]
    except (OSError, ValueError):
        return otherwise
    near = closest(path.name, beside)
    return f"did you mean '{near}'?" if near else otherwise
