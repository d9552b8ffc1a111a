"""A frame through the plan against a hand-written moderngl script that makes the same draws, in turn, in one run.

    python -m benchmarks.frame_overhead

Sixteen full-screen passes, each reading the one before. Prints the median of each and their ratio, over many frames and
three sizes: the smaller the frame, the larger the share of what is not drawing.
"""

from __future__ import annotations

import time
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import moderngl

from rendergraph.device.context import Device, open_device
from rendergraph.document.load import load_document
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import plan_document
from rendergraph.run.render import frame_cameras
from rendergraph.run.runner import Runner

HERE = Path(__file__).resolve().parent
PASSES = 16
FRAMES = 60


def graph(folder: Path, size: tuple[int, int]) -> Path:
    """The chain as a graph file."""
    lines = ["rendergraph: 1", f"frame: {{size: [{size[0]}, {size[1]}]}}", "resources:"]
    lines += [f"  t{i}: {{format: rgba8}}" for i in range(PASSES)]
    lines += ["passes:", "  p0: {node: fullscreen, write: {o_color: t0}, set: {shader: first.frag}}"]
    lines += [
        f"  p{i}: {{node: fullscreen, read: {{u_source: t{i - 1}}}, write: {{o_color: t{i}}}, "
        "set: {shader: chain.frag}}"
        for i in range(1, PASSES)
    ]
    lines += [f"outputs: {{t{PASSES - 1}: {{file: chain.png}}}}"]
    for name in ("first.frag", "chain.frag"):
        (folder / name).write_text((HERE / name).read_text())
    path = folder / "chain.yaml"
    path.write_text("\n".join(lines))
    return path


class HandWritten:
    """The same chain with moderngl alone, as one would write it: two targets in turn, as the plan's aliasing finds."""

    def __init__(self, ctx: moderngl.Context, size: tuple[int, int]) -> None:
        vertex = (
            "#version 450\nvoid main() { vec2 c = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);"
            " gl_Position = vec4(c * 2.0 - 1.0, 0.0, 1.0); }"
        )
        self.textures = [ctx.texture(size, 4) for _ in range(2)]
        self.targets = [ctx.framebuffer([texture]) for texture in self.textures]
        self.first = ctx.vertex_array(ctx.program(vertex, (HERE / "first.frag").read_text()), [])
        self.chain = ctx.vertex_array(ctx.program(vertex, (HERE / "chain.frag").read_text()), [])
        self.ctx = ctx

    def frame(self) -> None:
        """One frame."""
        self.targets[0].use()
        self.first.render(vertices=3)
        for index in range(1, PASSES):
            self.targets[index % 2].use()
            self.textures[(index - 1) % 2].use(0)
            self.chain.render(vertices=3)

    def frame_with_groups(self) -> None:
        """One frame that names its passes for a debugger, as the plan's frames do."""
        with self.ctx.debug_scope("p0", group_id=1):
            self.targets[0].use()
            self.first.render(vertices=3)
        for index in range(1, PASSES):
            with self.ctx.debug_scope(f"p{index}", group_id=index + 1):
                self.targets[index % 2].use()
                self.textures[(index - 1) % 2].use(0)
                self.chain.render(vertices=3)


def measure(device: Device, size: tuple[int, int]) -> tuple[list[float], list[float], list[float]]:
    """Milliseconds of each frame: planned, by hand with the same debug groups, and by hand without."""
    with TemporaryDirectory() as folder:
        document = load_document(graph(Path(folder), size))
        planned = plan_document(document, PlanOptions())
        runner = Runner(device, planned.plan, None, frame_cameras(planned))
        runner.prepare()
        by_hand = HandWritten(device.ctx, size)
        times: tuple[list[float], list[float], list[float]] = ([], [], [])
        frames = (lambda: runner.run_frame(0), by_hand.frame_with_groups, by_hand.frame)
        for index in range(FRAMES + 5):
            for samples, frame in zip(times, frames, strict=True):
                device.gl.glUseProgram(0)
                device.finish()
                start = time.perf_counter()
                frame()
                device.finish()
                if index >= 5:
                    samples.append(1000 * (time.perf_counter() - start))
        runner.release()
    return times


def main() -> None:
    """Measure and print."""
    device = open_device()
    print(f"{device.info.renderer}, {PASSES} passes, {FRAMES} frames each, in turn")
    for size in ((160, 90), (640, 360), (1280, 720)):
        planned, same, bare = (median(samples) for samples in measure(device, size))
        print(
            f"{size[0]:5}x{size[1]:<5} plan {planned:8.3f} ms  by hand {same:8.3f} ms: {planned / same:.3f}  "
            f"by hand without debug groups {bare:8.3f} ms: {planned / bare:.3f}"
        )


if __name__ == "__main__":
    main()
