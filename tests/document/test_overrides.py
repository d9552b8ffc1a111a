"""``--set`` arguments: what they change, where errors in them point, and that aliases do not leak them."""

from __future__ import annotations

import pytest
from sample_graph import GRAPH, BlurParams, Fail, Load, places

from rendergraph.document.messages import RenderGraphError


def test_values_are_yaml(load: Load) -> None:
    document = load(
        GRAPH,
        "passes.blur.set.radius=3.5",
        "passes.blur.set.offset=[1, 2.5]",
        "frame.size= [8, 4]",
        "title=a=b",
        "resources.extra={format: r8, scale: 0.5}",
        "outputs.image.file='x.png'",
    )
    assert document.params["blur"] == BlurParams(radius=3.5, offset=(1, 2.5))
    assert document.model.frame.size == (8, 4)
    assert document.model.title == "a=b"
    assert document.model.resources["extra"].scale == 0.5
    assert document.model.outputs["image"].file == "x.png"


def test_keys_left_at_their_defaults_can_be_set(load: Load) -> None:
    document = load(
        GRAPH.replace("frame: {size: [64, 32]}\n", ""),
        "frame.count=7",
        "scene.source=atrium",
        "scene.lights.sun.illuminance=2",
        "passes.blur.keep=true",
        "budget={draws: 3}",
        "outputs.first.file=first.png",
        "outputs.blur.halo.file=halo.png",
    )
    assert document.model.frame.count == 7
    assert document.model.scene is not None
    assert document.model.scene.lights.sun is not None
    assert document.model.scene.lights.sun.illuminance == 2
    assert document.model.passes["blur"].keep
    assert document.model.budget.draws == 3
    assert set(document.model.outputs) == {"image", "first", "blur.halo"}


def test_later_wins_and_lists_are_indexed(load: Load) -> None:
    document = load(GRAPH, "frame.seed=1", "frame.seed=2", "frame.size.1=16")
    assert document.model.frame.seed == 2
    assert document.model.frame.size == (64, 16)


def test_an_alias_is_changed_in_one_place_only(load: Load) -> None:
    text = GRAPH.replace("set: {radius: 2}", "set: &s {radius: 2}").replace(
        "outputs:", "  two: {node: blur, read: {color: image}, write: {color: last}, set: *s}\noutputs:"
    )
    document = load(text, "passes.two.set.radius=9")
    assert document.params["blur"] == BlurParams(radius=2)
    assert document.params["two"] == BlurParams(radius=9)


def test_positions_name_the_argument(load: Load) -> None:
    document = load(GRAPH, "passes.blur.set.offset=[1, 2]", "frame.count=3")
    at = document.position("passes", "blur", "set", "offset", 1)
    assert (at.file, at.line, at.column) == ("--set passes.blur.set.offset=[1, 2]", 1, 28)
    assert document.position("passes", "blur", "set", "offset", key=True).column == 1
    assert document.position("frame", "count").file == "--set frame.count=3"
    assert document.position("frame", "size", 0).file.endswith("graph.yaml")


@pytest.mark.parametrize(
    ("argument", "code", "column"),
    [
        ("passes.blur.set.radius=-1", "RG205", 24),
        ("passes.blur.set.raduis=1", "RG204", 1),
        ("passes.blur.set.radius=", "RG205", 24),
        ("passes.blur.set.radius=yes", "RG205", 24),
        ("passes.blur.set.radius=010", "RG112", 24),
        ("passes.blur.nod=x", "RG121", 1),
        ("passes.blur.node=blurr", "RG200", 18),
        ("passes.blur.read.mask=a b", "RG125", 23),
        ("passes.blur.read.mesk=first", "RG201", 1),
        ("frame.sise=[1, 1]", "RG121", 1),
        ("frame.size=[1, 0]", "RG123", 16),
        ("farme.size=[1, 1]", "RG121", 1),
        ("resources.first={formt: r8, format: r8}", "RG121", 18),
        ("outputs.image.file=../x.png", "RG127", 20),
    ],
)
def test_wrong_values(fail: Fail, argument: str, code: str, column: int) -> None:
    found = fail(GRAPH, argument)
    assert places(found) == [(code, 1, column)]
    assert found[0].position is not None
    assert found[0].position.file == f"--set {argument}"


@pytest.mark.parametrize(
    ("argument", "code"),
    [
        ("", "RG130"),
        ("frame.count", "RG130"),
        ("=3", "RG130"),
        ("frame..count=3", "RG130"),
        (".frame=3", "RG130"),
        ("a=" + "x" * 200_000, "RG130"),
        ("passes.blurr.set.radius=1", "RG131"),
        ("resources.frist.scale=1", "RG131"),
        ("passes.blur.node.deep=1", "RG131"),
        ("frame.size.2=1", "RG131"),
        ("frame.size.x=1", "RG131"),
        ("frame.size.x.y=1", "RG131"),
        ("frame.size.0.y=1", "RG131"),
        ("frame.size=[1", "RG104"),
        ("title=\x01", "RG104"),
        ("title=a: b: c", "RG104"),
        ("title=*x", "RG109"),
        ("title=1\n---\n2", "RG111"),
        ("title=" + "[" * 100, "RG108"),
    ],
)
def test_unusable_arguments_are_usage_errors(load: Load, argument: str, code: str) -> None:
    with pytest.raises(RenderGraphError) as error:
        load(GRAPH, argument)
    assert [d.code for d in error.value.diagnostics] == [code]
    assert error.value.exit_code == 2
    assert error.value.diagnostics[0].position is not None
    assert error.value.diagnostics[0].position.file == f"--set {argument}"


def test_all_unusable_arguments_are_reported(load: Load) -> None:
    with pytest.raises(RenderGraphError) as error:
        load(GRAPH, "frame", "passes.blurr.keep=true", "frame.count=2")
    assert [d.code for d in error.value.diagnostics] == ["RG130", "RG131"]
    assert "blur" in error.value.diagnostics[1].help


def test_bytes_that_are_no_text(load: Load) -> None:
    assert load(GRAPH, "title=a\udcff").model.title == "a?"  # an argument of the wrong encoding
