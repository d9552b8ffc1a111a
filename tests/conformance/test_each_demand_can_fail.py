"""A bad node for each thing demanded: the suite finds it, and gives the right reason."""

from __future__ import annotations

import pytest

from rendergraph.conformance.conform import hold
from rendergraph.conformance.demand import Verdict
from rendergraph.conformance.demands import DEMANDS
from rendergraph.conformance.subject import Subject
from tests.conformance.tidy_node import FILES, GRAPH, NODE, changed
from tests.measure.truth.conftest import Install

pytestmark = pytest.mark.gpu

QUANTISE_BODY = "void main() {"
NAN_ALONE = " if (textureSize(u_color, 0).x == 1) { color = vec4(0.0 / (u_levels - u_levels)); return; }"
FIVE_FAR_OUT = " if (gl_FragCoord.x > 4000) { color = vec4(5.0); return; }"
THREE_IF_ODD = " if (textureSize(u_color, 0).x % 2 == 1) { color = vec4(3.0); return; }"
REFUSES = "        if self.params.levels > 4000:\n            raise misuse(b, 'too many', 'fewer')\n"
COUNTS = NODE.replace("class TidyParams", "COUNT = []\n\n\nclass TidyParams").replace(
    "self.params.gain}", "self.params.gain + 1e-9 * len(COUNT)}"
)
LEVELS = 'knob(64, "Steps that a value is stored in.", ge=2, le=4096, accurate="up")'
BUILD = '        """Two draws: the product, then its steps."""\n'
STEP = "  step: {node: tidy, read: {color: ramp}, write: {color: image}}\n"
EXTREMES = '    extremes = (Extreme("black", "No gain.", ("passes.step.set.gain=0",)),)\n'

#: The demand, the reason, and what is wrong with the node.
BAD = {
    "a graph that does not validate": (
        "graph",
        "does_not_validate",
        changed(graph=("read: {color:", "read: {colour:")),
    ),
    "a graph in which it does not run": (
        "graph",
        "not_used",
        dict(FILES)
        | {"example.yaml": GRAPH.replace(STEP, "").replace("image: {file: image.npy}", "ramp: {file: r.npy}")},
    ),
    "an exemption of nothing": (
        "graph",
        "unknown_exemption",
        changed(node=(EXTREMES, EXTREMES + '    exempt = {"beauty": "it is plain"}\n')),
    ),
    "a page without what": ("readme", "no_what", changed(readme=("Multiplies an image and keeps it in steps.\n", ""))),
    "a page without when": ("readme", "no_when", changed(readme=("**Pick it** to", "To"))),
    "a page without when not": ("readme", "no_when_not", changed(readme=("**Not** for", "Nor for"))),
    "a page without cost": ("readme", "no_cost", changed(readme=("**Cost.**", "Well."))),
    "a page without accuracy": ("readme", "no_accuracy", changed(readme=("**Accuracy.**", "Well."))),
    "a page without figures": (
        "readme",
        "no_figure",
        changed(readme=("Half a step, which is 0.0078 for 64 of them.", "Very good indeed.")),
    ),
    "a page without source": ("readme", "no_source", changed(readme=("**Source.** Arithmetic, as", "As"))),
    "a parameter without help": (
        "parameters",
        "undocumented",
        changed(node=('"Steps that a value is stored in."', '""')),
    ),
    "a parameter without unit": ("parameters", "no_unit", changed(node=(LEVELS, "64"))),
    "a parameter without range": ("parameters", "no_range", changed(node=("ge=0.0, le=4.0, ", ""))),
    "a quality knob without an end": ("parameters", "no_range", changed(node=("ge=2, le=4096", "ge=2"))),
    "a number that says nothing of accuracy": (
        "parameters",
        "accuracy_untold",
        changed(node=(', accurate="neither"', "")),
    ),
    "no reference": (
        "reference",
        "no_reference",
        changed(node=("    reference = Reference(", "    truth = Reference(")),
    ),
    "a tolerance without end": ("reference", "no_stated_error", changed(node=("0.008", 'float("inf")'))),
    "a reference that is off": (
        "reference",
        "off",
        changed(reference=("run.params.gain *", "0.1 + run.params.gain *")),
    ),
    "a shader that is off": ("reference", "off", changed(multiply=("u_gain *", "0.9 * u_gain *"))),
    "an exact node that is not": (
        "reference",
        "off",
        changed(node=("    reference = Reference(", "    exact = True\n    truth = Reference(")),
    ),
    "a reference that fails": ("reference", "error", changed(reference=("run.params.gain", "run.params.loss"))),
    "a reference that knows nothing": (
        "reference",
        "not_judged",
        changed(reference=("0, 1))}", "0, 1), mask=np.zeros((36, 64), bool))}")),
    ),
    "a reference less sure than its tolerance": (
        "reference",
        "cannot_judge",
        changed(reference=("0, 1))}", "0, 1), standard_error=0.5)}")),
    ),
    "an invariant that does not hold": ("reference", "invariant_broken", changed(node=("(0.0, 4.0)}", "(0.0, 0.5)}"))),
    "a knob whose error rises": ("knobs", "rises", changed(node=('accurate="up"', 'accurate="down"'))),
    "a knob that changes nothing": ("knobs", "flat", changed(node=("float(self.params.levels)", "64.0"))),
    "a knob whose middle is worst": (
        "knobs",
        "bumpy",
        changed(node=("float(self.params.levels)", "{2: 4.0, 64: 2.0}.get(self.params.levels, 64.0)")),
    ),
    "no knob": ("knobs", "no_knob", changed(node=('accurate="up"', 'accurate="neither"'))),
    "a knob whose value is refused": (
        "knobs",
        "refused",
        changed(
            node=(BUILD, BUILD + REFUSES),
        ),
    ),
    "an axis whose error rises": (
        "knobs",
        "rises",
        changed(multiply=("u_gain * ", "u_gain * 0.9 * "))
        | {
            "__init__.py": NODE.replace(
                EXTREMES, EXTREMES + '    accuracy_axes = {"passes.step.set.gain=0.01|1|4": "color"}\n'
            )
        },
    ),
    "no extremes": ("extremes", "none_declared", changed(node=(EXTREMES, ""))),
    "no bounds": ("extremes", "unbounded", changed(node=('    bounds = {"color": (0.0, 4.0)}\n', ""))),
    "NaN in a frame of one texel": (
        "extremes",
        "not_finite",
        changed(quantise=(QUANTISE_BODY, QUANTISE_BODY + NAN_ALONE)),
    ),
    "bounds left in a wide frame": (
        "extremes",
        "not_bounded",
        changed(quantise=(QUANTISE_BODY, QUANTISE_BODY + FIVE_FAR_OUT)),
    ),
    "wrong in an odd frame": ("extremes", "not_error", changed(quantise=(QUANTISE_BODY, QUANTISE_BODY + THREE_IF_ODD))),
    "a refusal that does not come": (
        "extremes",
        "not_refused",
        changed(node=('("passes.step.set.gain=0",)', '("passes.step.set.gain=0",), refused="RG225"')),
    ),
    "an extreme that does not load": (
        "extremes",
        "failed",
        changed(node=("passes.step.set.gain=0", "passes.step.set.gain=-1")),
    ),
    "a build with a memory": (
        "plan",
        "not_deterministic",
        dict(FILES) | {"__init__.py": COUNTS.replace(BUILD, BUILD + "        COUNT.append(0)\n")},
    ),
    "texels it leaves unwritten": (
        "poison",
        "depends_on_poison",
        changed(multiply=("void main() {", "void main() { if (int(gl_FragCoord.x) == 7) discard;")),
    ),
    "leftovers of its neighbours": (
        "sharing",
        "depends_on_sharing",
        changed(multiply=("void main() {", "void main() { if (int(gl_FragCoord.x) == 7) discard;")),
    ),
    "a feature that changes the image": (
        "specialisation",
        "depends_on_specialisation",
        changed(node=('"u_gain": self.params.gain', '"u_gain": 0.5 if b.requires("masked") else 1.0')),
    ),
    "an exemption without a reason": (
        "readme",
        "exempt_without_reason",
        changed(node=(EXTREMES, EXTREMES + '    exempt = {"readme": ""}\n')),
    ),
    "a package that does not import": (
        "plan",
        "not_imported",
        changed(node=("class TidyParams", "1 / 0\n\n\nclass TidyParams")),
    ),
}


def tried(install: Install, files: dict[str, str], demand: str) -> Verdict:
    if "misuse(" in files["__init__.py"]:
        files["__init__.py"] += "\n\nfrom rendergraph.node.user_shader import misuse  # noqa\n"
    install("tidy", files)
    return hold(Subject("tidy"), DEMANDS[demand])


@pytest.mark.parametrize("what", BAD)
def test_a_bad_node_misses_the_demand(install: Install, what: str) -> None:
    demand, reason, files = BAD[what]
    verdict = tried(install, dict(files), demand)
    assert verdict.status == "missed", (verdict.notes, verdict.reason)
    assert reason in {one.reason for one in verdict.shortfalls}, verdict.shortfalls
    assert verdict.code == DEMANDS[demand].code


@pytest.mark.parametrize("demand", DEMANDS)
def test_the_good_node_meets_it(install: Install, demand: str) -> None:
    verdict = tried(install, dict(FILES), demand)
    assert verdict.status == "met", (verdict.shortfalls, verdict.reason)


def test_every_demand_has_a_bad_node() -> None:
    assert {demand for demand, _, _ in BAD.values()} == set(DEMANDS)


@pytest.mark.parametrize(("file", "demand", "reason"), [
    ("README.md", "readme", "no_readme"),
    ("reference.py", "reference", "no_judge"),
    ("example.yaml", "graph", "no_graph"),
])  # fmt: skip
def test_a_file_that_is_missing(install: Install, file: str, demand: str, reason: str) -> None:
    verdict = tried(install, {name: text for name, text in FILES.items() if name != file}, demand)
    assert [one.reason for one in verdict.shortfalls] == [reason]


def test_without_a_graph_the_others_are_not_tried(install: Install) -> None:
    files = {name: text for name, text in FILES.items() if name != "example.yaml"}
    install("tidy", files)
    subject = Subject("tidy")
    states = {name: hold(subject, demand).status for name, demand in DEMANDS.items()}
    assert states.pop("graph") == "missed"
    assert (states.pop("readme"), states.pop("parameters")) == ("met", "met")
    assert set(states.values()) == {"not_tried"}


def test_an_exemption_with_its_reason_is_shown(install: Install) -> None:
    files = changed(node=(EXTREMES, EXTREMES + '    exempt = {"knobs": "its steps are its purpose"}\n'))
    verdict = tried(install, files, "knobs")
    assert (verdict.status, verdict.reason) == ("exempt", "its steps are its purpose")


@pytest.mark.parametrize(
    ("broken", "reason"), [("verify", "not_sound"), ("totals", "below_load"), ("order", "depends_on_file_order")]
)
def test_a_planner_that_is_wrong(install: Install, monkeypatch: pytest.MonkeyPatch, broken: str, reason: str) -> None:
    from dataclasses import replace

    from rendergraph.conformance import plan_invariants

    install("tidy", dict(FILES))
    subject = Subject("tidy")
    if broken == "verify":
        monkeypatch.setattr(plan_invariants, "verify", lambda plan: ("order: a fault",))
    elif broken == "order":  # nodes are built by name: only the planner could let the file's order through
        other = subject.with_overrides("passes.step.set.gain=2")
        monkeypatch.setattr(plan_invariants, "shuffled", lambda document, seed: other)
    else:
        usual = subject.planned

        def below(*given: object, **named: object) -> object:
            planned = usual(*given, **named)  # type: ignore[arg-type]
            totals = replace(planned.plan.totals, load=planned.plan.totals.used + 1)
            return replace(planned, plan=replace(planned.plan, totals=totals))

        monkeypatch.setattr(subject, "planned", below)
    assert reason in {one.reason for one in hold(subject, DEMANDS["plan"]).shortfalls}
