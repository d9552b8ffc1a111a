"""The page in a real browser: no errors, usable by keyboard, readable in light, dark and on a phone."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html import unescape
from pathlib import Path
from typing import Any

import pytest

from rendergraph.report.html import html_page
from rendergraph.report.timing import timing_record
from tests.report.made_up import made_up_gallery, made_up_plan, made_up_result

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--enable-logging=stderr",
    "--virtual-time-budget=20000", "--window-size=1400,1000", "--dump-dom",
)  # fmt: skip

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no chromium")

#: Functions for the scripts below; the last lines run one and leave what it returns in the top document.
PROBE = """<script>
const one = (s) => document.querySelector(s), all = (s) => [...document.querySelectorAll(s)];
const pause = () => new Promise((resume) => setTimeout(resume, 10));
const until = async (done) => { for (let i = 0; i < 500 && !done(); i += 1) await pause(); };
const key = (node, key, more) => node.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true, ...more}));
addEventListener("load", async () => {
  const found = await (async () => { %s })().catch((e) => ({error: String(e)}));
  parent.postMessage(JSON.stringify(found), "*");
});
</script>"""
ANSWER = """<script>
addEventListener("message", (event) => {
  const pre = document.createElement("pre");
  pre.id = "probe-result";
  pre.textContent = event.data;
  document.body.append(pre);
});
</script>"""


def page() -> str:
    plan = made_up_plan()
    timing = timing_record(made_up_result(plan), "A title")
    return html_page(plan, title="A title", timing=timing, targets=made_up_gallery(plan))


def browse(text: str, folder: Path, script: str, size: tuple[int, int] = (1280, 900)) -> tuple[Any, list[str]]:
    """What ``script`` returns in the opened page, and the console's complaints. No window is as narrow as a phone, so
    the page is in a frame of ``size``.
    """
    assert BROWSER is not None
    (folder / "page.html").write_text(text.replace("</body>", PROBE % script + "</body>"), encoding="utf-8")
    frame = f'<iframe src="page.html" width="{size[0]}" height="{size[1]}" style="border:0"></iframe>'
    file = folder / "outer.html"
    file.write_text(f"<!doctype html><body>{ANSWER}{frame}</body>", encoding="utf-8")
    run = subprocess.run(
        [BROWSER, *FLAGS, f"--user-data-dir={folder / 'profile'}", file.as_uri()],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    match = re.search(r'<pre id="probe-result">(.*?)</pre>', run.stdout, re.DOTALL)
    complaints = [line for line in run.stderr.splitlines() if "CONSOLE" in line]
    return (json.loads(unescape(match[1])) if match else None), complaints


def test_the_page_works(tmp_path: Path) -> None:
    script = """
      const names = () => all("#times-rows > li").map((row) => row.dataset.name);
      const found = {asRun: names()};
      one('[data-by="median"]').click();
      found.slowest = names();
      found.pressed = all("[data-sorts='times-rows'] button").map((b) => b.getAttribute("aria-pressed"));
      one('[data-by="order"]').click();
      found.again = names();
      one('[data-by="bytes"]').click();
      found.largest = one("#life-rows").firstElementChild.id;
      const filter = one("#decision-filter");
      filter.value = "shares_slot";
      filter.dispatchEvent(new Event("input"));
      found.filtered = all("#decision-list li").filter((row) => row.checkVisibility()).length;
      found.count = one("#decision-count").textContent;
      const before = one("#graph-view svg").clientWidth;
      one('[data-zoom="in"]').click();
      found.zoomed = one("#graph-view svg").clientWidth / before;

      const viewer = one("#viewer"), stage = one("#viewer-stage"), value = one("#viewer-value");
      one('[data-open="depth"]').click();
      await until(() => viewer.dataset.ready === "depth");
      found.focused = document.activeElement.id;
      key(stage, "ArrowLeft", {shiftKey: true});
      key(stage, "ArrowDown", {shiftKey: true});
      found.corner = value.textContent;
      key(stage, "ArrowRight");
      key(stage, "ArrowUp");
      found.inner = value.textContent;
      const wide = one("#viewer-canvas").clientWidth;
      key(stage, "+");
      found.scaled = one("#viewer-canvas").clientWidth / wide;
      const copy = document.createElement("canvas").getContext("2d", {willReadFrequently: true});
      const texel = () => {
        copy.drawImage(one("#viewer-canvas"), 0, 0);
        return [...copy.getImageData(3, 0, 1, 1).data];
      };
      found.white = texel();
      one("#viewer-high").value = 46;
      one("#viewer-high").dispatchEvent(new Event("input"));
      found.half = texel();
      all("#viewer [data-go]")[1].click();
      await until(() => viewer.dataset.ready !== "depth");
      found.next = one("#viewer-name").textContent;
      one("#viewer [data-close]").click();
      found.open = viewer.open;
      return found;
    """
    found, complaints = browse(page(), tmp_path, script)
    assert complaints == []
    assert "error" not in found, found
    plan = made_up_plan()
    as_run = list(dict.fromkeys(subpass.parent for subpass in plan.order))
    assert found["asRun"] == found["again"] == as_run
    assert found["slowest"][0] == "meter"  # 9 + 10 + 11 ms
    assert sorted(found["slowest"]) == sorted(as_run)
    assert found["pressed"] == ["false", "true", "false"]
    assert found["largest"] == "resource-shadow"
    shares = sum(d.reason == "shares_slot" for d in plan.decisions)
    assert shares > 0
    assert (found["filtered"], found["count"]) == (shares, f"{shares} found")
    assert found["zoomed"] == pytest.approx(1.25, rel=0.02)
    assert found["focused"] == "viewer-stage"
    # the ramp holds 10 y + x, of 4 x 3 texels; the frame's (0, 0) is the lower left
    assert found["corner"] == "texel (0, 0): R 0"
    assert found["inner"] == "texel (1, 1): R 11"
    assert found["scaled"] == pytest.approx(1.25, rel=0.05)
    assert found["white"] == [255, 255, 255, 255]
    assert found["half"][0] in (127, 128)
    assert found["next"] != "depth"
    assert found["open"] is False


LOOKS = """
  const rgb = (text) => {
    const c = document.createElement("canvas").getContext("2d", {willReadFrequently: true});
    c.fillStyle = text; c.fillRect(0, 0, 1, 1);
    return [...c.getImageData(0, 0, 1, 1).data];
  };
  const light = (c) => { const f = (v) => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
    return 0.2126 * f(c[0]) + 0.7152 * f(c[1]) + 0.0722 * f(c[2]); };
  const ground = (node) => { for (; node; node = node.parentElement) {
    const c = rgb(getComputedStyle(node).backgroundColor); if (c[3] > 200) return c; } return [255, 255, 255]; };
  const contrast = (node) => { const a = light(rgb(getComputedStyle(node).color)), b = light(ground(node));
    return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05); };
  const texts = all("body *").filter((n) => n.checkVisibility() && !n.closest("svg, .hatch, .skip, .hidden") &&
    [...n.childNodes].some((c) => c.nodeType === 3 && c.data.trim()));
  const poor = texts.filter((n) => contrast(n) < 4.5).map((n) => `${n.className} ${n.textContent.trim()}`.slice(0, 60));
  const focusable = all("button, a[href], input, summary, [tabindex]").filter((n) => n.checkVisibility());
  const outlines = focusable.filter((n) => !n.closest("svg")).map((n) => {
    n.focus({focusVisible: true});
    const style = getComputedStyle(n);
    return style.outlineStyle !== "none" && style.outlineWidth !== "0px";
  });
  return {
    ground: light(rgb(getComputedStyle(document.body).backgroundColor)), texts: texts.length, poor: [...new Set(poor)],
    nameless: all("button").filter((b) => !(b.textContent.trim() || b.ariaLabel)).length,
    unlabelled: all("input").filter((i) => !i.labels.length).length,
    alone: all("img").filter((i) => !i.alt).length,
    positive: all("[tabindex]").filter((n) => n.tabIndex > 0).length,
    outlined: outlines.every(Boolean), focusable: focusable.length,
    width: innerWidth, overflow: document.scrollingElement.scrollWidth - document.scrollingElement.clientWidth,
    small: all("button, summary").filter((b) => b.checkVisibility() && b.getBoundingClientRect().height < 23)
      .map((b) => b.textContent.trim()),
    broken: all("img").filter((i) => !i.naturalWidth).length,
  };
"""


@pytest.mark.parametrize(("theme", "size"), [("light", (1280, 900)), ("dark", (1280, 900)), ("dark", (390, 844))])
def test_it_is_readable_and_reachable(tmp_path: Path, theme: str, size: tuple[int, int]) -> None:
    text = page().replace('<html lang="en">', f'<html lang="en" data-theme="{theme}">')
    found, complaints = browse(text, tmp_path, LOOKS, size)
    assert complaints == []
    assert "error" not in found, found
    assert found["width"] == size[0]
    assert (found["ground"] > 0.8) == (theme == "light")
    assert found["texts"] > 100
    assert found["focusable"] > 30
    assert found["poor"] == []
    assert {k: found[k] for k in ("nameless", "unlabelled", "alone", "positive", "overflow", "broken")} == {
        "nameless": 0, "unlabelled": 0, "alone": 0, "positive": 0, "overflow": 0, "broken": 0,
    }  # fmt: skip
    assert found["outlined"]
    assert found["small"] == []


def test_the_checks_notice_a_page_that_is_wrong(tmp_path: Path) -> None:
    bad = page().replace("--quiet: light-dark(#566579", "--quiet: light-dark(#c5ccd6")
    bad = bad.replace('aria-label="Smaller"', "").replace('data-zoom="out" >−', 'data-zoom="out">')
    bad = bad.replace("<main ", '<p style="width:3000px">wide</p><main ', 1)
    bad = bad.replace('"use strict";', '"use strict"; fetch("https://example.org/"); setTimeout(() => undefined_name);')
    bad = bad.replace("outline: 3px", "outline: 0px").replace("<html ", '<html data-theme="light" ')
    found, complaints = browse(bad, tmp_path, LOOKS)
    assert any("Content Security Policy" in line for line in complaints), "the network is refused"
    assert any("undefined_name" in line for line in complaints)
    assert found["poor"]
    assert found["nameless"] == 1
    assert found["overflow"] > 0
    assert not found["outlined"]
