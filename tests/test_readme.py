"""What the README shows must work as shown."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from rendergraph.device.context import Device
from rendergraph.document.load import load_document
from rendergraph.run.render import RenderOptions, render_document

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text()


@pytest.mark.gpu
def test_first_graph_renders(device: Device, tmp_path: Path) -> None:
    (text,) = re.findall(r"```yaml\n(.*?)```", README, re.DOTALL)
    assert text.count("\n") <= 20, "its title says so"
    path = tmp_path / "spheres.yaml"
    path.write_text(text)
    result = render_document(load_document(path), RenderOptions(size=(96, 54), samples=0))
    image = result.images["image"]
    assert image.shape == (54, 96, 4)
    assert image[..., :3].std() > 10
    assert not result.warnings


def test_links_lead_somewhere() -> None:
    for page in (*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")):
        for link in re.findall(r"\]\((?!https?:)([^)#]+)\)", page.read_text()):
            assert (page.parent / link).exists(), f"{page.name}: {link}"
