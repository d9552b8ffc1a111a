"""rendergraph's worker: `rendergraph_worker.py GRAPH [OVERRIDE ...]`."""

from __future__ import annotations

import json
import math
from importlib.metadata import version
from typing import Any

import numpy as np
import numpy.typing as npt
from serve import serve
from shot import Shot

from rendergraph.device.context import open_device
from rendergraph.document.load import load_document
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import plan_document
from rendergraph.run.render import frame_cameras
from rendergraph.run.runner import Runner


def scene_overrides(shot: Shot) -> list[str]:
    """The shot as ``--set`` arguments."""
    camera = {"position": shot.position, "target": shot.target, "fov": math.degrees(shot.fov)}
    illuminance = max(shot.sun_irradiance)
    lights = {
        "sun": {
            "direction": shot.sun_direction,
            "illuminance": illuminance,
            "color": [c / illuminance for c in shot.sun_irradiance],
        },
        "ambient": {"sky": shot.ambient, "ground": shot.ambient},
        "list": [{"position": p.position, "color": p.intensity, "radius": p.radius} for p in shot.points],
    }
    values = {"source": shot.scene, "camera": camera, "lights": lights}
    return [f"scene.{key}={json.dumps(value)}" for key, value in values.items()]


class Rendergraph:
    """A planned graph on the software or hardware device."""

    def __init__(self, shot: Shot, arguments: list[str]) -> None:
        graph, *overrides = arguments
        document = load_document(graph, [*scene_overrides(shot), *overrides])
        planned = plan_document(document, PlanOptions(), size=shot.size)
        assert planned.scene is not None
        self.device = open_device()
        self.runner = Runner(self.device, planned.plan, planned.scene.scene, frame_cameras(planned))
        self.runner.prepare()
        self.output = planned.plan.graph.outputs[0]
        self.about: dict[str, Any] = {
            "version": version("rendergraph"),
            "device": f"{self.device.info.renderer}, {self.device.info.driver}",
            "passes": [subpass.name for subpass in planned.plan.order],
        }

    def draw(self) -> None:
        """See :class:`serve.Renderer`."""
        self.runner.run_frame(0)
        self.device.finish()

    def read(self) -> npt.NDArray[np.uint8]:
        """See :class:`serve.Renderer`."""
        return np.asarray(self.runner.read(self.output, 0), np.uint8)


if __name__ == "__main__":
    serve(Rendergraph, bottom_up=True)
