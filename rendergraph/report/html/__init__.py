"""The page people look at: one self-contained HTML file of a plan, or of a run with its times and targets."""

from rendergraph.report.html.accuracy import ErrorGallery
from rendergraph.report.html.page import html_page, write_page
from rendergraph.report.html.targets import TargetGallery

__all__ = ["ErrorGallery", "TargetGallery", "html_page", "write_page"]
