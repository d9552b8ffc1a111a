"""Starts for users: a graph file, or a package with a node of their own. Nothing that exists is overwritten."""

from __future__ import annotations

import keyword
import re
from pathlib import Path
from string import Template

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.document.whole_files import whole_file

TEMPLATES = Path(__file__).resolve().parent.parent / "templates"


def write_graph(path: Path) -> list[Path]:
    """Write a small graph that renders; the suffix becomes .yaml. Raises RenderGraphError RG571 when it exists."""
    path = path if path.suffix in (".yaml", ".yml") else path.with_name(path.name + ".yaml")
    # A file's name may hold anything; what stands in the YAML may not.
    stem = re.sub(r"[^A-Za-z0-9_.-]+", "_", path.stem)[:100]
    title = re.sub(r"[\W_]+", " ", path.stem).strip()[:100].capitalize() or "Graph"
    _write({path: TEMPLATES / "graph.yaml"}, file=stem + path.suffix, stem=stem, title=title)
    return [path]


def write_node(name: str, folder: Path) -> list[Path]:
    """Write a package ``folder/name`` with one node. Raises RenderGraphError RG571 (exists), RG572 (not a name)."""
    if not re.fullmatch(r"[a-z][a-z0-9_]{0,40}", name) or keyword.iskeyword(name):
        raise RenderGraphError([diagnose("RG572", name=name)], exit_code=2)
    root, source = folder / name, TEMPLATES / "node"
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


def _write(files: dict[Path, Path], **values: str) -> None:
    for target in files:
        if target.exists():
            raise RenderGraphError([diagnose("RG571", path=str(target))], exit_code=2)
    for target, source in files.items():
        with whole_file(target) as temporary:
            temporary.write_text(Template(source.read_text(encoding="utf-8")).substitute(values), encoding="utf-8")
