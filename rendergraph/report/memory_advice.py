"""What would lower a plan's transient memory: single changes, each tried by planning the document again.

A change that a node refuses (a format its port does not take, targets of unequal size) is no advice, and neither is one
that saves nothing because another resource pins the peak.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

from rendergraph.document.load import Document
from rendergraph.document.messages import RenderGraphError
from rendergraph.document.models import ResourceModel
from rendergraph.plan.compile import compile_plan
from rendergraph.plan.expand import expand
from rendergraph.plan.graph import TextureDesc
from rendergraph.plan.peak import find_peak
from rendergraph.plan.plan import Plan, PlanOptions

#: Resources of the peak whose change is tried, largest first.
TRIED: Final = 4
#: Longer plans get no advice: each try plans all of it again.
LONGEST: Final = 300

#: The next narrower format of the same meaning, and what is lost. Integers are left out: they may count or index.
_NARROWER: Final[dict[str, tuple[str, str]]] = {
    "rgba32f": ("rgba16f", "24 bits of mantissa become 11, values above 65504 become infinite"),
    "rgba16f": ("r11g11b10f", "no alpha, no negative values, 6 bits of mantissa"),
    "rg32f": ("rg16f", "24 bits of mantissa become 11, values above 65504 become infinite"),
    "r32f": ("r16f", "24 bits of mantissa become 11, values above 65504 become infinite"),
    "rgba16": ("rgb10_a2", "16 bits a channel become 10, alpha has 2"),
    "rgba16_snorm": ("rgba8_snorm", "16 bits a channel become 8"),
    "rg16": ("rg8", "16 bits a channel become 8"),
    "rg16_snorm": ("rg8_snorm", "16 bits a channel become 8"),
    "r16": ("r8", "16 bits become 8"),
    "d32fs8": ("d24s8", "float depth becomes 24-bit fixed point"),
    "d32f": ("d16", "float depth becomes 16-bit fixed point"),
    "d24": ("d16", "24 bits of depth become 16"),
}


@dataclass(frozen=True, slots=True)
class Advice:
    """One change: ``change`` is ``format``, ``scale``, ``fixed``, ``samples``, ``order`` or ``alias``; ``resource`` is
    ``None`` for the last two. ``used`` and ``load`` are the plan's bytes after it, ``saves`` the bytes of ``used`` it
    saves. ``loses`` says what it costs, ``option`` is what to add to the command line to try it.
    """

    change: str
    resource: str | None
    before: str
    after: str
    used: int
    load: int
    saves: int
    loses: str
    option: str

    def sentence(self) -> str:
        """One line for people."""
        subject = f"{self.change} of '{self.resource}'" if self.resource else self.change
        saved = f"{self.saves / 2**20:.2f} MiB" if self.saves >= 2**17 else f"{self.saves} bytes"
        return f"{subject} {self.before} -> {self.after} saves {saved} ({self.loses}): {self.option}"


def advise(document: Document, plan: Plan, *, full: bool = False) -> tuple[Advice, ...]:
    """What would make ``plan`` of ``document`` use less transient memory, what saves most first.

    ``full`` as the plan was made with. Empty for plans of more than ``LONGEST`` sub-passes.
    """
    peak = find_peak(plan)
    if peak is None or len(plan.order) > LONGEST:
        return ()
    found = [*_plan_options(plan)]
    declared = [name for name, _ in peak.holders if name in document.model.resources]
    for name in declared[:TRIED]:
        desc = plan.graph.resources[name].desc
        if isinstance(desc, TextureDesc):
            found += _changes_of(document, plan, name, desc, full)
    return tuple(sorted(found, key=lambda a: (-a.saves, a.load, a.change, a.resource or "", a.after)))


def _plan_options(plan: Plan) -> Iterator[Advice]:
    options = plan.options
    if options.order != "memory":
        other = _planned(plan, replace(options, order="memory"))
        yield from _saving(plan, other, "order", None, options.order, "memory", "nothing", "--order memory")
    if not options.alias:
        other = _planned(plan, replace(options, alias=True))
        yield from _saving(plan, other, "alias", None, "off", "on", "nothing", "drop --no-alias")


def _planned(plan: Plan, options: PlanOptions) -> Plan | None:
    try:
        return compile_plan(plan.graph, options)[0]
    except RenderGraphError:  # the author's barriers may be for one order
        return None


def _changes_of(document: Document, plan: Plan, name: str, desc: TextureDesc, full: bool) -> Iterator[Advice]:
    model = document.model.resources[name]
    for key, before, after, shown, loses in _candidates(model, desc):
        changed = model.model_copy(update={key: after})
        resources = {**document.model.resources, name: changed}
        whole = document.model.model_copy(update={"resources": resources})
        other = _replanned(replace(document, model=whole), plan, full)
        value = f"resources.{name}.{key}={shown}"
        option = f"--set '{value}'" if " " in value else f"--set {value}"
        yield from _saving(plan, other, key, name, before, shown, loses, option)


def _candidates(model: ResourceModel, desc: TextureDesc) -> Iterator[tuple[str, str, Any, str, str]]:
    """Key of the resource, its value before, after, after as YAML, and what is lost."""
    step = _NARROWER.get(desc.format)
    losses: list[str] = []
    while step is not None:
        losses.append(step[1])
        yield "format", desc.format, step[0], step[0], "; ".join(losses)
        step = _NARROWER.get(step[0])
    fewer = "three quarters of its texels"
    if model.fixed is not None:
        half = max(1, desc.width // 2), max(1, desc.height // 2)
        yield "fixed", f"[{desc.width}, {desc.height}]", half, f"[{half[0]}, {half[1]}]", fewer
    else:
        scale = model.scale if model.scale is not None else 1.0
        yield "scale", f"{scale:g}", scale / 2, f"{scale / 2:g}", fewer
    if desc.samples > 1:
        half_samples = desc.samples // 2
        yield "samples", str(desc.samples), half_samples, str(half_samples), "half of its samples"


def _replanned(document: Document, plan: Plan, full: bool) -> Plan | None:
    frame, features = plan.graph.frame, plan.graph.features
    try:
        graph, _ = expand(document, features=features, full=full, size=(frame.width, frame.height), frames=frame.count)
        return compile_plan(graph, plan.options)[0]
    except RenderGraphError:  # a node refuses the change
        return None


def _saving(
    plan: Plan, other: Plan | None, change: str, resource: str | None, before: str, after: str, loses: str, option: str
) -> Iterator[Advice]:
    """The change as advice, if it can be made and saves something."""
    if other is not None and other.totals.used < plan.totals.used:
        totals = other.totals
        saves = plan.totals.used - totals.used
        yield Advice(change, resource, before, after, totals.used, totals.load, saves, loses, option)
