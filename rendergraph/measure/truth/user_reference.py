"""The truth of a user's own shader: Python beside it, ``<stem>_reference.py``, with ``judge(run)``.

The file is run when a pass is judged, which happens only where somebody asks for it (``rg render --reference``); see
docs/accuracy_user_shaders.md.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path, PurePosixPath
from traceback import extract_tb
from types import ModuleType
from typing import Any, Final

import numpy as np

from rendergraph.document.messages import RenderGraphError, diagnose
from rendergraph.measure.truth.shares import as_shares
from rendergraph.measure.truth.storage import held, storage_error
from rendergraph.node.reference import PassRun, Truth
from rendergraph.plan.graph import TextureDesc

#: What float32 arithmetic may add to what the output's format rounds, in units of the value or of 1, whichever is more.
ARITHMETIC: Final = 2e-5


def reference_file(run: PassRun, shader: str | None) -> Path | None:
    """The file that tells the truth of a shader named in a graph, None where there is none.

    :raises RenderGraphError: RG729 where it lies, by way of a link, outside the graph's folder.
    """
    if run.folder is None or shader is None:
        return None
    relative = PurePosixPath(shader)
    path = run.folder / relative.parent / f"{relative.stem}_reference.py"
    if not path.is_file():
        return None
    if not path.resolve().is_relative_to(run.folder.resolve()):
        raise _unusable(path, "it lies outside the graph's folder")
    return path


def why_unknown(run: PassRun, shader: str | None) -> str:
    """Why the truth of a shader is not known; empty where it is."""
    if reference_file(run, shader) is not None:
        return ""
    if shader is None:
        return "no shader of the user's is drawn with"
    stem = PurePosixPath(shader).stem
    return f"the truth of a user's shader is not known: {stem}_reference.py beside {shader} would tell it"


def user_truths(run: PassRun, shader: str | None) -> Mapping[str, Truth]:
    """A truth for every output, those that the file does not speak of known nowhere.

    Without a tolerance of its own, a texel may err by what its format rounds and :data:`ARITHMETIC`; both sides are
    given as shares of that. Whole numbers and words are exact.

    :raises RenderGraphError: RG728 without a file, RG729 where it fails or gives no truths of the outputs.
    """
    path = reference_file(run, shader)
    if path is None:
        raise RenderGraphError([diagnose("RG728", shader=shader or "", file=_file_name(shader))])
    given = _call(path, _load(path), "judge", run)
    if not isinstance(given, Mapping) or not all(isinstance(truth, Truth) for truth in given.values()):
        raise _unusable(path, "judge(run) must give a mapping of outputs to Truth")
    for port in given:
        if port not in run.outputs:
            raise _unusable(path, f"judge(run) speaks of '{port}', the outputs are {', '.join(run.outputs)}")
    return {port: _settled(path, run, port, given.get(port)) for port in run.outputs}


def user_invariants(run: PassRun, shader: str | None) -> Iterable[str]:
    """Sentences of the file's ``invariants(run)``, where it has any. Raises RenderGraphError RG729."""
    path = reference_file(run, shader)
    module = _load(path) if path is not None else None
    if path is None or not hasattr(module, "invariants"):
        return ()
    return [str(sentence) for sentence in _call(path, module, "invariants", run)]


def _settled(path: Path, run: PassRun, port: str, truth: Truth | None) -> Truth:
    desc, content = run.descs[port], np.asarray(run.outputs[port], np.float64)
    judged = content if content.ndim > 1 else content.reshape(1, -1, 1)
    if truth is None:
        return Truth(judged, judged=judged, mask=np.zeros(judged.shape[:-1], bool))
    value = np.asarray(truth.value, np.float64)
    judged = judged if truth.judged is None else np.asarray(truth.judged, np.float64)
    if value.shape != judged.shape:
        raise _unusable(path, f"the truth of '{port}' has shape {list(value.shape)}, the output {list(judged.shape)}")
    if truth.tolerance is not None:
        return Truth(value, judged, truth.mask, truth.standard_error, truth.tolerance)
    allowed = np.zeros_like(value)
    if isinstance(desc, TextureDesc):
        value = held(desc.format, value)
        allowed = storage_error(desc.format, value)
        if allowed.any() or not _whole(desc):
            allowed = allowed + ARITHMETIC * np.maximum(1.0, np.abs(np.nan_to_num(value, posinf=0.0, neginf=0.0)))
    shared, shared_value, tolerance = as_shares(judged, value, allowed)
    return Truth(shared_value, shared, truth.mask, 0.0, tolerance)


def _whole(desc: TextureDesc) -> bool:
    from rendergraph.document.formats import FORMATS, Channel

    return FORMATS[desc.format].channel in (Channel.UINT, Channel.INT)


def _load(path: Path) -> ModuleType:
    """The file, run as a module of its own that nothing else can import, and that leaves no compiled file behind."""
    module = ModuleType(path.stem)
    module.__file__ = str(path)
    try:
        exec(compile(path.read_text(encoding="utf-8"), str(path), "exec"), module.__dict__)
    except Exception as error:  # somebody's code, which may fail in any way
        raise _unusable(path, _said(path, error)) from error
    if not callable(getattr(module, "judge", None)):
        raise _unusable(path, "it defines no function judge(run)")
    return module


def _call(path: Path, module: ModuleType | None, name: str, run: PassRun) -> Any:
    function: Callable[[PassRun], Any] = getattr(module, name)
    try:
        result = function(run)
        return result if isinstance(result, Mapping) else list(result)
    except RenderGraphError:
        raise
    except Exception as error:  # somebody's code, which may fail in any way
        raise _unusable(path, f"{name}(run): {_said(path, error)}") from error


def _said(path: Path, error: Exception) -> str:
    """The error, with the line of the user's file that it comes from."""
    lines = [frame.lineno for frame in extract_tb(error.__traceback__) if frame.filename == str(path)]
    line = error.lineno if isinstance(error, SyntaxError) else lines[-1] if lines else None
    return f"{type(error).__name__}: {error}" + (
        f" (line {line})" if line and not isinstance(error, SyntaxError) else ""
    )


def _file_name(shader: str | None) -> str:
    return f"{PurePosixPath(shader).stem}_reference.py" if shader else "a file"


def _unusable(path: Path, reason: str) -> RenderGraphError:
    return RenderGraphError([diagnose("RG729", file=path.name, reason=reason)])
