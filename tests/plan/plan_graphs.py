"""Small graphs by hand and random ones by hypothesis, built as ``Graph`` objects with no document behind them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from hypothesis import strategies as st

from rendergraph.plan.graph import (
    Access,
    BarrierIntent,
    BufferDesc,
    ClearResource,
    Frame,
    Fullscreen,
    Graph,
    Kind,
    Pass,
    Position,
    Resource,
    SubPass,
    Target,
    TextureDesc,
    Usage,
)


def texture(format: str = "rgba8", size: int = 16, layers: int = 1, mips: int = 1, samples: int = 1) -> TextureDesc:
    """A square texture."""
    target = Target.D2_ARRAY if layers > 1 else Target.D2
    return TextureDesc(format, size, size, layers, mips, samples, target)


def reads(resource: str, usage: str = "sampled", mip: int | None = None, layer: int | None = None) -> Access:
    """An access that loads."""
    return Access(resource, Usage(usage), mip=mip, layer=layer)


def writes(resource: str, usage: str = "color", mip: int | None = None, layer: int | None = None) -> Access:
    """An access that replaces everything."""
    return Access(resource, Usage(usage), load=False, mip=mip, layer=layer)


def adds(resource: str, usage: str = "color", mip: int | None = None) -> Access:
    """An access that keeps what was there."""
    return Access(resource, Usage(usage), load=True, mip=mip)


def make_pass(
    name: str, *steps: Sequence[Access], after: Sequence[str] = (), keep: bool = False, line: int = 1
) -> Pass:
    """A pass whose sub-passes are called ``name.0``, ``name.1``, ..."""
    at = Position("graph.yaml", line, 3)
    subpasses = tuple(SubPass(f"{name}.{i}", name, tuple(s), Fullscreen(), position=at) for i, s in enumerate(steps))
    return Pass(name, "toy", subpasses, tuple(after), keep, at)


def make_graph(
    passes: Sequence[Pass],
    outputs: Sequence[str],
    *,
    descs: dict[str, TextureDesc | BufferDesc] | None = None,
    history: dict[str, str] | None = None,
    kinds: dict[str, Kind] | None = None,
    barriers: Sequence[tuple[str, str, str, str]] | None = None,
) -> Graph:
    """A graph over all resources that its passes name: 16x16 rgba8 textures unless ``descs`` says otherwise.

    Outputs and sources of history are persistent, as expansion makes them.
    """
    descs, history, kinds = descs or {}, history or {}, kinds or {}
    names = {a.resource for p in passes for s in p.subpasses for a in s.accesses} | {
        *outputs,
        *history,
        *history.values(),
        *descs,
    }
    resources = {}
    for name in names:
        kind = Kind.PERSISTENT if name in outputs or name in history.values() else Kind.TRANSIENT
        kind = Kind.HISTORY if name in history else kinds.get(name, kind)
        desc = descs.get(history.get(name, name), texture())
        resources[name] = Resource(name, desc, kind, history.get(name))
    intents = None if barriers is None else tuple(BarrierIntent(*b) for b in barriers)
    return Graph(Frame(16, 16), resources, {p.name: p for p in passes}, tuple(outputs), intents)


# ---------------------------------------------------------------- random graphs

_COLOR = ("rgba8", "r32f", "rg16f", "srgb8_a8", "rgba16f")
_TEXTURE_READS = ("sampled", "sampled", "image_read", "copy_from")
_BUFFER_READS = ("storage_read", "uniform", "indirect", "vertex", "index", "copy_from", "host_read")
_TEXTURE_WRITES = ("color", "color", "image_write", "copy_to", "clear")
_BUFFER_WRITES = ("storage_write", "copy_to", "clear")


@dataclass
class _Growing:
    """A graph in the making: passes are added in an order that is one legal order."""

    passes: list[Pass] = field(default_factory=list)
    descs: dict[str, TextureDesc | BufferDesc] = field(default_factory=dict)
    users: dict[str, list[str]] = field(default_factory=dict)  # passes that touched a resource
    writers: dict[str, list[str]] = field(default_factory=dict)


@st.composite
def graphs(draw: st.DrawFn, max_passes: int = 9, explicit: bool | None = None) -> Graph:
    """A random graph: textures and buffers of several classes, stores, atomics, mips, layers, modifiers, feedback,
    history, kept passes and dead ends.

    ``explicit``: every writer waits by ``after`` for all earlier users of what it changes, so the order of the
    ``passes`` mapping is the one meaning of the graph. Otherwise it only waits for earlier writers, and the planner may
    find a reader to see later content (or a circle).
    """
    stated = draw(st.booleans()) if explicit is None else explicit
    grown = _Growing()
    history: dict[str, str] = {}
    for number in range(draw(st.integers(1, max_passes))):
        name = f"p{draw(st.integers(0, 99)):02}_{number}"
        steps: list[list[Access]] = []
        after: set[str] = set()
        local: list[str] = []
        for _ in range(draw(st.integers(1, 3))):
            steps += _step(draw, grown, name, local, after, history, stated)
        grown.passes.append(make_pass(name, *steps, after=sorted(after - {name}), keep=draw(st.integers(0, 9)) == 0))
    touched = sorted(grown.writers)
    outputs = draw(st.lists(st.sampled_from(touched), min_size=1, max_size=2, unique=True))
    used = {a.resource for p in grown.passes for s in p.subpasses for a in s.accesses}
    kept = {name: source for name, source in history.items() if name in used}
    kinds = {name: Kind.TRANSIENT for name in outputs if name not in kept.values() and draw(st.booleans())}
    return make_graph(grown.passes, outputs, descs=grown.descs, history=kept, kinds=kinds)


def _step(
    draw: st.DrawFn,
    grown: _Growing,
    name: str,
    local: list[str],
    after: set[str],
    history: dict[str, str],
    stated: bool,
) -> list[list[Access]]:
    """One sub-pass: some reads, and a new, changed or replaced resource."""
    accesses: list[Access] = []
    known = sorted(grown.writers)
    for resource in draw(st.lists(st.sampled_from(known), max_size=3, unique=True)) if known else []:
        accesses.append(_read(draw, grown, resource))
        grown.users[resource].append(name)
    if known and draw(st.integers(0, 5)) == 0:
        source = draw(st.sampled_from(known))
        history.setdefault(f"last_{source}", source)
        grown.descs.setdefault(f"last_{source}", grown.descs[source])
        accesses.append(_read(draw, grown, f"last_{source}"))
    choice = draw(st.sampled_from(["new", "new", "new", "add", "replace"]))
    if choice == "new" or not known:
        target = f"{name}.r{len(local)}"
        local.append(target)
        grown.descs[target] = _desc(draw)
        grown.users[target], grown.writers[target] = [], []
    else:
        target = draw(st.sampled_from(known))
        after.update(grown.users[target] if stated else [], grown.writers[target])
    desc = grown.descs[target]
    grown.users[target].append(name)
    grown.writers[target].append(name)
    accesses = [a for a in accesses if a.resource != target]
    if choice == "add" and known:
        return [[*accesses, *_add(draw, desc, target)]]
    return _define(draw, desc, target, accesses)


def _desc(draw: st.DrawFn) -> TextureDesc | BufferDesc:
    shape = draw(
        st.sampled_from(["plain", "plain", "plain", "mips", "layers", "depth", "multisampled", "buffer", "buffer"])
    )
    size = draw(st.sampled_from([8, 16]))
    match shape:
        case "buffer":
            return BufferDesc(draw(st.sampled_from([64, 320, 1024])))
        case "depth":
            return texture("d32f", size)
        case "multisampled":
            return texture("rgba8", size, samples=4)
        case _:
            format = draw(st.sampled_from(_COLOR))
            return texture(format, size, layers=2 if shape == "layers" else 1, mips=3 if shape == "mips" else 1)


def _spot(draw: st.DrawFn, desc: TextureDesc | BufferDesc) -> tuple[int | None, int | None]:
    if isinstance(desc, BufferDesc):
        return None, None
    mip = draw(st.sampled_from([None, *range(desc.mips)])) if desc.mips > 1 else None
    layer = draw(st.sampled_from([None, *range(desc.layers)])) if desc.layers > 1 else None
    return mip, layer


def _read(draw: st.DrawFn, grown: _Growing, resource: str) -> Access:
    desc = grown.descs[resource]
    usage = draw(st.sampled_from(_BUFFER_READS if isinstance(desc, BufferDesc) else _TEXTURE_READS))
    if isinstance(desc, TextureDesc) and desc.format == "d32f":
        usage = draw(st.sampled_from(["sampled", "depth_read"]))
    return reads(resource, usage, *_spot(draw, desc))


def _add(draw: st.DrawFn, desc: TextureDesc | BufferDesc, target: str) -> list[Access]:
    if isinstance(desc, BufferDesc):
        return [adds(target, draw(st.sampled_from(["storage_update", "storage_write"])))]
    mip, layer = _spot(draw, desc)
    if desc.format == "d32f":
        return [Access(target, Usage.DEPTH, mip=mip, layer=layer)]
    usage = draw(st.sampled_from(["color", "color", "image_update", "image_write"]))
    added = Access(target, Usage(usage), mip=mip, layer=layer)
    if usage == "color" and draw(st.booleans()):
        return [reads(target, "sampled", mip, layer), added]  # feedback
    return [added]


def _define(draw: st.DrawFn, desc: TextureDesc | BufferDesc, target: str, accesses: list[Access]) -> list[list[Access]]:
    """Replace everything, in one sub-pass or mip by mip (each level read by the next)."""
    if isinstance(desc, BufferDesc):
        return [[*accesses, writes(target, draw(st.sampled_from(_BUFFER_WRITES)))]]
    if desc.format == "d32f":
        return [[*accesses, writes(target, draw(st.sampled_from(["depth", "clear"])))]]
    usage = draw(st.sampled_from(_TEXTURE_WRITES))
    if desc.mips > 1 and draw(st.booleans()):
        chain = [[reads(target, "sampled", mip=m - 1), writes(target, usage, mip=m)] for m in range(1, desc.mips)]
        return [[*accesses, writes(target, usage, mip=0)], *chain]
    return [[*accesses, writes(target, usage)]]


def clear_step(name: str, resource: str) -> SubPass:
    """A sub-pass that clears, as the builder makes it."""
    return SubPass(f"{name}.clear", name, (writes(resource, "clear"),), ClearResource(resource))
