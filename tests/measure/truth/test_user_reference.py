"""Python beside a user's shader tells its truth: what it may say, what it may get wrong, and when it is not run."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from rendergraph.device.context import Device
from rendergraph.document.load import Document, load_document
from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.truth.accuracy import PassAccuracy, judge_graph
from rendergraph.measure.truth.cache import TruthCache
from rendergraph.measure.truth.judge import judge_pass
from rendergraph.measure.truth.observe import observe
from rendergraph.node.discovery import find_node
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import plan_document
from rendergraph.run.render import RenderOptions, render_document

pytestmark = pytest.mark.gpu

SHADER = """\
#version 450
layout(location = 0) out vec4 color;
layout(location = 1) out uvec4 number;
uniform float u_shade;
void main() { color = vec4(u_shade, 0.25, 0.5, 1.0); number = uvec4(gl_FragCoord.x); }
"""

SOUND = """\
from pathlib import Path
import numpy as np
from rendergraph.node.reference import Truth
Path(__file__).with_name("was_run").touch()
def judge(run):
    h, w = run.outputs["color"].shape[:2]
    shade = run.params.uniforms["u_shade"]
    number = np.zeros((h, w, 4)) + np.arange(w)[None, :, None]
    return {"color": Truth(np.full((h, w, 4), [shade, 0.25, 0.5, 1.0])), "number": Truth(number)}
def invariants(run):
    if run.outputs["color"].min() <= 0.1:
        yield "too dark"
"""
TRUTH = "from rendergraph.node.reference import Truth\n"


def graph(folder: Path, reference: str | None, shade: float = 0.6, shader: str = "shaders/flat.frag") -> Document:
    (folder / "shaders").mkdir(exist_ok=True)
    (folder / "shaders" / "flat.frag").write_text(SHADER)
    if reference is not None:
        (folder / "shaders" / "flat_reference.py").write_text(reference)
    data = {
        "rendergraph": 1,
        "frame": {"size": [12, 8]},
        "resources": {"color": {"format": "rgba8"}, "number": {"format": "rgba8ui"}},
        "passes": {
            "flat": {
                "node": "fullscreen",
                "write": {"color": "color", "number": "number"},
                "set": {"shader": shader, "uniforms": {"u_shade": shade}},
            }
        },
        "outputs": {"color": {"file": "color.png"}},
    }
    (folder / "graph.yaml").write_text(yaml.safe_dump(data, sort_keys=False))
    return load_document(folder / "graph.yaml")


def judged(device: Device, document: Document, cache: TruthCache | None = None) -> PassAccuracy:
    (entry,) = judge_graph(document, plan_document(document, PlanOptions()), device, cache=cache)
    return entry


def verdicts(entry: PassAccuracy) -> dict[str, str]:
    return {j.measure: j.verdict for j in entry.judgements}


def refusal(device: Device, folder: Path, reference: str | None) -> str:
    """The code with which the pass is refused."""
    document = graph(folder, reference)
    run = observe(document, plan_document(document, PlanOptions()), device, ["flat"])["flat"]
    with pytest.raises(RenderGraphError) as raised:
        judge_pass("flat", find_node("fullscreen"), run)
    return raised.value.diagnostics[0].code


def test_within_by_what_the_formats_round(device: Device, tmp_path: Path) -> None:
    entry = judged(device, graph(tmp_path, SOUND))
    assert verdicts(entry) == {"color": "within", "number": "within"}
    assert entry.broken == ()
    by = {j.measure: j for j in entry.judgements}
    assert (by["number"].value, by["number"].tolerance) == (0.0, 0.0)
    assert 0.0 < (by["color"].value or 0.0) <= 1.0


@pytest.mark.parametrize(("right", "wrong", "above"), [
    ("0.25, 0.5, 1.0])", "0.25, 0.505, 1.0])", "color"), ("np.arange(w)[None", "1 + np.arange(w)[None", "number"),
])  # fmt: skip
def test_another_truth_is_above(device: Device, tmp_path: Path, right: str, wrong: str, above: str) -> None:
    assert verdicts(judged(device, graph(tmp_path, SOUND.replace(right, wrong))))[above] == "above"


def test_a_tolerance_of_its_own(device: Device, tmp_path: Path) -> None:
    loose = SOUND.replace("[shade, 0.25, 0.5, 1.0]))", "[shade, 0.25, 0.51, 1.0]), tolerance=0.02)")
    entry = judged(device, graph(tmp_path, loose))
    (color,) = (j for j in entry.judgements if j.measure == "color")
    assert (color.verdict, color.tolerance) == ("within", 0.02)
    assert color.value == pytest.approx(0.01, abs=2e-3)


def test_an_invariant_of_its_own(device: Device, tmp_path: Path) -> None:
    assert len(judged(device, graph(tmp_path, SOUND, shade=0.05)).broken) == 1


def test_an_output_not_spoken_of_is_not_judged(device: Device, tmp_path: Path) -> None:
    entry = judged(device, graph(tmp_path, SOUND.replace(', "number": Truth(number)', "")))
    assert verdicts(entry) == {"color": "within", "number": "cannot_judge"}


def test_without_the_file_the_pass_says_so(device: Device, tmp_path: Path) -> None:
    entry = judged(device, graph(tmp_path, None))
    assert entry.judgements == ()
    assert "flat_reference.py" in entry.reason
    assert refusal(device, tmp_path, None) == "RG728"


@pytest.mark.parametrize("reference", [
    "def judge(run:\n", "import no_such_module\n", "1 / 0\n", "judge = 3\n", "", "def judge(run):\n    return 3\n",
    "def judge(run):\n    return {'color': 3}\n", "def judge(run):\n    raise KeyError('x')\n",
    TRUTH + "def judge(run):\n    return {'colour': Truth(run.outputs['color'])}\n",
    TRUTH + "def judge(run):\n    return {'color': Truth(run.outputs['color'][1:])}\n",
    "def judge(run):\n    return [1, 2]\n",
])  # fmt: skip
def test_a_file_that_tells_nothing_is_refused(device: Device, tmp_path: Path, reference: str) -> None:
    assert refusal(device, tmp_path, reference) == "RG729"


def test_the_line_of_the_mistake_is_said(device: Device, tmp_path: Path) -> None:
    document = graph(tmp_path, "def judge(run):\n    x = 1\n    return 1 / 0\n")
    with pytest.raises(RenderGraphError) as raised:
        judged(device, document)
    assert "line 3" in str(raised.value)


def test_a_link_out_of_the_folder_is_refused(device: Device, tmp_path: Path) -> None:
    (tmp_path / "outside.py").write_text(SOUND)
    inside = tmp_path / "inside"
    (inside / "shaders").mkdir(parents=True)
    (inside / "shaders" / "flat_reference.py").symlink_to(tmp_path / "outside.py")
    assert refusal(device, inside, None) == "RG729"


def test_it_is_run_only_when_a_pass_is_judged(device: Device, tmp_path: Path) -> None:
    document = graph(tmp_path, SOUND)
    render_document(document, RenderOptions(samples=0))
    assert not (tmp_path / "shaders" / "was_run").exists()
    judged(device, document)
    assert (tmp_path / "shaders" / "was_run").exists()
    assert not list(tmp_path.rglob("__pycache__"))


def test_a_changed_file_is_not_answered_from_the_cache(device: Device, tmp_path: Path) -> None:
    cache = TruthCache(tmp_path / "cache")
    assert verdicts(judged(device, graph(tmp_path, SOUND), cache))["color"] == "within"
    assert verdicts(judged(device, graph(tmp_path, SOUND), cache))["color"] == "within"
    assert cache.hits == 1
    changed = SOUND.replace("0.25, 0.5, 1.0])", "0.25, 0.7, 1.0])")
    assert verdicts(judged(device, graph(tmp_path, changed), cache))["color"] == "above"
