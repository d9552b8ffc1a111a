"""Renders a document: plans it, runs its frames on the device, times them, and hands back pixels and numbers."""

from __future__ import annotations

import time
from dataclasses import asdict

from rendergraph.device.clock import choose_clock
from rendergraph.device.context import Device, open_device
from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.run.image_files import capture_files, require_writer
from rendergraph.run.options import Progress, RenderOptions
from rendergraph.run.plan_document import PlannedDocument, plan_document, scene_cameras
from rendergraph.run.result import DeviceFacts, FrameResult, Pixels, RunTimes, SteadyState
from rendergraph.run.session import Session
from rendergraph.scene.scene import Camera

__all__ = ["Progress", "RenderOptions", "frame_cameras", "render_document", "run_plan"]

#: Frames run again before timing, so that no pass is timed while the driver still compiles a variant of it.
WARM_UP = 1


def render_document(
    document: Document, options: RenderOptions | None = None, progress: Progress = lambda stage, done, total: None
) -> FrameResult:
    """Plan a document for its scene and run it on this process's device.

    :raises RenderGraphError: for every mistake of the document, its files or its shaders, and where no GL is.
    """
    options = options or RenderOptions()
    progress("planning", 0, 1)
    planned = plan_document(
        document, options.plan, scene=options.scene, size=options.size, frames=options.frames, full=options.full
    )
    _check_files(planned, document, options.captures)
    device = open_device(options.device)
    result = run_plan(planned, document, device, options, progress)
    if options.afterwards is not None:
        options.afterwards(planned, device)
    return result


def _check_files(planned: PlannedDocument, document: Document, captures: tuple[str, ...]) -> None:
    """Refuse, before anything is rendered, what could not be written after it (RG562, RG564, RG568)."""
    outputs = document.model.outputs
    for name in planned.plan.graph.outputs:
        require_writer(outputs[name].file, document.position("outputs", name, "file"))
    files = {output.file: name for name, output in outputs.items()}
    for name in captures:
        if name not in planned.plan.lifetimes:
            known = ", ".join(sorted(planned.plan.lifetimes))
            raise RenderGraphError([diagnose("RG564", name=name, known=known)], exit_code=2)
        for file in capture_files(planned.plan.graph.resources[name]):
            if files.get(file, name) != name:
                place = document.position("outputs", files[file], "file")
                raise RenderGraphError(
                    [diagnose("RG568", place, name=name, output=files[file], file=file)], exit_code=2
                )


def run_plan(
    planned: PlannedDocument, document: Document, device: Device, options: RenderOptions, progress: Progress
) -> FrameResult:
    """Run a plan's frames; see :func:`render_document`."""
    session = Session(document, planned, device, options)
    try:
        session.prepare(lambda done, total: progress("compiling", done, total))
        count = planned.plan.graph.frame.count
        files = {name: document.model.outputs[name].file for name in planned.plan.graph.outputs}
        images: dict[str, Pixels] = {}
        captures: dict[str, Pixels] = {}
        names: dict[str, str] = {}
        first_ns = 0
        for index in range(count):
            progress("rendering", index, count)
            start = time.perf_counter_ns()
            wanted = options.captures if index == count - 1 else ()
            captures |= session.frame(capture=wanted, check_finite=options.check_finite)
            device.finish()
            if index == 0:
                first_ns, after_first = time.perf_counter_ns() - start, device.counters.snapshot()
            for name, file in files.items():
                if "{frame}" in file:
                    key, pixels = f"{name}@{index}", session.read(name)
                    names[key] = file.replace("{frame}", f"{index:04d}")
                    if options.take_frame is not None:
                        options.take_frame(names[key], pixels)
                    else:
                        images[key] = pixels
                elif index == count - 1:
                    images[name], names[name] = session.read(name), file
        runner = session.runner
        warm_up = WARM_UP if options.samples else 0
        for index in range(count, count + warm_up):
            runner.run_frame(index)
        steady = device.counters - after_first - session.made_by_switches
        following = count + warm_up
        if options.inspect is not None:
            progress("reading targets", 0, 1)
            runner.run_frame(following, inspect=options.inspect)
            following += 1
        counters = runner.count_frame(following) if options.samples else runner.count_plan()
        following += 1 if options.samples else 0
        clock = choose_clock(device)
        frames, handed, steps = runner.time_frames(following, options.samples, clock, progress)
        return FrameResult(
            plan=session.plan,
            images=images,
            files=names,
            captures=captures,
            times=RunTimes(
                planned.plan_ns,
                planned.scene_ns,
                session.compile_ns,
                session.upload_ns,
                first_ns,
                frames,
                steps,
                warm_up,
                handed,
            ),
            steady=SteadyState(steady.objects_created, steady.programs_compiled, steady.bytes_uploaded),
            device=DeviceFacts(
                device.info.renderer, device.info.vendor, device.info.driver, clock.name, asdict(clock.proof)
            ),
            frames=count,
            warnings=(*planned.warnings, *session.notes, *device.debug.take_warnings()),
            counters=counters,
            switches=tuple(session.switches),
        )
    finally:
        session.close()


def frame_cameras(planned: PlannedDocument) -> list[Camera]:
    """One camera a frame; see :func:`rendergraph.run.plan_document.scene_cameras`."""
    return scene_cameras(planned.scene, planned.plan.graph.frame.count)
