"""`pytest --rg-node mypackage.mynode`: one test for each demand on a node, beside the package's own tests.

Loaded into every pytest run where rendergraph is installed: nothing but pytest is imported until the option is given.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from rendergraph.conformance.demand import Demand
    from rendergraph.conformance.subject import Subject


def pytest_addoption(parser: pytest.Parser) -> None:
    """The option."""
    group = parser.getgroup("rendergraph")
    group.addoption(
        "--rg-node", action="append", default=[], metavar="NODE",
        help="hold this node (its name or module) against rendergraph's conformance suite; repeatable, `all` for all",
    )  # fmt: skip


@pytest.hookimpl(tryfirst=True)  # before -k and -m choose among the tests
def pytest_collection_modifyitems(session: pytest.Session, config: pytest.Config, items: list[pytest.Item]) -> None:
    """Add a test for each demand on each node asked for."""
    if not config.getoption("--rg-node"):
        return
    from rendergraph.conformance.conform import resolve
    from rendergraph.document.messages import RenderGraphError
    from rendergraph.node.discovery import node_names

    for asked in dict.fromkeys(config.getoption("--rg-node")):
        try:
            names = node_names() if asked == "all" else (resolve(asked),)
        except RenderGraphError as error:
            raise pytest.UsageError("; ".join(f"{d.code} {d.text}; {d.help}" for d in error.diagnostics)) from error
        for name in names:
            items.extend(NodeDemands.from_parent(session, name=f"rg-node::{name}", node=name).collect())


class NodeDemands(pytest.Collector):
    """The demands on one node."""

    def __init__(self, *, node: str, **given: Any) -> None:
        super().__init__(**given)
        self.node = node

    def collect(self) -> Iterator[DemandItem]:
        """A test for each."""
        from rendergraph.conformance.demands import DEMANDS
        from rendergraph.conformance.subject import Subject

        subject = Subject(self.node)  # what several demands look at is made once
        for demand in DEMANDS.values():
            yield DemandItem.from_parent(self, name=demand.name, subject=subject, demand=demand)


class DemandItem(pytest.Item):
    """One demand on one node. An exemption, and a demand that could not be tried, is a skip with its reason."""

    def __init__(self, *, subject: Subject, demand: Demand, **given: Any) -> None:
        super().__init__(**given)
        self.subject, self.demand = subject, demand

    def runtest(self) -> None:
        """Try it."""
        from rendergraph.conformance.conform import hold
        from rendergraph.document.messages import RenderGraphError

        try:
            verdict = hold(self.subject, self.demand)
        except RenderGraphError as error:  # no OpenGL here
            pytest.skip("; ".join(f"{d.code} {d.text}" for d in error.diagnostics))
        for note in verdict.notes:
            self.add_report_section("call", "notes", note)
        if verdict.status in ("exempt", "not_tried"):
            pytest.skip(f"{verdict.status.replace('_', ' ')}: {verdict.reason}")
        if verdict.status == "missed":
            raise DemandMissedError("\n".join(f"{verdict.code} {one.reason}: {one.text}" for one in verdict.shortfalls))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """The shortfalls alone: a traceback through the suite tells a node's author nothing."""
        if isinstance(excinfo.value, DemandMissedError):
            return f"{self.subject.name} misses the demand `{self.demand.name}`: {self.demand.help}\n{excinfo.value}"
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Any, int | None, str]:
        """Where: the node's folder."""
        return self.path, None, f"{self.subject.name}: {self.demand.name}"


class DemandMissedError(Exception):
    """A demand that is not met, with its shortfalls."""
