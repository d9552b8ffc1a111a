"""How long `rg --help` takes beside the typer import it stands on, and what `rg validate` imports.

python benchmarks/startup.py
"""

from __future__ import annotations

import subprocess
import sys
import time
from statistics import median

ROUNDS = 15


def seconds(*arguments: str) -> float:
    """Wall time of a fresh Python."""
    start = time.perf_counter()
    subprocess.run([sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start


def main() -> None:
    """Run the two in turn and print medians and their ratio."""
    commands = {
        "import typer": ["-c", "import typer"],
        "rg --help": ["-c", "from rendergraph.cli import main; main(['--help'])"],
        "rg validate": ["-c", "from rendergraph.cli import main; main(['validate', 'deferred_shading'])"],
    }
    times: dict[str, list[float]] = {name: [] for name in commands}
    for _ in range(ROUNDS):
        for name, arguments in commands.items():
            times[name].append(seconds(*arguments))
    base = median(times["import typer"])
    for name, samples in times.items():
        print(f"{name:14} {1000 * median(samples):7.0f} ms  {median(samples) / base:5.2f} x import typer")


if __name__ == "__main__":
    main()
