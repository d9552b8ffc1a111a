"""Starts for users: a graph file, or a package with a node of their own. Nothing that exists is overwritten."""

from __future__ import annotations

import errno
import keyword
import re
import stat
from pathlib import Path
from string import Template

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.whole_files import cannot_write, whole_file

TEMPLATES = Path(__file__).resolve().parent.parent / "templates"


def write_graph(path: Path) -> list[Path]:
    """Write a small graph that renders; the suffix becomes .yaml.

    Raises RenderGraphError RG560 (cannot be written), RG571 (exists), RG574 (its folder does not exist).
    """
    path = path if path.suffix in (".yaml", ".yml") else path.with_name(path.name + ".yaml")
    # A file's name may hold anything; what stands in the YAML may not.
    stem = re.sub(r"[^A-Za-z0-9_.-]+", "_", path.stem)[:100]
    title = re.sub(r"[\W_]+", " ", path.stem).strip()[:100].capitalize() or "Graph"
    _require_folder(path.parent, path)
    _write({path: TEMPLATES / "graph.yaml"}, file=stem + path.suffix, stem=stem, title=title)
    return [path]


def write_node(name: str, folder: Path) -> list[Path]:
    """Write a package ``folder/name`` with one node.

    Raises RenderGraphError RG560 (cannot be written), RG571 (exists), RG572 (not a name), RG574 (no such folder).
    """
    if not re.fullmatch(r"[a-z][a-z0-9_]{0,40}", name) or keyword.iskeyword(name):
        raise RenderGraphError([diagnose("RG572", name=name)], exit_code=2)
    root, source = folder / name, TEMPLATES / "node"
    _require_folder(folder, root)
    package = root / f"rendergraph_{name}"
    files = {
        root / "pyproject.toml": source / "pyproject.toml",
        root / "README.md": source / "README.md",
        root / "example.yaml": source / "example.yaml",
        package / "__init__.py": source / "node.py",
        package / f"{name}.frag": source / "node.frag",
        root / "tests" / f"test_{name}.py": source / "tests" / "test_node.py",
    }
    class_name = "".join(word.capitalize() for word in name.split("_"))
    _write(files, name=name, dashed=name.replace("_", "-"), class_name=class_name)
    return list(files)


def _require_folder(folder: Path, path: Path) -> None:
    """A mistyped folder is not made on the way."""
    try:
        mode = folder.stat().st_mode
    except FileNotFoundError:
        raise RenderGraphError([diagnose("RG574", path=str(path), folder=str(folder))], exit_code=2) from None
    except OSError as error:
        raise cannot_write(path, error) from None
    if not stat.S_ISDIR(mode):
        raise cannot_write(path, NotADirectoryError(errno.ENOTDIR, ""))


def _write(files: dict[Path, Path], **values: str) -> None:
    for target in files:
        try:
            exists = target.exists()
        except OSError as error:
            raise cannot_write(target, error) from None
        if exists:
            raise RenderGraphError([diagnose("RG571", path=str(target))], exit_code=2)
    for target, source in files.items():
        with whole_file(target) as temporary:
            temporary.write_text(Template(source.read_text(encoding="utf-8")).substitute(values), encoding="utf-8")
