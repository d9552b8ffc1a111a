"""Programs and draws of the scene's geometry, shared by every node that rasterises it."""

from __future__ import annotations

from rendergraph.node.bindings import depth
from rendergraph.node.builder import Builder
from rendergraph.plan.graph import DrawScene, Program, State

ALL_SLOTS = 0b11111  # of Material.textures, shaders/scene.glsl


def scene_program(
    b: Builder,
    fragment: str,
    *,
    alpha_test: bool,
    depth_only: bool = False,
    layered: bool = False,
    normal_map: bool = False,
    defines: dict[str, int] | None = None,
) -> Program:
    """``<scene.vert>`` with a fragment shader of the node, and the defines both are compiled with."""
    variant = {
        "ALPHA_TEST": alpha_test,
        "DEPTH_ONLY": depth_only,
        "LAYERED": layered,
        "NORMAL_MAP": normal_map,
        "BACK_FACES": not depth_only and b.requires("double_sided"),
        "UNLIT_SURFACES": not depth_only and b.requires("unlit"),
        "TEXTURE_SLOTS": ALL_SLOTS if b.full else b.features.texture_slots,
        "TEXTURE_TRANSFORMS": b.full or b.features.texture_transforms,
        "TEXTURE_WRAPS": b.full or b.features.texture_wraps,
        "SECOND_UV": b.full or b.features.second_uv,
        "VERTEX_COLORS": b.full or b.features.vertex_colors,
    }
    return b.program("<scene.vert>", fragment, defines={**variant, **(defines or {})})


def solid_queues(b: Builder, *, in_view: bool = True) -> list[str]:
    """The queues of opaque and alpha-tested geometry that the scene has, or has ``in_view``; what is left out is
    recorded.
    """
    needed = b.sees if in_view else b.requires
    return [queue for queue in ("opaque", "masked") if needed(queue, queue)]


def depth_prepass(b: Builder, target: str, queues: list[str]) -> None:
    """Fill the depth texture ``target`` with the scene's solid geometry before anything is shaded.

    The pass that follows tests with ``equal``: both take invariant positions from the one ``scene.vert``.
    """
    for queue in queues:
        first = queue == queues[0]
        b.raster(
            f"prepass_{queue}",
            scene_program(b, "<depth_only.frag>", alpha_test=queue == "masked", depth_only=True),
            depth=depth(target, clear=1.0) if first else depth(target, load=True),
            work=DrawScene((queue,)),
            state=State(depth_test="closer"),
        )
