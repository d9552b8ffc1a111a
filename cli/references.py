"""What `rg render --reference` does once the frames are rendered: judge passes, with the cache of truths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rendergraph.device.context import Device
    from rendergraph.document.load import Document
    from rendergraph.document.messages import Diagnostic
    from rendergraph.measure.truth.accuracy import PassAccuracy
    from rendergraph.report.html import ErrorGallery
    from rendergraph.run.plan_document import PlannedDocument
    from rendergraph.run.render import Progress


class Judging:
    """The passes to judge, and in ``passes`` and ``notes`` what came of it; ``errors`` collects pictures for the page.

    Raises RenderGraphError RG746 for a name that is no pass, before anything is rendered.
    """

    def __init__(self, document: Document, names: Sequence[str], errors: ErrorGallery | None) -> None:
        from rendergraph.measure.truth.accuracy import require_passes

        require_passes(document, names)
        self._document = document
        self._names = tuple(names)
        self._show = errors.add if errors is not None else lambda judged: None
        self.progress: Progress = lambda stage, done, total: None
        self.passes: tuple[PassAccuracy, ...] = ()
        self.notes: list[Diagnostic] = []

    def judge(self, planned: PlannedDocument, device: Device) -> None:
        """Judge them."""
        from rendergraph.document.messages import diagnose
        from rendergraph.measure.truth.accuracy import judge_graph
        from rendergraph.measure.truth.cache import open_cache

        cache = open_cache()
        if cache is None:
            self.notes.append(diagnose("RG745", reason="platformdirs is not installed"))
        self.passes = judge_graph(
            self._document, planned, device, self._names, cache=cache, show=self._show, progress=self.progress
        )
