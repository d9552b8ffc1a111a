"""Every shipped node meets every demand, or says why not."""

from __future__ import annotations

from functools import cache

import pytest

from rendergraph.conformance.conform import hold
from rendergraph.conformance.demands import DEMANDS
from rendergraph.conformance.subject import Subject
from rendergraph.node.discovery import node_folder

NODES = sorted(path.parent.name for path in node_folder().glob("*/__init__.py"))

subject = cache(Subject)  # what several demands look at is made once in a process


@pytest.mark.gpu
@pytest.mark.parametrize("demand", DEMANDS)
@pytest.mark.parametrize("node", NODES)
def test_meets(node: str, demand: str) -> None:
    verdict = hold(subject(node), DEMANDS[demand])
    assert verdict.status in ("met", "exempt"), [f"{one.reason}: {one.text}" for one in verdict.shortfalls]


def test_exemptions_are_few_and_told() -> None:
    assert {node: dict(subject(node).node.exempt) for node in NODES if subject(node).node.exempt} == {}
