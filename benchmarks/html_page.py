"""The page of a 100-pass graph: time to write it, its size, and how long a browser takes to open it.

    python benchmarks/html_page.py [--passes 100] [--keep report.html]

Every pass writes a noisy target of its own, which compresses badly, at 640x360. The browser is Chromium, headless; its
time is counted from the start of the navigation until everything is loaded, run and laid out, start-up left out.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from statistics import median

from rendergraph.document.load import load_document
from rendergraph.report.html import TargetGallery, html_page
from rendergraph.report.timing import timing_record
from rendergraph.run.render import RenderOptions, render_document

FORMATS = ("rgba16f", "rgba8", "r8", "r32f", "rg16f", "r11g11b10f")
SHADER = """#version 450
in vec2 v_uv;
out vec4 color;
uniform sampler2D u_a;
uniform sampler2D u_b;
uniform float u_seed;
void main() {
    float noise = fract(sin(dot(v_uv, vec2(12.9898, 78.233)) + u_seed) * 43758.5453);
    color = 0.5 * (texture(u_a, v_uv) + texture(u_b, v_uv)) + vec4(v_uv, noise, 1.0) * (0.2 + noise);
}
"""
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
)  # fmt: skip
PROBE = (
    "<script>addEventListener('load',()=>{document.body.getBoundingClientRect();"
    "document.title='opened '+performance.now().toFixed(1)})</script></body>"
)


def graph(passes: int) -> str:
    """A chain in which each pass reads the last target and one of some passes before."""
    lines = ["rendergraph: 1", "title: A long chain", "frame: {size: [640, 360]}", "resources:"]
    lines += [f"  t{i:03}: {{format: {FORMATS[i % len(FORMATS)]}}}" for i in range(passes - 1)]
    lines += ["passes:", "  p000: {node: clear, write: {target: t000}}"]
    for i in range(1, passes):
        target = f"t{i:03}" if i < passes - 1 else "image"
        lines.append(
            f"  p{i:03}: {{node: fullscreen, read: {{u_a: t{i - 1:03}, u_b: t{max(0, i - 7):03}}}, "
            f"write: {{color: {target}}}, set: {{shader: chain.frag, uniforms: {{u_seed: {i}.0}}}}}}"
        )
    return "\n".join([*lines, "outputs:", "  image: {file: image.png}", ""])


def opened(page: Path) -> float:
    """Milliseconds until the page is open."""
    with tempfile.TemporaryDirectory() as folder:
        found = subprocess.run(
            ["chromium", *FLAGS, f"--user-data-dir={folder}", "--dump-dom", page.as_uri()],
            capture_output=True, text=True, check=True,
        )  # fmt: skip
    match = re.search(r"<title>opened ([\d.]+)", found.stdout)
    if match is None:
        raise RuntimeError("the page did not report that it was opened")
    return float(match[1])


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--passes", type=int, default=100)
    parser.add_argument("--keep", type=Path, help="keep the page here")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "chain.frag").write_text(SHADER)
        (folder / "graph.yaml").write_text(graph(options.passes))
        gallery = TargetGallery()
        result = render_document(load_document(folder / "graph.yaml"), RenderOptions(inspect=gallery.add, samples=20))
        start = time.perf_counter()
        text = html_page(result.plan, title="A long chain", timing=timing_record(result), targets=gallery)
        print(f"{options.passes} passes, {len(gallery.views)} targets")
        print(f"written in {time.perf_counter() - start:.2f} s, {len(text.encode()) / 1e6:.2f} MB")
        if options.keep:
            options.keep.write_text(text, encoding="utf-8")
        if shutil.which("chromium") is None:
            print("no chromium to open it with")
            return
        page = folder / "page.html"
        page.write_text(text.replace("</body>", PROBE), encoding="utf-8")
        times = [opened(page) for _ in range(5)]
        print(f"opened in {median(times):.0f} ms (least {min(times):.0f}, most {max(times):.0f})")


if __name__ == "__main__":
    main()
