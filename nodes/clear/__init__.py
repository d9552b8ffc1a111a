"""Sets a texture or buffer to one value."""

from __future__ import annotations

from rendergraph.document.formats import FORMATS
from rendergraph.node.builder import Builder
from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob
from rendergraph.node.reference import Extreme, Measure, Quantity, Reference
from rendergraph.node.user_shader import Color, misuse
from rendergraph.plan.graph import BufferDesc

EXTREMES = (
    Extreme("largest_word", "All bits set.", ("passes.zero.set.value=4294967295",)),
    Extreme("one_word", "A buffer of one word beyond its readers'.", ("resources.bins.bytes=260",)),
    Extreme("negative_word", "No word.", ("passes.zero.set.value=-1",), refused="RG225"),
    Extreme("part_of_a_word", "No word either.", ("passes.zero.set.value=0.5",), refused="RG225"),
    Extreme("word_too_large", "One more than a word holds.", ("passes.zero.set.value=4294967296",), refused="RG225"),
)


class ClearParams(Params):
    """The value."""

    value: int | float | Color = knob(
        0,
        "Four numbers, or one for all channels. For depth: a distance, 0 near to 1 far. For a buffer: a 32-bit word.",
    )
    stencil: int = knob(0, "Value of the stencil, where the format has one.", ge=0, le=255, accurate="neither")


class Clear(Node[ClearParams]):
    """Sets a whole texture, all levels and layers, or a whole buffer to one value."""

    outputs = {
        "target": Port(
            "What is set.",
            formats=("rgba8", *sorted(FORMATS.keys() - {"rgba8"})),
            buffer=True,
            samples=(1, 2, 4, 8),
            layers=None,
        ),
    }
    exact = True
    reference = Reference(
        "analytic",
        {
            "target": Measure(
                Quantity.SCALAR, "max", 0.0, "The value, as the format holds it, in every texel or word.", unit="steps"
            )
        },
        source="OpenGL 4.5, 8.21 and 2.3.5",
    )
    extremes = EXTREMES

    def build(self, b: Builder) -> None:
        """One clear."""
        target, desc, value = b.output("target"), b.outputs["target"].desc, self.params.value
        if isinstance(desc, BufferDesc):
            if not isinstance(value, int) or not 0 <= value < 1 << 32:
                raise misuse(
                    b, f"{value} is no 32-bit word", "a buffer is filled with one whole number, 0 to 4294967295"
                )
            b.clear("clear", target, value)
            return
        texel = value if isinstance(value, tuple) else (float(value),) * 4
        if FORMATS[desc.format].depth:
            if isinstance(value, tuple) or not 0 <= value <= 1:
                raise misuse(b, f"{value} is no distance", "depth is cleared to one number, 0 (near) to 1 (far)")
            distance = 1.0 - value if b.frame.depth == "reversed" else float(value)
            texel = (distance, float(self.params.stencil), 0.0, 0.0)
        b.clear("clear", target, texel)
