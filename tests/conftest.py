"""Fixtures shared by all tests: the process's one OpenGL device."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest

from rendergraph.document.messages import RenderGraphError

if TYPE_CHECKING:
    from rendergraph.device.context import Device


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options of this suite."""
    parser.addoption("--regenerate-goldens", action="store_true", help="write the golden images instead of comparing")


@pytest.fixture(autouse=True)
def _opengl_for_marked_tests(request: pytest.FixtureRequest) -> None:
    """Tests marked ``gpu`` are skipped with the device fixture's reason where there is no OpenGL."""
    if request.node.get_closest_marker("gpu"):
        request.getfixturevalue("session_device")


@pytest.fixture(scope="session")
def session_device() -> Iterator[Device]:
    """The device; tests are skipped where there is no OpenGL, unless ``RG_REQUIRE_GL`` demands it."""
    from rendergraph.device.context import open_device

    try:
        opened = open_device()
    except RenderGraphError as error:
        if os.environ.get("RG_REQUIRE_GL"):
            raise
        pytest.skip(f"no OpenGL 4.5: {error}")
    yield opened
    opened.close()


@pytest.fixture
def device(session_device: Device) -> Iterator[Device]:
    """The device; a test that leaves a driver error behind fails."""
    session_device.check()
    yield session_device
    session_device.check()


@dataclass(frozen=True)
class Hardware:
    """What OpenGL leaves open, and tests of exact results must allow for.

    ``rounding``: steps by which a number stored in n bits may miss. llvmpipe takes the nearest code; NVIDIA's render
    targets miss by up to 0.56. ``arithmetic``: relative difference of one formula in two programs. llvmpipe computes
    what is written; other compilers contract products and sums as they like, which moves the last bit or two.
    """

    rounding: float
    arithmetic: float


@pytest.fixture(scope="session")
def hardware(session_device: Device) -> Hardware:
    """What this process's renderer makes of it."""
    if "llvmpipe" in session_device.info.renderer:
        return Hardware(rounding=0.5, arithmetic=0.0)
    return Hardware(rounding=0.56, arithmetic=2.0**-22)
