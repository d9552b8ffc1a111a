"""Runs a pass and its truth side by side: observation, decoding, traced surfaces, judging, the cache."""
