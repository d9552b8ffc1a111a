"""What a node may ask of the view, and what it leaves out for it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from rendergraph.node.builder import Builder
from rendergraph.plan.graph import Frame, Resource, TextureDesc
from rendergraph.scene.features import SceneFeatures, ViewFeatures

SEEN = SceneFeatures(opaque=True, masked=True, view=ViewFeatures(unseen=frozenset({"masked"})))


def builder(features: SceneFeatures, *, full: bool = False) -> Builder:
    """A pass ``p`` that writes ``target``."""
    outputs = {"color": Resource("target", TextureDesc("rgba8", 8, 8))}
    return Builder("p", Path("/n"), Path("/g"), Frame(8, 8), features, full, {}, outputs)


@pytest.mark.parametrize(
    ("feature", "full", "known", "sees", "reasons"),
    [
        ("opaque", False, True, True, []),
        ("masked", False, True, False, ["none_in_view"]),
        ("masked", False, False, True, []),
        ("masked", True, True, True, []),
        ("blended", False, True, False, ["scene_lacks_feature"]),
        ("blended", True, True, True, []),
    ],
)
def test_what_is_seen(feature: str, full: bool, known: bool, sees: bool, reasons: list[str]) -> None:
    b = builder(SEEN if known else replace(SEEN, view=None), full=full)
    assert b.sees(feature, "step") is sees
    assert b.sees(feature, "step") is sees, "and said once"
    assert [d.reason for d in b.decisions] == reasons
    assert all((d.kind, d.subject, d.evidence["feature"]) == ("specialise", "p.step", feature) for d in b.decisions)


def test_in_full_nothing_is_known_of_the_view() -> None:
    assert builder(SEEN, full=True).view is None
    assert builder(SEEN).view is SEEN.view
    assert SEEN.full().view is None


def test_formats_are_narrowed_only_for_a_scene() -> None:
    for full, expected in ((False, {"target": "r8"}), (True, {})):
        b = builder(SEEN, full=full)
        b.narrow("color", "r8")
        assert b.narrowed == expected
