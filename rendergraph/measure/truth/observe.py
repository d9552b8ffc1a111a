"""Runs a planned graph and looks at passes as they run: their inputs right before, their outputs right after."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
import numpy.typing as npt

from rendergraph.device.context import Device
from rendergraph.document.formats import FORMATS
from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.measure.truth.decode import F64, decode
from rendergraph.measure.truth.surfaces import cached_trace
from rendergraph.node.discovery import find_node
from rendergraph.node.params import Params
from rendergraph.node.reference import PassRun
from rendergraph.plan.graph import BufferDesc, TextureDesc
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import PlannedDocument, plan_document
from rendergraph.run.render import frame_cameras
from rendergraph.run.runner import Runner
from rendergraph.scene.floating_origin import camera_from, scene_from

Content = F64 | npt.NDArray[np.uint32]


def observe(
    document: Document,
    planned: PlannedDocument,
    device: Device,
    passes: Iterable[str],
    *,
    frame: int | None = None,
    poison: bool = False,
) -> dict[str, PassRun]:
    """Run frames 0 to ``frame`` (by default the file's last) and give back what the named passes saw and did in the
    last of them. Passes that the plan left out, whole, are left out here.

    :raises RenderGraphError: for every error of the run.
    """
    plan = planned.plan
    last = plan.graph.frame.count - 1 if frame is None else frame
    scene = planned.scene.scene if planned.scene else None
    runner = Runner(device, plan, scene, frame_cameras(planned), poison=poison)
    try:
        runner.prepare()
        for index in range(last):
            runner.run_frame(index)
        return watch_frame(runner, document, planned, device, set(passes), last)
    finally:
        runner.release()


def observe_frames(
    document: Document, planned: PlannedDocument, device: Device, passes: Iterable[str], count: int
) -> Iterator[dict[str, PassRun]]:
    """The same of the file's last frame and of ``count - 1`` more after it, in which the camera stands still: what
    still changes is the frame's index, and with it all that is random. One frame is held at a time.
    """
    last = planned.plan.graph.frame.count - 1
    cameras = frame_cameras(planned)
    cameras += [cameras[-1]] * (count - 1)
    runner = Runner(device, planned.plan, planned.scene.scene if planned.scene else None, cameras)
    names = set(passes)
    try:
        runner.prepare()
        for index in range(last):
            runner.run_frame(index)
        for index in range(last, last + count):
            yield watch_frame(runner, document, planned, device, names, index)
    finally:
        runner.release()


def watch_frame(
    runner: Runner,
    document: Document,
    planned: PlannedDocument,
    device: Device,
    passes: set[str],
    index: int,
    after: Callable[[int], None] = lambda position: None,
    prepare: Callable[[str], None] = lambda name: None,
) -> dict[str, PassRun]:
    """One frame of a runner that is ready: what the named passes saw and did. ``after`` is called behind each command,
    with its position in the plan's order; ``prepare`` with a pass's name before its inputs are looked at, which it may
    change.
    """
    plan = planned.plan
    of = [subpass.name.partition(".")[0] for subpass in plan.order]
    first = {name: of.index(name) for name in passes if name in of}
    final = {name: len(of) - 1 - of[::-1].index(name) for name in first}
    inputs: dict[str, dict[str, Content]] = {}
    before: dict[str, dict[str, Content]] = {}
    runs = {}
    cameras = frame_cameras(planned)
    scene = scene_from(planned.scene.scene, runner.origin) if planned.scene else None
    camera = camera_from(cameras[min(index, len(cameras) - 1)], runner.origin)
    trace = cached_trace(scene, camera, plan.graph.frame) if scene else None  # one for all passes
    for position, command in enumerate(runner.commands_of(index)):
        for name in (name for name, at in first.items() if at == position):
            model = document.model.passes[name]
            prepare(name)
            inputs[name] = _contents(runner, planned, model.read, index)
            node = find_node(model.node)(_params(document, name))
            modified = {port: target for port, target in model.write.items() if node.modifies(port)}
            before[name] = _contents(runner, planned, modified, index)
        command.run()
        after(position)
        for name in (name for name, at in final.items() if at == position):
            model = document.model.passes[name]
            ports = {**model.read, **model.write}
            runs[name] = PassRun(
                params=_params(document, name),
                inputs=inputs[name],
                outputs=_contents(runner, planned, model.write, index),
                descs={port: plan.graph.resources[r].desc for port, r in ports.items() if r in plan.graph.resources},
                frame=plan.graph.frame,
                before=before[name],
                index=index,
                folder=document.path.parent,
                levels=_levels(runner, planned, model.write, index),
                stencils=_stencils(runner, planned, model.write, index),
                scene=scene,
                camera=camera,
                supersampled=partial(supersampled, document, planned, device, name),
                trace=trace,
            )
    device.check()
    return runs


def _params(document: Document, name: str) -> Params:
    model = document.model.passes[name]
    return find_node(model.node).params_type.model_validate(model.set)


def _contents(runner: Runner, planned: PlannedDocument, ports: Mapping[str, str], index: int) -> dict[str, Content]:
    return {
        port: content(runner, planned, resource, index)
        for port, resource in ports.items()
        if resource in planned.plan.lifetimes
    }


def _levels(
    runner: Runner, planned: PlannedDocument, ports: Mapping[str, str], index: int
) -> dict[str, tuple[F64, ...]]:
    levels = {}
    for port, resource in ports.items():
        desc = planned.plan.graph.resources[resource].desc
        if resource in planned.plan.lifetimes and isinstance(desc, TextureDesc) and desc.mips > 1 and desc.layers == 1:
            read = [runner.read(resource, index, mip=mip) for mip in range(1, desc.mips)]
            levels[port] = tuple(decode(texels, desc.format) for texels in read)
    return levels


def _stencils(runner: Runner, planned: PlannedDocument, ports: Mapping[str, str], index: int) -> dict[str, F64]:
    stencils = {}
    for port, resource in ports.items():
        desc = planned.plan.graph.resources[resource].desc
        if resource in planned.plan.lifetimes and isinstance(desc, TextureDesc) and FORMATS[desc.format].stencil:
            stencils[port] = runner.read(resource, index, aspect="stencil").astype(np.float64)
    return stencils


def content(runner: Runner, planned: PlannedDocument, resource: str, index: int) -> Content:
    """What a resource holds now: float64[h, w, c] (``[layers, h, w, c]``) as a shader reads it, or uint32[words]."""
    desc = planned.plan.graph.resources[resource].desc
    texels = runner.read(resource, index)
    if isinstance(desc, BufferDesc):
        return np.ascontiguousarray(texels).view(np.uint32).ravel()
    values = decode(texels, desc.format)
    return np.stack(np.split(values, desc.layers, axis=1)) if desc.layers > 1 else values


def supersampled(
    document: Document, planned: PlannedDocument, device: Device, name: str, port: str, factor: int
) -> F64:
    """An input of a pass, from the graph rendered at ``factor`` times the frame's width and height, each pixel the mean
    of its ``factor * factor`` samples: float64[h, w, c].

    :raises RenderGraphError: RG740 where the resource does not grow with the frame.
    """
    frame = planned.plan.graph.frame
    resource = document.model.passes[name].read[port]
    desc = planned.plan.graph.resources[resource].desc
    large = plan_document(
        document, PlanOptions(), size=(frame.width * factor, frame.height * factor), frames=frame.count
    )
    large = replace(large, scene=planned.scene)
    grown = large.plan.graph.resources[resource].desc
    if (
        not isinstance(desc, TextureDesc)
        or not isinstance(grown, TextureDesc)
        or (grown.width, grown.height) != (desc.width * factor, desc.height * factor)
    ):
        raise RenderGraphError([diagnose("RG740", document.position("passes", name), resource=resource)])
    values = observe(document, large, device, [name])[name].inputs[port]
    h, w, c = desc.height, desc.width, values.shape[-1]
    mean: F64 = values.reshape(h, factor, w, factor, c).mean(axis=(1, 3))
    return mean
