"""Driver errors become Python errors that name graph, pass, resource and line, and nothing lingers."""

from __future__ import annotations

import pytest

from rendergraph.device import enums as e
from rendergraph.device.context import Device
from rendergraph.device.textures import Texture, create_texture, destroy_texture, generate_mips, upload_texture
from rendergraph.document.messages import RenderGraphError
from rendergraph.plan.graph import Position, TextureDesc


def misbind(device: Device) -> None:
    """An error of the kind a wrong transient offset makes."""
    device.gl.glBindBufferRange(e.SHADER_STORAGE_BUFFER, 0, 0, 3, -1)
    device.gl.glEnable(0xFFFF)


def test_leaving_a_pass_raises_what_it_caused(device: Device) -> None:
    at = Position("graph.yaml", 14, 9)
    with pytest.raises(RenderGraphError) as caught, device.scope("my graph"), device.scope("blur.horizontal", at):
        misbind(device)
    found = caught.value.diagnostics[0]
    assert found.code == "RG500"
    assert found.data["scope"] == "my graph/blur.horizontal"
    assert found.position == at
    if device.debug.synchronous:
        assert "INVALID" in found.data["detail"]
    device.check()


def test_the_position_of_the_innermost_scope_that_has_one(device: Device) -> None:
    at = Position("graph.yaml", 2, 1)
    with pytest.raises(RenderGraphError) as caught, device.scope("outer", at), device.scope("inner"):
        misbind(device)
    assert caught.value.diagnostics[0].position == at


def test_a_scope_can_be_entered_every_frame(device: Device) -> None:
    scope = device.scope("pass")
    for _ in range(3):
        with scope:
            pass
    assert device.debug.stack == []
    with pytest.raises(RenderGraphError), scope:
        misbind(device)
    with scope:  # yesterday's error is not blamed on today
        pass


def test_an_error_of_the_body_wins_and_the_stack_is_unwound(device: Device) -> None:
    with pytest.raises(KeyError), device.scope("pass"):
        raise KeyError
    assert device.debug.stack == []
    device.check()


def test_the_resource_is_named(device: Device) -> None:
    bad = Texture(987654, TextureDesc("rgba8", 4, 4), e.TEXTURE_2D, "hdr")
    with pytest.raises(RenderGraphError) as caught, device.scope("mips"):
        generate_mips(device, bad)
    assert caught.value.diagnostics[0].data["resource"] == "hdr"


def test_repeated_errors_are_said_once(device: Device) -> None:
    for _ in range(100):
        device.gl.glEnable(0xFFFF)
    with pytest.raises(RenderGraphError) as caught:
        device.check()
    assert len(caught.value.diagnostics) == 1


def test_long_and_foreign_labels(device: Device) -> None:
    label = "größe/" + "x" * 1000
    with device.scope(label):
        texture = create_texture(device, TextureDesc("r8", 1, 1), label)
    destroy_texture(device, texture)
    device.check()


def test_polling_finds_errors_without_a_callback(device: Device) -> None:
    gl = device.gl
    gl.glDisable(e.DEBUG_OUTPUT)
    device.debug.synchronous, proven = False, device.debug.synchronous
    try:
        gl.glEnable(0xFFFF)
        with pytest.raises(RenderGraphError) as caught:
            device.check()
        assert caught.value.diagnostics[0].code == "RG500"
        device.check()
    finally:
        gl.glEnable(e.DEBUG_OUTPUT)
        device.debug.synchronous = proven


def test_group_messages_do_not_reach_python(device: Device) -> None:
    before = (len(device.debug.errors), len(device.debug.warnings))
    with device.scope("a"), device.scope("b"):
        pass
    assert (len(device.debug.errors), len(device.debug.warnings)) == before


def test_upload_out_of_range_names_texture(device: Device) -> None:
    import numpy as np

    texture = create_texture(device, TextureDesc("r8", 4, 4), "small")
    with pytest.raises(RenderGraphError) as caught, device.scope("load"):
        upload_texture(
            device,
            Texture(texture.glo, TextureDesc("r8", 8, 8), texture.target, "small"),
            np.zeros((8, 8, 1), np.uint8),
        )
    assert caught.value.diagnostics[0].data["resource"] == "small"
    destroy_texture(device, texture)


def warn(device: Device, text: bytes) -> None:
    """What the driver does that notices undefined behaviour: llvmpipe cannot be made to."""
    device.debug._callback(e.DEBUG_SOURCE_API, e.DEBUG_TYPE_UNDEFINED_BEHAVIOR, 7, 0x9147, len(text), text, None)


def test_undefined_behaviour_is_a_warning_with_pass_and_resource_said_once(device: Device) -> None:
    assert device.debug.take_warnings() == ()
    at = Position("graph.yaml", 14, 9)
    for _ in range(5):  # every frame
        with device.scope("blur.horizontal", at):
            device.debug.subject = "hdr"
            warn(device, b"sampling what is being written")
            device.debug.subject = ""
    with device.scope("other"):
        warn(device, b"sampling what is being written")
    first, second = device.debug.take_warnings()
    assert (first.code, first.severity, first.position) == ("RG507", "warning", at)
    assert first.data == {
        "where": " in blur.horizontal", "what": " on 'hdr'", "detail": "sampling what is being written",
        "scope": "blur.horizontal", "resource": "hdr",
    }  # fmt: skip
    assert (second.data["scope"], second.data["resource"]) == ("other", "")
    assert device.debug.take_warnings() == (), "taken is taken"
    device.check()
