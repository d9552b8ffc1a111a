"""Maps scene-linear radiance to a display: exposure, a tone curve, sRGB encoding and dither in one draw."""

from __future__ import annotations

from typing import Literal

from rendergraph.document.formats import HDR
from rendergraph.node.bindings import Binding, color, read_buffer, sample
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Extreme, Measure, Quantity, Reference
from rendergraph.nodes.exposure.buffer import require_exposure

Curve = Literal["agx", "aces", "reinhard", "linear"]
Dither = Literal["none", "ordered", "triangular"]

#: Bits of a colour channel, by which one step of dither is scaled; float targets have none and are not dithered.
CHANNEL_BITS = {"rgba8": 8, "rgb10_a2": 10, "rgba16": 16}


_CURVES = ("agx", "aces", "reinhard", "linear")
EXTREMES = (
    Extreme("darkest", "Thirty-two stops down.", tuple(f"passes.through_{c}.set.ev=-32" for c in _CURVES)),
    Extreme("brightest", "Thirty-two stops up.", tuple(f"passes.through_{c}.set.ev=32" for c in _CURVES)),
    Extreme("ordered_dither", "Bayer's matrix.", tuple(f"passes.through_{c}.set.dither=ordered" for c in _CURVES)),
    Extreme("no_dither", "Rounding alone.", tuple(f"passes.through_{c}.set.dither=none" for c in _CURVES)),
    Extreme("tiny_white", "Everything is brighter than white.", ("passes.through_reinhard.set.white=1.0e-6",)),
    Extreme("ten_bits", "A target of ten bits.", ("outputs.agx.format=rgb10_a2", "outputs.agx.file=agx.npy")),
    Extreme("half_float", "A target that is not dithered.", ("outputs.agx.format=rgba16f", "outputs.agx.file=agx.npy")),
    Extreme("packed_radiance", "Radiance in eleven bits.", ("resources.chart.format=r11g11b10f",)),
    Extreme(
        "white_of_zero", "A white of nothing is no white.", ("passes.through_reinhard.set.white=0",), refused="RG205"
    ),
)


class TonemapParams(Params):
    """The curve, the exposure in stops, and how the last bit is rounded."""

    curve: Curve = knob("agx", "Tone curve: agx (Sobotka), aces (Hill's fit), reinhard (extended) or linear (clamp).")
    ev: float = knob(
        0.0,
        "Exposure, multiplied onto the exposure input's where one is connected.",
        unit="stops",
        ge=-32,
        le=32,
        accurate="neither",
    )
    white: float = knob(
        4.0, "Luminance that `reinhard` maps to white; the other curves ignore it.", gt=0, le=65504, accurate="neither"
    )
    dither: Dither = knob("triangular", "Noise below one step of the output, against banding.")


class Tonemap(Node[TonemapParams]):
    """Tone-maps linear radiance to a display-referred, sRGB-encoded image."""

    inputs = {
        "color": Port("Scene-linear Rec. 709 radiance.", formats=("rgba16f", *sorted(HDR - {"rgba16f"}))),
        "exposure": Port("The exposure node's buffer.", buffer=True, optional=True),
    }
    outputs = {
        "color": Port(
            "sRGB-encoded colour, alpha 1.", formats=("rgba8", "rgb10_a2", "rgba16", "rgba16f", "rgba32f"), like="color"
        ),
    }
    reference = Reference(
        "float64",
        {
            "color": Measure(
                Quantity.DISPLAY, "max", 0.0023, "The curve, sRGB encoding and dither in float64, before rounding.",
                port="color", ideal=False,
            ),
            "display": Measure(
                Quantity.DISPLAY, "rmse", 0.0023, "The curve and sRGB encoding alone: what dither and rounding add.",
                port="color",
            ),
        },
        source="Sobotka, AgX; Hill's ACES fit (Baking Lab); Reinhard et al. 2002; IEC 61966-2-1; Bayer 1973; Jarzynski "
        "and Olano 2020",
    )  # fmt: skip
    bounds = {"color": (0.0, 1.0)}
    extremes = EXTREMES
    accuracy_axes = {"resources.aces={format: rgba8}|{format: rgb10_a2}|{format: rgba16}": "display"}

    def build(self, b: Builder) -> None:
        """One full-screen draw."""
        output = b.output("color")
        bind: dict[str, Binding] = {"u_color": sample(b.input("color"))}
        if "exposure" in b.inputs:
            require_exposure(b, b.inputs["exposure"])
            bind["ExposureInput"] = read_buffer(b.input("exposure"))
        bits = CHANNEL_BITS.get(b.texture_desc(output).format)
        dither = self.params.dither if bits else "none"
        defines = {"DITHER": ("none", "ordered", "triangular").index(dither), "METERED": "exposure" in b.inputs}
        uniforms: dict[str, float] = {"u_gain": 2.0**self.params.ev}
        if dither != "none" and bits:
            uniforms["u_step"] = 1.0 / (2**bits - 1)
        if self.params.curve == "reinhard":
            uniforms["u_white"] = self.params.white
        program = b.program(f"{self.params.curve}.frag", defines=defines)
        b.raster("map", program, color=[color(output)], bind=bind, uniforms=uniforms)
