"""Renamed passes are found where nothing else can be meant, and only there."""

from rendergraph.report.diff_names import match_passes


def test_a_rename_between_the_same_neighbours() -> None:
    found = match_passes(
        {"gbuffer": "gbuffer", "light": "deferred", "tonemap": "tonemap"},
        {"gbuffer": "gbuffer", "shade": "deferred", "tonemap": "tonemap"},
    )
    assert found.renamed == {"light": "shade"}
    assert (found.only_before, found.only_after) == ((), ())
    assert [found.after_name(n) for n in ("light", "light.cull", "tonemap", "lights")] == [
        "shade",
        "shade.cull",
        "tonemap",
        "lights",
    ]


def test_another_node_is_another_pass() -> None:
    found = match_passes({"a": "x", "light": "deferred"}, {"a": "x", "shade": "forward"})
    assert found.renamed == {}
    assert (found.only_before, found.only_after) == (("light",), ("shade",))


def test_another_place_is_another_pass() -> None:
    found = match_passes({"blur": "blur", "a": "x"}, {"a": "x", "blur_late": "blur"})
    assert found.renamed == {}


def test_two_candidates_are_no_candidate() -> None:
    found = match_passes({"a": "x", "one": "blur"}, {"a": "x", "first": "blur", "second": "blur"})
    assert found.renamed == {}
    assert found.only_after == ("first", "second")


def test_without_nodes_nothing_is_guessed() -> None:
    assert match_passes({"a": ""}, {"b": ""}).renamed == {}
