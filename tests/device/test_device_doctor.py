"""The doctor's facts, on a sound machine and on sick ones."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator

import pytest

from rendergraph.device import doctor
from rendergraph.device.context import APT_LINE, Device
from rendergraph.device.doctor import CheckResult, diagnose_environment
from rendergraph.document.messages import RenderGraphError, diagnose

PRINT = """
import json
from dataclasses import asdict
from rendergraph.device.doctor import diagnose_environment
print(json.dumps([asdict(check) for check in diagnose_environment()]))
"""


def test_a_sound_machine(device: Device) -> None:
    checks = {check.name: check for check in diagnose_environment()}
    assert all(check.ok for check in checks.values()), checks
    index = device.info.index
    assert device.info.renderer in checks[f"device {index}"].detail
    assert ("software" in checks[f"device {index}"].detail) == device.info.is_software
    assert {f"device {index} limits", f"device {index} clock", f"device {index} extensions", "python"} <= checks.keys()
    device.check()


def test_every_package_has_a_version(device: Device) -> None:
    details = [check.detail for check in diagnose_environment() if check.name.startswith("package ")]
    assert len(details) == len(doctor.PACKAGES)
    assert all(any(letter.isdigit() for letter in detail) for detail in details), details


def test_no_egl(tmp_path) -> None:
    environment = os.environ | {"GLCONTEXT_LINUX_LIBEGL": str(tmp_path / "libEGL.so.1")}
    done = subprocess.run([sys.executable, "-c", PRINT], env=environment, capture_output=True, text=True, check=True)
    checks = {check["name"]: check for check in json.loads(done.stdout)}
    assert not checks["device 0"]["ok"]
    assert checks["device 0"]["detail"].startswith("RG501")
    assert APT_LINE in checks["device 0"]["fix"]
    assert checks["python"]["ok"]


def test_a_missing_package(monkeypatch: pytest.MonkeyPatch) -> None:
    real = doctor.importlib.import_module

    def without_moderngl(name: str):
        if name == "moderngl":
            raise ModuleNotFoundError(name)
        return real(name)

    monkeypatch.setattr(doctor.importlib, "import_module", without_moderngl)
    checks = {check.name: check for check in diagnose_environment()}
    assert not checks["package moderngl"].ok
    assert checks["package moderngl"].fix
    assert not any(name.startswith("device") for name in checks), "without moderngl no device is asked"


def enumerate_as(monkeypatch: pytest.MonkeyPatch, *found: object) -> None:
    monkeypatch.setattr("rendergraph.device.context.enumerate_devices", lambda: iter(enumerate(found)))


def test_one_good_device_is_enough(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    error = RenderGraphError([diagnose("RG503", index=1, detail="x")], 3)
    enumerate_as(monkeypatch, error, device)
    checks = {check.name: check for check in diagnose_environment()}
    assert checks["device 0"].ok
    assert "RG503" in checks["device 0"].detail
    assert all(check.ok for check in checks.values())
    enumerate_as(monkeypatch, error)
    assert not {check.name: check for check in diagnose_environment()}["device 0"].ok
    enumerate_as(monkeypatch)
    assert not {check.name: check for check in diagnose_environment()}["devices"].ok


def test_limits_that_fall_short(device: Device, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(doctor.NEEDED_LIMITS, "max_samples", 1000)
    checks = {check.name: check for check in diagnose_environment()}
    short = checks[f"device {device.info.index} limits"]
    assert not short.ok
    assert "max_samples" in short.detail


def test_it_never_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> Iterator[CheckResult]:
        yield CheckResult("device 0", True, "fine")
        raise OSError("the driver fell over")

    monkeypatch.setattr("rendergraph.device.context.enumerate_devices", broken)
    checks = diagnose_environment()
    assert any(not check.ok for check in checks)


def test_importing_the_doctor_imports_no_gl() -> None:
    script = "import sys; import rendergraph.device.doctor; print('numpy' in sys.modules, 'moderngl' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]
