"""The conformance suite: what every node must show before it is done."""
