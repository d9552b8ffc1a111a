"""The peers' environments: one virtual environment each, apart from the project's, and Mesa's Vulkan driver."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parent.parent
BUILD = REPOSITORY / "build" / "peers"
ICD_FOLDERS = (Path("/usr/share/vulkan/icd.d"), Path("/etc/vulkan/icd.d"), Path("/usr/local/share/vulkan/icd.d"))
#: Installed without what they ask for; see pyrender.txt.
UNCHECKED = {"pyrender": "pyrender==0.1.45"}


def interpreter(peer: str) -> Path:
    """The Python of a peer's environment, made and filled when its requirements are new."""
    folder, wanted = BUILD / peer, HERE / f"{peer}.txt"
    python, installed = folder / "bin" / "python", folder / wanted.name
    if not installed.exists() or installed.read_text() != wanted.read_text():
        print(f"installing {peer} into {folder.relative_to(REPOSITORY)} ...", file=sys.stderr)
        shutil.rmtree(folder, ignore_errors=True)
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        pip = [python, "-m", "pip", "install", "--quiet", "--quiet", "--disable-pip-version-check"]
        subprocess.run([*pip, "-r", wanted], check=True)
        if peer in UNCHECKED:
            subprocess.run([*pip, "--no-deps", UNCHECKED[peer]], check=True)
        shutil.copyfile(wanted, installed)
    return python


def lavapipe() -> dict[str, str]:
    """The variables that leave lavapipe as the only Vulkan driver; the process ends where it is not installed."""
    files = [file for folder in ICD_FOLDERS for file in sorted(folder.glob("lvp_icd*.json"))]
    if not files:
        raise SystemExit(
            "pygfx needs Mesa's Vulkan driver (lavapipe), which is not installed; type\n"
            "  sudo apt-get install -y --no-install-recommends mesa-vulkan-drivers libvulkan1"
        )
    # The older name is the one that the loaders of Debian 12 and Ubuntu 22.04 read.
    return {"VK_DRIVER_FILES": str(files[0]), "VK_ICD_FILENAMES": str(files[0])}


def environment(**extra: str) -> dict[str, str]:
    """This process's variables, with ``extra``."""
    return {**os.environ, **extra}
