"""Is everything here that a run needs? Each check is a fact, and where it fails, the exact line that mends it.

Imports numpy, moderngl and the device lazily: the point is to say so when they are missing.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib import metadata
from types import ModuleType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from rendergraph.device.context import Device

OLDEST_PYTHON: Final = (3, 11)
PACKAGES: Final = ("moderngl", "glcontext", "numpy", "pydantic", "typer", "yaml", "PIL", "rich", "jinja2")
#: Module and extra -> what it adds.
EXTRAS: Final = {
    ("OpenEXR", "exr"): "EXR images",
    ("flip_evaluator", "flip"): "the metric FLIP",
    ("embreex", "reference"): "references that trace rays",
    ("platformdirs", "reference"): "references kept on disk",
}
#: What the shipped nodes count on: the guaranteed minimums of OpenGL 4.5 (tables 23.53 to 23.74), said because some
#: drivers fall short of them.
NEEDED_LIMITS: Final = {
    "max_texture_size": 16384,
    "max_3d_texture_size": 2048,
    "max_array_texture_layers": 2048,
    "max_samples": 4,
    "max_color_attachments": 8,
    "max_image_units": 8,
    "max_shader_storage_buffer_bindings": 8,
    "max_shader_storage_block_size": 2**27,
    "max_compute_shared_memory_size": 32768,
    "max_compute_work_group_invocations": 1024,
}


@dataclass(frozen=True, slots=True)
class CheckResult:
    """One fact: ``ok`` is false only when it keeps graphs from running; ``fix`` is the line to type, or empty."""

    name: str
    ok: bool
    detail: str
    fix: str = ""


def diagnose_environment() -> list[CheckResult]:
    """Python, packages, the EGL library, each device with its limits and clock, and the extras. Never raises."""
    checks = [_python(), *(_package(name) for name in PACKAGES)]
    if all(check.ok for check in checks):
        checks += _guarded("devices", _devices)
    if all(check.ok for check in checks):
        checks += _guarded("cache of truths", _cache)
    return checks + [_extra(module, extra, adds) for (module, extra), adds in EXTRAS.items()]


def _guarded(name: str, checks: Callable[[], Iterator[CheckResult]]) -> list[CheckResult]:
    """All results of a check, the last one saying why it broke off, if it did."""
    found: list[CheckResult] = []
    try:
        found.extend(checks())
    except Exception as error:  # a doctor that crashes on a sick machine is of no use
        found.append(CheckResult(name, False, f"{type(error).__name__}: {error}"))
    return found


def _python() -> CheckResult:
    ok = sys.version_info >= OLDEST_PYTHON
    wanted = ".".join(map(str, OLDEST_PYTHON))
    fix = "" if ok else f"install Python {wanted} or newer, e.g.: uv python install {wanted}"
    return CheckResult("python", ok, sys.version.split()[0], fix)


def _package(name: str) -> CheckResult:
    try:
        module = importlib.import_module(name)
    except Exception as error:  # a broken binary package raises whatever it likes
        return CheckResult(f"package {name}", False, str(error), "pip install --force-reinstall rendergraph")
    return CheckResult(f"package {name}", True, _version(module))


def _version(module: ModuleType) -> str:
    if hasattr(module, "__version__"):
        return str(module.__version__)
    try:
        return metadata.version(module.__name__)
    except metadata.PackageNotFoundError:
        return "present"


def _extra(module: str, extra: str, adds: str) -> CheckResult:
    present = importlib.util.find_spec(module) is not None
    if present:
        return CheckResult(f"extra {extra}", True, f"{module} is installed: {adds}")
    return CheckResult(
        f"extra {extra}", True, f"not installed (optional: {adds})", f"pip install 'rendergraph[{extra}]'"
    )


def _cache() -> Iterator[CheckResult]:
    from rendergraph.measure.truth.cache_folder import LIMIT, VARIABLE, cache_folder, folder_bytes

    folder = cache_folder()
    if folder is None:
        fix = f"pip install 'rendergraph[reference]', or set {VARIABLE}"
        yield CheckResult("cache of truths", True, "none: references are computed each time", fix)
    else:
        held = f"{folder_bytes(folder) / 2**20:.1f} of at most {LIMIT / 2**20:.0f} MiB"
        yield CheckResult("cache of truths", True, f"{folder}, {held}")


def _devices() -> Iterator[CheckResult]:
    from rendergraph.device.context import enumerate_devices
    from rendergraph.document.messages import RenderGraphError

    broken: list[CheckResult] = []
    usable = 0
    for index, found in enumerate_devices():
        if isinstance(found, RenderGraphError):
            first = found.diagnostics[0]
            broken.append(CheckResult(f"device {index}", False, f"{first.code} {first.text}", first.help))
            continue
        results = list(_device(index, found))
        if all(result.ok for result in results):
            usable += 1
            yield from results
        else:
            broken += results
    if usable:  # one good device is enough; the others are told, not complained of
        broken = [replace(result, ok=True, detail=f"not usable: {result.detail}") for result in broken]
    yield from broken
    if not usable and not broken:
        yield CheckResult("devices", False, "EGL lists no device")


def _device(index: int, device: Device) -> Iterator[CheckResult]:
    from rendergraph.device.clock import choose_clock

    info = device.info
    kind = "software" if info.is_software else "hardware"
    facts = f"{info.renderer}, {info.vendor}, OpenGL {info.driver}, GLSL {info.glsl}, {kind} rendering"
    yield CheckResult(f"device {index}", True, facts)
    short = [
        f"{name} {info.limits[name]} < {least}" for name, least in NEEDED_LIMITS.items() if info.limits[name] < least
    ]
    yield CheckResult(f"device {index} limits", not short, "; ".join(short) or f"{len(NEEDED_LIMITS)} as needed")
    yield CheckResult(f"device {index} extensions", True, f"{len(info.extensions)}, the required ones among them")
    clock = choose_clock(device)
    proof = clock.proof
    yield CheckResult(
        f"device {index} clock",
        True,
        f"{clock.name} ({proof.reason}: draw {proof.raster_wall_ns / 1e6:.2f} ms by the wall, "
        f"{proof.raster_timestamp_ns / 1e6:.2f} by timestamps; dispatch {proof.compute_wall_ns / 1e6:.2f}, "
        f"{proof.compute_timestamp_ns / 1e6:.2f})",
    )
    errors = "synchronous messages" if device.debug.synchronous else "polled: errors name the pass, not the call"
    yield CheckResult(f"device {index} errors", True, errors)
