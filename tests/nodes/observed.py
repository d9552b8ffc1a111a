"""Runs a graph, shows what its passes saw and did, and holds one against its node's reference."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rendergraph.device import includes
from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.measure.metrics import compare
from rendergraph.measure.truth.observe import observe
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import PassRun, Truth
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.expand import expand
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import PlannedDocument, plan_document
from rendergraph.scene.load import LoadedScene
from rendergraph.scene.scene import Camera, Scene
from rendergraph.scene.texture_arrays import place_textures

#: A small frame of a shipped graph.
SMALL = ("frame.size=[96, 54]", "scene.detail=0")


def observe_graph(device: Device, graph: str | Path, *overrides: str, scene: str | None = None) -> dict[str, PassRun]:
    """The passes of a shipped graph, or of a file's, in their last frame."""
    document = load_document(graph, overrides)
    planned = plan_document(document, PlanOptions(), scene=scene)
    return observe(document, planned, device, list(document.model.passes))


def observe_scene(device: Device, folder: Path, text: str, scene: Scene, camera: Camera) -> dict[str, PassRun]:
    """The passes of a graph (whose own ``scene:`` is only a placeholder) on ``scene`` seen by ``camera``."""
    path = folder / "observed.yaml"
    path.write_text(text)
    document = load_document(path)
    features = replace(scene.features(), texture_arrays=len(place_textures(scene).arrays))
    graph, _ = expand(document, features=features)
    plan, _ = compile_plan(graph)
    planned = PlannedDocument(plan, LoadedScene(scene, camera), (), 0, 0)
    return observe(document, planned, device, list(document.model.passes))


def judge(node: str, run: PassRun) -> Mapping[str, Truth]:
    """What the node's reference says."""
    truths: Mapping[str, Truth] = importlib.import_module(f"rendergraph.nodes.{node}.reference").judge(run)
    return truths


def broken_invariants(node: str, run: PassRun) -> list[str]:
    """The sentences of the node's invariants that do not hold."""
    return list(importlib.import_module(f"rendergraph.nodes.{node}.reference").invariants(run))


def above(node: str, run: PassRun, *, least: float = 0.02) -> list[str]:
    """The measures whose error is above their tolerance. A measure that is known at fewer than ``least`` of the texels
    is left out, and named with a question mark.
    """
    reference = find_node(node).reference
    assert reference is not None
    found = []
    for name, truth in judge(node, run).items():
        measure = reference.measures[name]
        judged = run.outputs[measure.port].astype(np.float64) if truth.judged is None else truth.judged
        if truth.mask is not None and truth.mask.mean() < least:
            found.append(name + "?")
            continue
        value = compare(measure.quantity, judged, truth.value, truth.mask, [measure.metric])[measure.metric]
        assert value is not None
        tolerance = measure.tolerance if truth.tolerance is None else truth.tolerance
        if not value <= tolerance:
            found.append(name)
    return found


def with_output(run: PassRun, port: str, pixels: Any) -> PassRun:
    """The run, had the port held other pixels."""
    return replace(run, outputs={**run.outputs, port: pixels})


def half_texel(pixels: np.ndarray) -> np.ndarray:
    """An image moved by half a texel to the right."""
    return 0.5 * (pixels + np.roll(pixels, 1, axis=-2))


def mistake(monkeypatch: pytest.MonkeyPatch, file: str, right: str, wrong: str) -> None:
    """From now on a shader file of that name is read with ``right`` replaced; the file itself stays as it is."""
    read = includes._read

    def misread(path: Path, at: Any) -> list[str]:
        lines = read(path, at)
        if path.name != file:
            return lines
        text = "\n".join(lines)
        assert right in text, f"{file} has no '{right}' any more: choose another mistake"
        return text.replace(right, wrong).split("\n")

    monkeypatch.setattr(includes, "_read", misread)
