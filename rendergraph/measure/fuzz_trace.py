"""Where two runs of a graph part: back along the flow of data from an output that differs, to who made the difference.

Both runs are traced first, with a digest of every resource right before and right after each sub-pass that touches it;
then the two are run once more to look at the one resource, which may be large.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from rendergraph.device import enums
from rendergraph.device.buffers import read_buffer
from rendergraph.device.textures import read_texture
from rendergraph.measure.fuzz_run import FuzzCase, TestBed
from rendergraph.plan.graph import BufferDesc, Kind, SubPass
from rendergraph.plan.plan import Plan
from rendergraph.run.runner import Runner

Reason = Literal["left_unwritten", "writes_differ", "overwritten", "runs_only_here", "read_too_early", "not_found"]
Texels = list[npt.NDArray[Any]]


@dataclass(frozen=True, slots=True)
class Culprit:
    """The first difference that matters. ``left_unwritten``: the sub-pass says it writes the resource whole, and left
    this texel; ``writes_differ``: what it read was equal, what it wrote is not; ``overwritten``: it changed a resource
    of others (``by`` is its own) that was still needed; ``runs_only_here``: the usual plan lacks it;
    ``read_too_early``: it reads what nothing has written yet.

    ``expected`` and ``found`` are the texel's channels, or a buffer's word (``x`` counts words).
    """

    reason: Reason
    frame: int
    subpass: str = ""
    resource: str = ""
    by: str = ""
    mip: int = 0
    layer: int = 0
    x: int = 0
    y: int = 0
    expected: tuple[float, ...] = ()
    found: tuple[float, ...] = ()
    differing: int = 0
    texels: int = 0
    buffer: bool = False

    @property
    def pass_name(self) -> str:
        """The pass of the sub-pass."""
        return self.subpass.partition(".")[0]


@dataclass(frozen=True, slots=True)
class Trace:
    """Digests of a run by frame, sub-pass, ``before`` or ``after``, and resource."""

    plan: Plan
    digests: dict[tuple[int, str, str, str], bytes]


def find_culprit(bed: TestBed, usual: FuzzCase, case: FuzzCase, output: str, frame: int) -> Culprit:
    """Who made an output of ``case`` differ in a frame from that of ``usual``."""
    expected, found = trace(bed, usual, frame), trace(bed, case, frame)
    blamed = _blame(expected, found, output, frame)
    if blamed.reason in ("runs_only_here", "read_too_early", "not_found"):
        return blamed
    return _look(bed, usual, case, blamed)


def trace(bed: TestBed, case: FuzzCase, last: int) -> Trace:
    """Run frames 0 to ``last``, with digests."""
    plan = bed.plan(case)
    digests: dict[tuple[int, str, str, str], bytes] = {}
    with bed.runner(case) as runner:
        for frame in range(last + 1):
            for command in runner.commands_of(frame):
                command.run_poisoning()
                names = sorted({access.resource for access in command.subpass.accesses})
                for name in names:
                    digests[frame, command.subpass.name, "before", name] = _digest(contents(bed, runner, name, frame))
                command.run_work()
                for name in names:
                    digests[frame, command.subpass.name, "after", name] = _digest(contents(bed, runner, name, frame))
    return Trace(plan, digests)


def contents(bed: TestBed, runner: Runner, name: str, frame: int) -> Texels:
    """Every level of a texture as ``[layers, h, w, c]``, or a buffer as ``[uint32[1, 1, words, 1]]``."""
    bed.device.gl.glMemoryBarrier(enums.ALL_BARRIER_BITS)
    storage = runner.storage
    if not storage.is_texture(name):
        words = np.frombuffer(read_buffer(bed.device, storage.buffer(name, frame)), np.uint32)
        return [words.reshape(1, 1, -1, 1)]
    texture = storage.texture(name, frame)
    levels = [read_texture(bed.device, texture, mip) for mip in range(texture.desc.mips)]
    return [level if level.ndim == 4 else level[None] for level in levels]


def _digest(texels: Texels) -> bytes:
    digest = hashlib.blake2b(digest_size=16)
    for level in texels:
        digest.update(np.ascontiguousarray(level).data)
    return digest.digest()


# ---------------------------------------------------------------- whom to blame


def _blame(expected: Trace, found: Trace, output: str, frame: int) -> Culprit:
    plan, usual = found.plan, {step.name for step in expected.plan.order}

    def differs(*key: Any) -> bool:
        alike = key[3] in expected.plan.graph.resources and (
            expected.plan.graph.resources[key[3]].desc == plan.graph.resources[key[3]].desc
        )
        return alike and key in expected.digests and expected.digests[key] != found.digests[key]

    resource, position = output, len(plan.order)
    while frame >= 0:
        at = _last_writer(plan, resource, position)
        kind = plan.graph.resources[resource].kind
        if at is None and kind is Kind.TRANSIENT and position < len(plan.order):
            return Culprit("read_too_early", frame, plan.order[position].name, resource)
        if at is None:  # what a history shows, or what is kept, is from the frame before
            frame, position = frame - 1, len(plan.order)
            resource = plan.graph.resources[resource].previous_of or resource
            continue
        step = plan.order[at]
        if step.name not in usual:
            return Culprit("runs_only_here", frame, step.name, resource)
        if not differs(frame, step.name, "after", resource):
            reader = plan.order[position].name if position < len(plan.order) else ""
            return (
                _overwriter(plan, resource, step.name, reader, frame)
                or _overwriter(expected.plan, resource, step.name, reader, frame)
                or Culprit("not_found", frame, step.name, resource)
            )
        loaded = [a.resource for a in step.accesses if a.load and differs(frame, step.name, "before", a.resource)]
        if not loaded:
            return Culprit("writes_differ", frame, step.name, resource)
        resource, position = loaded[0], at
    return Culprit("not_found", 0)


def _last_writer(plan: Plan, resource: str, position: int) -> int | None:
    return next((at for at in reversed(range(position)) if _writes(plan.order[at], resource)), None)


def _writes(step: SubPass, resource: str) -> bool:
    return any(access.resource == resource and access.usage.writes for access in step.accesses)


def _overwriter(plan: Plan, resource: str, writer: str, reader: str, frame: int) -> Culprit | None:
    """Who, between a resource's writer and its reader, wrote into memory that it shares under a plan."""
    names = [step.name for step in plan.order]
    end = names.index(reader) if reader in names else len(names)
    for at in range(names.index(writer) + 1 if writer in names else 0, end):
        for access in plan.order[at].accesses:
            if access.usage.writes and access.resource != resource and _share(plan, resource, access.resource):
                return Culprit("overwritten", frame, plan.order[at].name, resource, access.resource)
    return None


def _share(plan: Plan, one: str, other: str) -> bool:
    if isinstance(plan.graph.resources[one].desc, BufferDesc):
        a, b = plan.buffer_of.get(one), plan.buffer_of.get(other)
        return a is not None and b is not None and a.offset < b.offset + b.bytes and b.offset < a.offset + a.bytes
    return one in plan.slot_of and plan.slot_of[one] == plan.slot_of.get(other)


# ---------------------------------------------------------------- which texel


def _look(bed: TestBed, usual: FuzzCase, case: FuzzCase, blamed: Culprit) -> Culprit:
    """The culprit with its first texel that differs, bottom row first."""
    # In the usual run nobody overwrites: there the content stays what it was until then.
    expected_before, expected = _around(bed, usual, blamed)
    before, found = _around(bed, case, blamed)
    total = sum(level[..., 0].size for level in found)
    differing = [_unlike(a, b) for a, b in zip(expected, found, strict=True)]
    mip = next((mip for mip, places in enumerate(differing) if places.any()), None)
    if mip is None:
        return blamed
    layer, y, x = (int(v) for v in np.argwhere(differing[mip])[0])
    untouched = all(not _unlike(a[mip], b[mip])[layer, y, x] for a, b in ((expected_before, expected), (before, found)))
    return Culprit(
        "left_unwritten" if blamed.reason == "writes_differ" and untouched else blamed.reason,
        blamed.frame,
        blamed.subpass,
        blamed.resource,
        blamed.by,
        mip,
        layer,
        x,
        y,
        _values(expected[mip][layer, y, x]),
        _values(found[mip][layer, y, x]),
        sum(int(places.sum()) for places in differing),
        total,
        isinstance(bed.plan(case).graph.resources[blamed.resource].desc, BufferDesc),
    )


def _around(bed: TestBed, case: FuzzCase, blamed: Culprit) -> tuple[Texels, Texels]:
    """The blamed resource right before and right after the blamed sub-pass."""
    with bed.runner(case) as runner:
        for frame in range(blamed.frame):
            runner.run_frame(frame)
        for command in runner.commands_of(blamed.frame):
            if command.subpass.name == blamed.subpass:
                command.run_poisoning()
                before = contents(bed, runner, blamed.resource, blamed.frame)
                command.run_work()
                return before, contents(bed, runner, blamed.resource, blamed.frame)
            command.run()
    raise AssertionError(f"{blamed.subpass} does not run")


def _unlike(one: npt.NDArray[Any], other: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """Which texels differ in any bit, ``bool[layers, h, w]``: NaN equals itself, and -0 is not 0."""
    width = {1: np.uint8, 2: np.uint16, 4: np.uint32}[one.dtype.itemsize]
    a, b = (np.ascontiguousarray(values).view(width) for values in (one, other))
    unlike: npt.NDArray[np.bool_] = (a != b).any(axis=-1)
    return unlike


def _values(texel: npt.NDArray[Any]) -> tuple[float, ...]:
    return tuple(float(v) for v in texel)
