"""The sweep's page in a real browser: a setting is read out when it is pointed at or reached by keyboard."""

from __future__ import annotations

import shutil
import subprocess
from html import unescape
from pathlib import Path

import pytest

from rendergraph.report.sweep_page import sweep_page
from tests.report.made_up_sweep import made_up_sweep

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")

pytestmark = pytest.mark.skipif(BROWSER is None, reason="no chromium")

SCRIPT = """<script>
addEventListener("load", () => {
  const said = () => document.getElementById("readout").textContent;
  const points = [...document.querySelectorAll(".point")], found = [];
  points[0].focus(); found.push(said());
  points[1].dispatchEvent(new MouseEvent("mouseenter")); found.push(said());
  found.push(document.querySelectorAll("tr.lit").length);
  const wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  document.title = JSON.stringify({found, labels: points.map((p) => p.getAttribute("aria-label")), wide});
});
</script>"""


def test_settings_are_read_out(tmp_path: Path) -> None:
    import json

    page = tmp_path / "sweep.html"
    page.write_text(sweep_page(made_up_sweep()).replace("</body>", SCRIPT + "</body>"), encoding="utf-8")
    assert BROWSER is not None
    ran = subprocess.run(
        [BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=5000", "--dump-dom",
         "--enable-logging=stderr", f"--user-data-dir={tmp_path / 'profile'}", page.as_uri()],
        capture_output=True, text=True, timeout=120, check=True,
    )  # fmt: skip
    assert "Uncaught" not in ran.stderr
    title = unescape(ran.stdout.partition("<title>")[2].partition("</title>")[0])
    told = json.loads(title)
    assert told["found"][:2] == told["labels"][:2]
    assert told["found"][2] == 2, "the rows of both settings are marked"
    assert told["wide"] == 0, "nothing sticks out sideways"
