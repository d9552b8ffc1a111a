"""A pause of Python's cyclic garbage collector while a document or a plan is built."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def collector_paused() -> Iterator[None]:
    """No cyclic collection inside; afterwards the collector is as it was, whatever was raised.

    Loading and planning make many small objects that all stay, in data without cycles. The collector starts as soon as
    enough of them are new, walks what there is, frees nothing, and so costs more a pass the larger the graph (at 10,000
    passes more than the planning). Reference counting goes on, and anything cyclic goes with the next collection.

    May be nested, and used by several threads at once: only who found the collector on switches it on again.
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
