"""Author render graphs in YAML, run them headless on OpenGL, and measure time, bytes and error per pass."""

__version__ = "0.1.0"
