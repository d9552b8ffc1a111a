"""Smooths jagged edges of a finished image by finding and blending across luma edges, after Lottes' FXAA."""

from __future__ import annotations

from rendergraph.node.bindings import color, sample
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob

DISPLAY_FORMATS = ("rgba8", "rgb10_a2", "rgba16", "rgba16f", "rgba32f")


class FxaaParams(Params):
    """How faint an edge counts, how far its ends are sought, how much fine detail is softened."""

    edge_threshold: float = knob(
        0.125, "Contrast of an edge, as a fraction of the brightest luma around it.", ge=0.0, le=1.0, accurate="down"
    )
    edge_minimum: float = knob(
        0.0312, "Contrast below which nothing is an edge, in encoded luma.", ge=0.0, le=1.0, accurate="down"
    )
    search_steps: int = knob(
        12, "Steps sought along an edge each way; longer edges are blended better.", ge=1, le=32, accurate="up"
    )
    subpixel: float = knob(0.75, "How much details below a pixel are softened.", ge=0.0, le=1.0)


class Fxaa(Node[FxaaParams]):
    """Anti-aliases a display-referred image in one draw (an FXAA-class filter)."""

    inputs = {"color": Port("Tone-mapped, sRGB-encoded colour.", formats=DISPLAY_FORMATS)}
    outputs = {"color": Port("The smoothed image; alpha is the input's.", formats=DISPLAY_FORMATS, like="color")}

    def build(self, b: Builder) -> None:
        """One full-screen draw."""
        uniforms = {
            "u_edge_threshold": self.params.edge_threshold,
            "u_edge_minimum": self.params.edge_minimum,
            "u_search_steps": self.params.search_steps,
            "u_subpixel": self.params.subpixel,
        }
        b.raster(
            "resolve",
            b.program("fxaa.frag"),
            color=[color(b.output("color"))],
            bind={"u_color": sample(b.input("color"))},
            uniforms=uniforms,
        )
