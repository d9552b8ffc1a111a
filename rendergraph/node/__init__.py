"""The node contract: ports, parameters, the sub-pass builder, and discovery."""

from rendergraph.node.contract import Node, Port
from rendergraph.node.params import Params, knob

__all__ = ["Node", "Params", "Port", "knob"]
