"""Records of a run: times, lifetimes and memory, as JSON and as tables."""
