"""Budgets of error in a bench: a side that has any is judged once, after its times are known."""

from __future__ import annotations

from rendergraph.device.context import open_device
from rendergraph.document.load import load_document
from rendergraph.document.messages import Diagnostic
from rendergraph.measure.bench_job import BenchJob, Side
from rendergraph.measure.truth.accuracy import judge_graph
from rendergraph.measure.truth.cache import open_cache
from rendergraph.plan.plan import PlanOptions
from rendergraph.report.accuracy_findings import check_error_budget, check_flip_budget
from rendergraph.run.plan_document import plan_document


def check_errors(job: BenchJob, side: Side) -> list[Diagnostic]:
    """RG710 and RG711 for a side's errors above its budgets of ``error`` and ``flip``; nothing is run without any.

    :raises RenderGraphError: for every error of the run or of its references.
    """
    document = load_document(side.graph, side.overrides)
    budget = document.model.budget
    if not budget.error and budget.flip is None:
        return []
    planned = plan_document(document, PlanOptions(), scene=job.scene, size=job.size, full=job.full or side.full)
    # FLIP is of the outputs, which any pass may write.
    passes = () if budget.flip is not None else tuple(budget.error)
    judged = judge_graph(document, planned, open_device(job.device), passes, cache=open_cache())
    return [*check_error_budget(document, judged), *check_flip_budget(document, judged)]
