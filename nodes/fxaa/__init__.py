"""Smooths jagged edges of a finished image by finding and blending across luma edges, after Lottes' FXAA."""

from __future__ import annotations

from rendergraph.node.bindings import color, sample
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Extreme, Measure, Quantity, Reference

DISPLAY_FORMATS = ("rgba8", "rgb10_a2", "rgba16", "rgba16f", "rgba32f")


EXTREMES = (
    Extreme("every_edge", "No contrast is too faint.",
            ("passes.antialias.set.edge_threshold=0", "passes.antialias.set.edge_minimum=0")),
    Extreme("no_edge", "No contrast is enough.", ("passes.antialias.set.edge_minimum=1",)),
    Extreme("shortest_search", "One step each way.", ("passes.antialias.set.search_steps=1",)),
    Extreme("longest_search", "A hundred texels each way.", ("passes.antialias.set.search_steps=32",)),
    Extreme("sharpest", "Nothing below a pixel is softened.", ("passes.antialias.set.subpixel=0",)),
    Extreme("softest", "Everything below a pixel is.", ("passes.antialias.set.subpixel=1",)),
    Extreme("half_float", "A display in half floats.",
            ("outputs.aliased.format=rgba16f", "outputs.aliased.file=aliased.npy",
             "outputs.image.format=rgba16f", "outputs.image.file=image.npy")),
    Extreme("no_search", "A search without a step.", ("passes.antialias.set.search_steps=0",), refused="RG205"),
)  # fmt: skip


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
    subpixel: float = knob(0.75, "How much details below a pixel are softened.", ge=0.0, le=1.0, accurate="neither")


class Fxaa(Node[FxaaParams]):
    """Anti-aliases a display-referred image in one draw (an FXAA-class filter)."""

    inputs = {"color": Port("Tone-mapped, sRGB-encoded colour.", formats=DISPLAY_FORMATS)}
    outputs = {"color": Port("The smoothed image; alpha is the input's.", formats=DISPLAY_FORMATS, like="color")}
    reference = Reference(
        "brute_force",
        {
            "filter": Measure(
                Quantity.DISPLAY, "max", 0.0022, "The same filter in float64, before rounding.", port="color",
                ideal=False,
            ),
            "coverage": Measure(
                Quantity.DISPLAY, "rmse", 0.036, "The input with 64 samples a pixel. The tolerance is the unfiltered "
                "input's own error.", port="color",
            ),
        },
        source="Lottes 2009; brute-force supersampling",
    )  # fmt: skip
    bounds = {"color": (0.0, 1.0)}
    extremes = EXTREMES

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
