"""The $name node."""

from rendergraph.document.formats import REAL
from rendergraph.node import Node, Params, Port, knob
from rendergraph.node.bindings import color, sample
from rendergraph.node.builder import Builder


class ${class_name}Params(Params):
    """Parameters of $name: each is checked in YAML, shown by `rg nodes $name`, and overridden by --set."""

    strength: float = knob(1.0, "How much of the effect is applied.", ge=0, le=1)


class $class_name(Node[${class_name}Params]):
    """Turns a picture grey."""

    inputs = {"color": Port("The picture.", formats=tuple(sorted(REAL)))}
    outputs = {"color": Port("The result.", formats=("rgba8", *sorted(REAL - {"rgba8"})), like="color")}

    def build(self, b: Builder) -> None:
        """One full-screen draw."""
        b.raster(
            "apply",
            b.program("$name.frag"),
            color=[color(b.output("color"))],
            bind={"u_color": sample(b.input("color"))},
            uniforms={"u_strength": self.params.strength},
        )
