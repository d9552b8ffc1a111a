"""The fireplace room with one sun and 16 point lights: this project against pyrender and pygfx, in turn, in one run.

    python -m benchmarks.peers [--assets DIR] [--blocks N] [--only plain|shadowed|default]

Installs the two peers apart, under build/peers, on the first run. The room is `fireplace_room/fireplace_room.glb` in
``--assets``, else in $RG_ASSETS, else in an asset folder beside the checkout; without it nothing is measured.
Pictures, times and logs are left in build/peers/results. See docs/peers.md for what is compared and how.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path
from statistics import median, quantiles

# Workers run as scripts of this folder, in environments without rendergraph; this process shares their modules.
sys.path.insert(0, str(Path(__file__).resolve().parent))

from contender import Contender
from environment import BUILD, HERE, REPOSITORY, environment, interpreter, lavapipe
from shot import PointLight, Shot

from rendergraph.document.scene_models import LightsModel, PointsModel, SceneModel
from rendergraph.scene.load import load_scene

RESULTS = BUILD / "results"
ROOM = Path("fireplace_room") / "fireplace_room.glb"
SIZE = (640, 360)
LIGHTS = PointsModel(count=16, seed=3, intensity=1.0)
WARM_UP = 3  # frames: shaders are compiled on the first, and variants of them on the next

#: Round, then each contender's worker and arguments; this project's first is what the ratios are of.
#: plain: one sample a pixel, no shadow, no sky, no filter, on any side. shadowed: the same with the sun's shadow from
#: one map. default: each as it comes, with the sun's shadow.
ROUNDS = {
    "plain": {
        "rendergraph": ["rendergraph_worker.py", str(HERE / "plain.yaml")],
        "rendergraph_forward": ["rendergraph_worker.py", str(HERE / "forward.yaml")],
        "pyrender": ["pyrender_worker.py", "samples=1"],
        "pygfx": ["pygfx_worker.py", "scale=1", "ppaa=none"],
    },
    "shadowed": {
        "rendergraph": ["rendergraph_worker.py", str(HERE / "shadowed.yaml")],
        "pyrender": ["pyrender_worker.py", "shadow", "samples=1"],
        "pygfx": ["pygfx_worker.py", "shadow", "scale=1", "ppaa=none"],
    },
    "default": {
        "rendergraph": ["rendergraph_worker.py", "deferred_shading"],
        "pyrender": ["pyrender_worker.py", "shadow"],
        "pygfx": ["pygfx_worker.py", "shadow"],
    },
}


def room_shot(file: Path) -> Shot:
    """The shot, with the point lights where this project's scene loader scatters them."""
    model = SceneModel(source=str(file), lights=LightsModel(points=LIGHTS))
    lights = load_scene(model, Path(), frame_seed=0).scene.lights
    return Shot(
        scene=str(file),
        size=SIZE,
        position=(4.8, 1.1, -1.3),
        target=(3.8, 1.0, -1.1),
        fov=1.3,
        sun_direction=(0.84685, -0.321803, 0.423425),
        sun_irradiance=(5.0, 4.8, 4.5),
        ambient=(0.15, 0.15, 0.15),
        points=tuple(PointLight(light.position, light.intensity, light.radius) for light in lights),
    )


def start(features: str) -> list[Contender]:
    """The contenders of one round, this project first."""
    contenders = []
    for name, arguments in ROUNDS[features].items():
        python = sys.executable if name.startswith("rendergraph") else interpreter(name)
        variables = environment(**lavapipe()) if name == "pygfx" else environment()
        log = RESULTS / f"{features}_{name}.log"
        contenders.append(Contender.start(name, features, python, arguments, variables, log))
    return contenders


def measure(contenders: list[Contender], shot: Shot, blocks: int) -> None:
    """Load all, warm up, save a picture of each; then one frame of each in turn, ``blocks`` times."""
    for contender in contenders:
        contender.load(shot)
        for _ in range(WARM_UP):
            contender.frame(keep=False)
        contender.save(RESULTS / f"{contender.features}_{contender.name}.png")
    for block in range(blocks):
        # Each starts a block as often as the others: the first finds the caches as the last of them left them.
        turn = block % len(contenders)
        for contender in contenders[turn:] + contenders[:turn]:
            contender.frame(keep=True)


def report(contenders: list[Contender]) -> None:
    """One row a contender; ratios are medians over the blocks' own ratios, with their quartiles."""
    ours = contenders[0]
    print(f"\n{ours.features}: median ms a frame (quartiles), read-back included unless said")
    print("| | wall | wall before read-back | CPU, all threads | this project / it, wall | ... CPU |")
    print("|---|---|---|---|---|---|")
    for contender in contenders:
        cells = [_spread(contender.samples[kind], 1e-6, 1) for kind in ("frame_ns", "draw_ns", "cpu_ns")]
        for kind in ("frame_ns", "cpu_ns"):
            pairs = zip(ours.samples[kind], contender.samples[kind], strict=True)
            cells.append("" if contender is ours else _spread([a / b for a, b in pairs], 1, 2))
        print(f"| {contender.name} {contender.about['version']} | " + " | ".join(cells) + " |")


def _spread(values: list[float] | list[int], unit: float, digits: int) -> str:
    low, _, high = quantiles(values, n=4)
    return f"{median(values) * unit:.{digits}f} ({low * unit:.{digits}f} .. {high * unit:.{digits}f})"


def main() -> None:
    """Read the command line, measure, print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--assets", type=Path, default=None, help="folder that holds fireplace_room/")
    parser.add_argument("--blocks", type=int, default=21, help="frames of each contender, at least 15 (default 21)")
    parser.add_argument("--only", choices=sorted(ROUNDS), help="one of the three rounds")
    arguments = parser.parse_args()
    if arguments.blocks < 15:
        parser.error("--blocks: fewer than 15 tell too little")
    assets = arguments.assets or Path(os.environ.get("RG_ASSETS", REPOSITORY.parent / "shared" / "assets"))
    file = (assets / ROOM).resolve()
    if not file.is_file():
        print(f"skipped: {ROOM} is not in {assets}; name its folder with --assets or RG_ASSETS", file=sys.stderr)
        return
    RESULTS.mkdir(parents=True, exist_ok=True)
    shot, record = room_shot(file), {}
    print(f"{SIZE[0]}x{SIZE[1]}, {arguments.blocks} blocks, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    for features in [arguments.only] if arguments.only else ROUNDS:
        contenders = start(features)
        try:
            measure(contenders, shot, arguments.blocks)
        finally:
            for contender in contenders:
                contender.close()
        report(contenders)
        record[features] = {c.name: {"about": c.about, "samples": c.samples} for c in contenders}
    print(f"\nload {os.getloadavg()[0]:.1f} at the end; pictures and times are in {RESULTS.relative_to(REPOSITORY)}")
    (RESULTS / "times.json").write_text(json.dumps({"shot": json.loads(shot.to_json()), "rounds": record}, indent=1))


if __name__ == "__main__":
    main()
