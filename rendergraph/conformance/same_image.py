"""Demands `poison`, `sharing` and `specialisation`: what must not matter does not change a bit of any output."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rendergraph.conformance.demand import Note, Shortfall
from rendergraph.conformance.subject import MOST_FRAMES, SIZE, Subject
from rendergraph.device.texels import POISONS
from rendergraph.measure.fuzz import first_difference
from rendergraph.measure.fuzz_report import blame
from rendergraph.measure.fuzz_run import USUAL, FuzzCase, TestBed
from rendergraph.measure.fuzz_trace import find_culprit


def check_poison(subject: Subject) -> Iterator[Shortfall | Note]:
    """Transients that hold NaN, infinities or 1000 before their first use."""
    yield from _vary(subject, "depends_on_poison", [FuzzCase(poison=poison) for poison in POISONS])


def check_sharing(subject: Subject) -> Iterator[Shortfall | Note]:
    """Every transient with memory of its own, poisoned too: a neighbour's leftovers are another poison."""
    yield from _vary(subject, "depends_on_sharing", [FuzzCase(alias=False), FuzzCase(alias=False, poison="nan")])


def check_specialisation(subject: Subject) -> Iterator[Shortfall | Note]:
    """Nothing specialised to what the scene holds and the cameras see (`--full`)."""
    yield from _vary(subject, "depends_on_specialisation", [FuzzCase(full=True)])


def _vary(subject: Subject, reason: str, cases: Sequence[FuzzCase]) -> Iterator[Shortfall | Note]:
    document = subject.shrunk
    frames = min(MOST_FRAMES, document.model.frame.count)
    with TestBed(document, subject.device, SIZE, frames).closed() as bed:
        expected = bed.images(USUAL)
        if first_difference(bed, USUAL, expected) is not None:
            yield Shortfall("not_repeatable", "two equal runs give different images")
            return
        for case in cases:
            found = first_difference(bed, case, expected)
            if found is None:
                continue
            output, frame, error = found
            varied = ", ".join(f"{name}={getattr(case, name)}" for name in case.varied)
            if error:
                yield Shortfall("fails", f"with {varied} the graph does not run: {error}")
            else:
                culprit = find_culprit(bed, USUAL, case, output, frame)
                yield Shortfall(reason, f"with {varied} {output} differs in frame {frame}: {blame(culprit)}")
            return
    yield Note(f"{len(cases)} variations of {frames} frames of {SIZE[0]}x{SIZE[1]}")
