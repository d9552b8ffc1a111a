"""Meters an image and chooses the exposure that maps its average to middle grey."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from rendergraph.document.formats import HDR
from rendergraph.node.bindings import Binding, read_buffer, sample, update_buffer, write_buffer
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Extreme, Measure, Quantity, Reference
from rendergraph.nodes.exposure.buffer import require_exposure

BINS = 256
TILE = 32  # texels a side that one work group of 16 x 16 threads reads
PARTIAL_BYTES = 8  # sum and count of one work group


EXTREMES = (
    Extreme("average", "The plain mean.", ("passes.meter.set.mode=average",)),
    Extreme("manual_dark", "Thirty-two stops down.",
            ("passes.meter.set.mode=manual", "passes.meter.set.compensation=-32")),
    Extreme("manual_bright", "Thirty-two stops up.",
            ("passes.meter.set.mode=manual", "passes.meter.set.compensation=32")),
    Extreme("widest_range", "Forty-eight stops in 256 bins.",
            ("passes.meter.set.min_ev=-24", "passes.meter.set.max_ev=24")),
    Extreme("narrowest_range", "Nearly every texel beyond the range.",
            ("passes.meter.set.min_ev=0", "passes.meter.set.max_ev=0.001")),
    Extreme("brightest_texels", "The brightest hundredth alone.",
            ("passes.meter.set.low=0.99", "passes.meter.set.high=1")),
    Extreme("darkest_texels", "The darkest hundredth alone.", ("passes.meter.set.low=0", "passes.meter.set.high=0.01")),
    Extreme("coarsest_stride", "One texel of 256.", ("passes.meter.set.stride=16",)),
    Extreme("frozen", "An exposure that never moves.", ("passes.meter.set.brighten=0", "passes.meter.set.darken=0")),
    Extreme("at_once", "An exposure without inertia.", ("passes.meter.set.brighten=1", "passes.meter.set.darken=1")),
    Extreme("full_float", "Radiance of 32 bits.", ("resources.hdr.format=rgba32f",)),
    Extreme("no_range", "A range that holds nothing.", ("passes.meter.set.min_ev=14",), refused="RG205"),
    Extreme("short_buffer", "A buffer too small.", ("resources.exposure.bytes=12",), refused="RG225"),
)  # fmt: skip


class ExposureParams(Params):
    """How the scene is metered and how fast the exposure follows it."""

    mode: Literal["histogram", "average", "manual"] = knob(
        "histogram",
        "histogram (trimmed mean of log luminance), average (its plain mean) or manual (compensation alone).",
    )
    compensation: float = knob(
        0.0,
        "Added to what the meter chose; the whole exposure in manual mode.",
        unit="stops",
        ge=-32,
        le=32,
        accurate="neither",
    )
    low: float = knob(
        0.5,
        "Fraction of the texels, darkest first, that the histogram leaves out.",
        ge=0.0,
        le=0.99,
        accurate="neither",
    )
    high: float = knob(
        0.95, "Fraction of the texels up to which the histogram counts.", ge=0.01, le=1.0, accurate="neither"
    )
    min_ev: float = knob(
        -10.0, "Log2 luminance that darker texels are metered as.", unit="stops", ge=-24, le=24, accurate="neither"
    )
    max_ev: float = knob(
        14.0, "Log2 luminance that brighter texels are metered as.", unit="stops", ge=-24, le=24, accurate="neither"
    )
    stride: int = knob(
        1, "Every how many texels one is read, along both axes.", unit="px", ge=1, le=16, accurate="down"
    )
    brighten: float = knob(
        0.1, "Share of the way to a higher exposure that one frame goes.", ge=0.0, le=1.0, accurate="neither"
    )
    darken: float = knob(
        0.3, "Share of the way to a lower exposure that one frame goes.", ge=0.0, le=1.0, accurate="neither"
    )

    @model_validator(mode="after")
    def _ranges(self) -> ExposureParams:
        if self.high - self.low < 0.01:
            raise ValueError(f"high ({self.high:g}) must exceed low ({self.low:g}) by 0.01 or more")
        if self.max_ev <= self.min_ev:
            raise ValueError(f"max_ev ({self.max_ev:g}) must exceed min_ev ({self.min_ev:g})")
        return self


class Exposure(Node[ExposureParams]):
    """Chooses the exposure of an image from its log-luminance histogram, adapting over frames."""

    inputs = {
        "color": Port("Scene-linear Rec. 709 radiance.", formats=("rgba16f", *sorted(HDR - {"rgba16f"}))),
        "previous": Port(
            "Last frame's exposure buffer; without it the exposure follows at once.", buffer=True, optional=True
        ),
    }
    outputs = {"exposure": Port("Scale, log luminance and texels metered: 16 bytes (exposure.glsl).", buffer=True)}
    reference = Reference(
        "brute_force",
        {
            "exposure": Measure(
                Quantity.SCALAR, "max", 0.0472, "Exposure from the exact trimmed mean of every texel's log luminance.",
                unit="stops",
            ),
            "meter": Measure(
                Quantity.SCALAR, "max", 0.005, "This frame's measurement, by the meter's own bins and stride in "
                "float64.", unit="stops", ideal=False,
            ),
            "adaptation": Measure(
                Quantity.SCALAR, "max", 5e-5, "Adaptation from the last exposure, and the scale, in float64.",
                unit="stops", ideal=False,
            ),
            "texels": Measure(Quantity.IDENTITY, "mismatch_rate", 0.0, "Finite texels metered.", ideal=False),
        },
        source="Krawczyk, Myszkowski and Seidel 2005",
    )  # fmt: skip
    extremes = EXTREMES

    def build(self, b: Builder) -> None:
        """Manual: one dispatch. Average: per-tile sums, then their sum. Histogram: clear, count, reduce."""
        for connected in (b.inputs.get("previous"), b.outputs["exposure"]):
            if connected is not None:
                require_exposure(b, connected)
        if self.params.mode == "histogram":
            self._histogram(b)
        elif self.params.mode == "average":
            self._average(b)
        else:
            self._finish(b, "write", "manual.comp", {}, {})

    def _histogram(self, b: Builder) -> None:
        p = self.params
        histogram = b.buffer("histogram", BINS * 4)
        b.clear("clear", histogram, 0)
        b.compute(
            "count",
            b.program("histogram.comp", defines={"STRIDE": p.stride}),
            self._tiles(b),
            bind={"u_color": sample(b.input("color")), "Histogram": update_buffer(histogram)},
            uniforms={"u_min_ev": p.min_ev, "u_max_ev": p.max_ev},
        )
        uniforms = {"u_min_ev": p.min_ev, "u_max_ev": p.max_ev, "u_low": p.low, "u_high": p.high}
        self._finish(b, "reduce", "reduce_histogram.comp", {"Histogram": read_buffer(histogram)}, uniforms)

    def _average(self, b: Builder) -> None:
        p = self.params
        tiles = self._tiles(b)
        count = tiles[0] * tiles[1]
        partials = b.buffer("partials", count * PARTIAL_BYTES)
        b.compute(
            "sum",
            b.program("average.comp", defines={"STRIDE": p.stride}),
            tiles,
            bind={"u_color": sample(b.input("color")), "Partials": write_buffer(partials)},
            uniforms={"u_min_ev": p.min_ev, "u_max_ev": p.max_ev},
        )
        self._finish(b, "reduce", "reduce_average.comp", {"Partials": read_buffer(partials)}, {"u_partials": count})

    def _finish(self, b: Builder, step: str, shader: str, bind: dict[str, Binding], uniforms: dict[str, float]) -> None:
        """The last dispatch, which adapts from the previous exposure and writes the new one."""
        p = self.params
        adapts = "previous" in b.inputs and p.mode != "manual"
        bind = {**bind, "ExposureOutput": write_buffer(b.output("exposure"))}
        uniforms = {**uniforms, "u_compensation": p.compensation}
        if adapts:
            bind["ExposurePrevious"] = read_buffer(b.input("previous"))
            uniforms |= {"u_brighten": p.brighten, "u_darken": p.darken}
        b.compute(step, b.program(shader, defines={"ADAPTS": adapts}), (1, 1, 1), bind=bind, uniforms=uniforms)

    def _tiles(self, b: Builder) -> tuple[int, int, int]:
        reach = TILE * self.params.stride
        return b.groups(b.input("color"), (reach, reach))
