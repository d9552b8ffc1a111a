"""Fixtures of the scene tests: a maker of tiny glTF files, and the optional asset folder."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from tiny_gltf import TinyGltf


@pytest.fixture
def tiny(tmp_path: Path) -> TinyGltf:
    return TinyGltf(tmp_path)


@pytest.fixture(scope="session")
def assets() -> Path:
    """The folder of real scenes: ``RG_ASSETS``, or an asset folder beside the checkout; skips without it."""
    default = Path(__file__).resolve().parents[3] / "shared" / "assets"
    folder = Path(os.environ.get("RG_ASSETS", default))
    if not folder.is_dir():
        pytest.skip(f"no asset folder at {folder}")
    return folder
