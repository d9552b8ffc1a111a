"""What two sweeps must have in common for one to go on where the other stopped."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

import rendergraph
from rendergraph.document.load import Document
from rendergraph.measure.sweep.job import SweepJob
from rendergraph.measure.sweep.points import Point
from rendergraph.node.discovery import find_node
from rendergraph.plan.plan import Plan

_SOURCES: Final = {".vert", ".frag", ".comp", ".geom", ".tesc", ".tese", ".glsl", ".py"}


def sweep_header(job: SweepJob, document: Document, plan: Plan, points: Sequence[Point]) -> dict[str, Any]:
    """The graph with all that belongs to it as hashes, and what was asked."""
    return {
        "rendergraph": rendergraph.__version__,
        "graph": _hash([document.text.encode(), *(text.encode() for text in job.overrides)]),
        "shaders": _hash(path.read_bytes() for path in _files(document, plan)),
        "scene file": _hash(path.read_bytes() for path in _scene_files(document, job)),
        "axes": [f"{axis.path}={'|'.join(axis.values)}" for axis in job.axes],
        "settings": _hash(repr(point.choice).encode() for point in points)[:12],
        "error": job.error.name,
        "judging": _hash([repr(asdict(job.error)).encode()])[:12],
        "scene": job.scene or "",
        "size": f"{job.size[0]}x{job.size[1]}" if job.size else "",
        "frames": job.frames,
        "rounds": job.rounds,
        "seed": job.seed,
        "warm-up": job.most_warm_up,
    }


def _files(document: Document, plan: Plan) -> list[Path]:
    """Every shader of the graph's nodes, of the library and beside the graph, their host code, and imported images."""
    folders = {find_node(model.node).folder for model in document.model.passes.values()}
    folders |= {path.parent for subpass in plan.order if subpass.program for _, path in subpass.program.stages}
    folders.add(Path(rendergraph.__file__).parent / "shaders")
    found = {path for folder in folders for path in folder.glob("*") if path.suffix in _SOURCES and path.is_file()}
    found |= {resource.file for resource in plan.graph.resources.values() if resource.file is not None}
    return sorted(found)


def _scene_files(document: Document, job: SweepJob) -> list[Path]:
    source = job.scene or (document.model.scene.source if document.model.scene is not None else "")
    paths = [Path(source or "."), document.path.parent / (source or ".")]
    return [next(path for path in paths if path.is_file())] if any(path.is_file() for path in paths) else []


def _hash(parts: Any) -> str:
    found = hashlib.sha256()
    for part in parts:
        found.update(len(part).to_bytes(8, "little") + part)
    return found.hexdigest()[:16]
