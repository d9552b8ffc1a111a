"""Runs a graph with the outputs of some passes replaced by their truths: what the rest makes of perfect inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from rendergraph.device import enums
from rendergraph.device.context import Device
from rendergraph.device.texels import transfer
from rendergraph.device.textures import upload_texture
from rendergraph.document.formats import FORMATS, Channel
from rendergraph.document.load import Document
from rendergraph.measure.truth.accuracy import RootedInput, rooted, run_content
from rendergraph.measure.truth.cache import TruthCache
from rendergraph.measure.truth.decode import F64
from rendergraph.measure.truth.judge import recall_truths
from rendergraph.measure.truth.observe import Content, content, supersampled, watch_frame
from rendergraph.measure.truth.storage import held, srgb_encode
from rendergraph.node.discovery import find_node
from rendergraph.node.reference import Measure, PassRun, Truth
from rendergraph.plan.graph import Kind, TextureDesc
from rendergraph.plan.plan import PlanOptions
from rendergraph.run.plan_document import PlannedDocument, plan_document
from rendergraph.run.render import frame_cameras
from rendergraph.run.runner import Runner
from rendergraph.run.scene_store import SceneStore

Texels = npt.NDArray[Any]


@dataclass(frozen=True, slots=True)
class Replaced:
    """``images``: the graph's output textures after its last frame, float64[h, w, c] by name; ``measures``: by the pass
    replaced, the measures whose truths stood in; passes for which none can are absent.
    """

    images: Mapping[str, F64]
    measures: Mapping[str, tuple[str, ...]]


def ideal_measures(document: Document, name: str) -> dict[str, Measure]:
    """The measures of a pass whose truth is what its technique approximates, and judges an output as it stands."""
    node = find_node(document.model.passes[name].node)
    if node.reference is None or node.exact or not node.reference.ideal:
        return {}
    ports = document.model.passes[name].write
    return {key: m for key, m in node.reference.measures.items() if m.ideal and m.port in ports}


def replace_outputs(
    document: Document,
    planned: PlannedDocument,
    device: Device,
    passes: Sequence[str],
    *,
    cache: TruthCache | None = None,
    store: SceneStore | None = None,
    frame: int | None = None,
) -> Replaced:
    """Run the graph's frames up to ``frame`` (by default the file's last) with the named passes' truths written over
    their outputs, right behind each pass.

    A later pass's truth is computed from what the earlier ones' truths make of its inputs. Texels whose truth is not
    known, and channels that it does not tell, stay as the pass left them.

    :raises RenderGraphError: for every error of the run and of the references.
    """
    last = planned.plan.graph.frame.count - 1 if frame is None else frame
    return _Substitution(document, planned, device, tuple(passes), last, cache, store).run()


@dataclass(slots=True)
class _Substitution:
    document: Document
    planned: PlannedDocument
    device: Device
    passes: tuple[str, ...]
    last: int
    cache: TruthCache | None
    store: SceneStore | None
    #: What is written where: by frame and position in the plan's order, textures and their texels.
    uploads: dict[tuple[int, int], list[tuple[str, Texels]]] = field(default_factory=dict)
    measures: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def run(self) -> Replaced:
        self._learn()
        plan, index = self.planned.plan, self.last
        with _Playing(self) as runner:
            self._play(runner, index, "")
            images = {
                name: np.asarray(content(runner, self.planned, name, index), np.float64)
                for name in plan.graph.outputs
                if runner.storage.is_texture(name)
            }
        return Replaced(images, self.measures)

    def input_of(self, name: str, port: str) -> Content:
        """What a pass reads in the last frame when the passes before it are replaced."""
        self._learn()
        with _Playing(self) as runner:
            return self._play(runner, self.last, name)[name].inputs[port]

    def _learn(self) -> None:
        """Find every truth, in the order of execution. Only what a pass left in earlier frames needs theirs."""
        plan = self.planned.plan
        ran = list(dict.fromkeys(subpass.parent for subpass in plan.order))
        remembers = any(plan.graph.resources[name].kind is Kind.HISTORY for name in plan.lifetimes)
        root = run_content(self.planned, self.device)
        for index in range(self.last + 1) if remembers else (self.last,):
            before: list[str] = []
            for name in (name for name in ran if name in self.passes and ideal_measures(self.document, name)):
                with _Playing(self) as runner:
                    seen = self._play(runner, index, name)[name]
                self._take(name, self._beneath(name, rooted(seen, root), tuple(before), root), index)
                before.append(name)

    def _play(self, runner: Runner, index: int, watched: str) -> dict[str, PassRun]:
        """Frames up to ``index`` with all that is known by now written over what the passes made."""
        remembers = len({number for number, _ in self.uploads}) > 1 or runner.storage.parities > 1
        for frame in range(index if remembers else 0):
            self._frame(runner, frame, "")
        return self._frame(runner, index, watched)

    def _frame(self, runner: Runner, index: int, watched: str) -> dict[str, PassRun]:
        def upload(position: int) -> None:
            for resource, texels in self.uploads.get((index, position), ()):
                # What shaders stored must be there before it is overwritten.
                self.device.gl.glMemoryBarrier(enums.ALL_BARRIER_BITS)
                upload_texture(self.device, runner.storage.texture(resource, index), texels)

        names = {watched} if watched else set()
        return watch_frame(runner, self.document, self.planned, self.device, names, index, upload)

    def _take(self, name: str, run: PassRun, index: int) -> None:
        """Work out what to write over the outputs of a pass."""
        node = find_node(self.document.model.passes[name].node)
        assert node.reference is not None
        truths = recall_truths(name, node, node.reference, run, self.cache)[0].truths
        parents = [subpass.parent for subpass in self.planned.plan.order]
        position = len(parents) - 1 - parents[::-1].index(name)
        used = []
        for key, measure in ideal_measures(self.document, name).items():
            resource = self.document.model.passes[name].write[measure.port]
            desc = run.descs.get(measure.port)
            if resource not in self.planned.plan.lifetimes or not isinstance(desc, TextureDesc):
                continue
            values = composited(truths[key], run.outputs[measure.port], desc)
            if values is not None:
                self.uploads.setdefault((index, position), []).append((resource, encode(values, desc.format)))
                used.append(key)
        if used:
            self.measures[name] = tuple(used)

    def _beneath(self, name: str, run: PassRun, before: tuple[str, ...], root: str) -> PassRun:
        """The run, its supersampled inputs made by the earlier passes' truths too; by the rendered passes where those
        truths are traced: rays through every sample take minutes.
        """
        quick = tuple(p for p in before if p in self.measures and not self._traced(p))
        if run.supersampled is None or not quick:
            return run

        def larger(port: str, factor: int) -> F64:
            plain = supersampled(self.document, self.planned, self.device, name, port, factor)  # refuses what must be
            frame = self.planned.plan.graph.frame
            size = (frame.width * factor, frame.height * factor)
            planned = plan_document(self.document, PlanOptions(), size=size, frames=frame.count)
            planned = replace(planned, scene=self.planned.scene)
            inside = _Substitution(self.document, planned, self.device, quick, self.last, self.cache, self.store)
            h, w, c = plain.shape
            samples = np.asarray(inside.input_of(name, port), np.float64).reshape(h, factor, w, factor, c)
            return np.asarray(samples.mean(axis=(1, 3)))

        content = f"{root} {run.index} beneath {quick}"
        return replace(run, supersampled=RootedInput(larger, content))

    def _traced(self, name: str) -> bool:
        reference = find_node(self.document.model.passes[name].node).reference
        return reference is not None and reference.method == "rays"


class _Playing:
    """A runner that is ready, and released in the end; each playing starts from empty histories."""

    def __init__(self, of: _Substitution) -> None:
        scene = of.planned.scene.scene if of.planned.scene else None
        self._runner = Runner(of.device, of.planned.plan, scene, frame_cameras(of.planned), store=of.store)

    def __enter__(self) -> Runner:
        try:
            self._runner.prepare()
        except BaseException:
            self._runner.release()
            raise
        return self._runner

    def __exit__(self, *ended: object) -> None:
        self._runner.release()


def composited(truth: Truth, output: Content, desc: TextureDesc) -> F64 | None:
    """The output with the truth wherever it is known, float64[h, w, c]; None where the truth is about something that is
    not the output's own texels.
    """
    if output.ndim != 3 or desc.mips > 1 or desc.samples > 1:
        return None
    value = np.asarray(truth.value, np.float64)
    channels = value.shape[-1]
    if value.ndim != 3 or value.shape[:2] != output.shape[:2] or channels > output.shape[2]:
        return None
    if truth.judged is not None and not np.array_equal(truth.judged, output[..., :channels], equal_nan=True):
        return None
    known = np.ones(value.shape[:2], bool) if truth.mask is None else truth.mask
    result = np.array(output, np.float64)
    result[known, :channels] = value[known]
    return result


def encode(values: F64, format: str) -> Texels:
    """Numbers as texels of a format, as :func:`rendergraph.device.textures.upload_texture` takes them: the inverse of
    :func:`rendergraph.measure.truth.decode.decode`, rounded to nearest, beyond the range to its ends.
    """
    row, layout = FORMATS[format], transfer(format)
    dtype = np.dtype(layout.dtype)
    stored = held(format, values)
    if row.srgb:
        stored[..., :3] = srgb_encode(stored[..., :3])
    if np.issubdtype(dtype, np.integer):
        most = np.iinfo(dtype)
        scale = 1 if row.channel in (Channel.UINT, Channel.INT) else most.max
        stored = np.clip(np.rint(np.nan_to_num(stored * scale)), most.min, most.max)
    return np.ascontiguousarray(stored.astype(dtype))
