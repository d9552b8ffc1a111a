"""How a node is judged: what its outputs should have been, by code that shares nothing with its shaders.

A node names its truth with ``reference = Reference(...)`` and computes it in ``nodes/<node>/reference.py``:

    def judge(run: PassRun) -> Mapping[str, Truth]      # one entry for each of Reference.measures

and may check what must hold whatever the truth is:

    def invariants(run: PassRun) -> Iterable[str]       # a sentence for each that is broken

No numpy here: the module is imported with every node.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    import numpy.typing as npt

    from rendergraph.node.params import Params
    from rendergraph.plan.graph import BufferDesc, Frame, TextureDesc
    from rendergraph.scene.scene import Camera, Scene

    F64 = npt.NDArray[np.float64]
    Words = npt.NDArray[np.uint32]


class Quantity(StrEnum):
    """What an image's numbers mean, which decides how two of them are compared (measure/metrics)."""

    DISPLAY = "display"  #: encoded colour in 0..1, as a screen takes it: FLIP, SSIM, PSNR
    RADIANCE = "radiance"  #: linear light without an upper bound: relative MSE, HDR-FLIP
    NORMAL = "normal"  #: unit vectors xyz: degrees between them
    DEPTH = "depth"  #: stored depth: distance in units in the last place of float32, and absolute
    SHARE = "share"  #: 0..1 of something: visibility, occlusion, coverage, a material's factors
    IDENTITY = "identity"  #: whole numbers that name something: rate of mismatches
    SCALAR = "scalar"  #: any other number: absolute and relative differences


@dataclass(frozen=True, slots=True)
class Measure:
    """One thing that a reference judges. ``metric`` is a name of the quantity's metrics (``max``, ``mean``, ``rmse``,
    ``p99``, ...) and ``tolerance`` the node's stated error: the metric's largest value at default parameters, on the
    node's own graph; :class:`Truth` may state another for other parameters or formats. ``port`` is the output judged,
    empty where the reference derives what it compares.
    """

    quantity: Quantity
    metric: str
    tolerance: float
    help: str
    port: str = ""
    unit: str = ""
    ideal: bool = True  # False: of an algorithm's implementation, where the reference's other measures are ideal


@dataclass(frozen=True, slots=True)
class Reference:
    """A node's truth. ``method``: ``analytic`` (closed form), ``float64`` (the same definition in double precision),
    ``rays`` (traced on the CPU), ``brute_force`` (the same integral by many samples, with its own standard error).
    ``stochastic`` nodes are judged by a z-test over pixels. ``ideal`` tells the truth that a technique approximates
    (traced shadows) from the truth about an algorithm's implementation (the same filter in float64): only an ideal one
    can be set against speed.
    """

    method: Literal["analytic", "float64", "rays", "brute_force"]
    measures: Mapping[str, Measure]
    source: str = ""
    stochastic: bool = False
    ideal: bool = True


@dataclass(frozen=True, slots=True)
class Truth:
    """What a measure should have been.

    ``value`` and ``judged`` are float64[h, w, c], rows bottom-up; without ``judged`` the output port's own pixels are
    judged. ``mask`` bool[h, w] is True where the truth is known (None: everywhere). ``standard_error`` float64[h, w, c]
    (or one number) is the truth's own. ``tolerance`` replaces the measure's.
    """

    value: F64
    judged: F64 | None = None
    mask: npt.NDArray[np.bool_] | None = None
    standard_error: F64 | float = 0.0
    tolerance: float | None = None


@dataclass(frozen=True, slots=True)
class PassRun:
    """One run of one pass: all that its reference may look at.

    Textures are float64[h, w, c] with the values a shader would read (normalised formats in 0..1 or -1..1, sRGB
    decoded), rows bottom-up, ``[layers, h, w, c]`` for arrays; buffers are uint32[words]. ``inputs`` and ``before``
    (the outputs that are modified) are taken right before the pass, ``outputs`` right after. ``descs`` describe the
    resource behind each connected port.
    """

    params: Params
    inputs: Mapping[str, F64 | Words]
    outputs: Mapping[str, F64 | Words]
    descs: Mapping[str, TextureDesc | BufferDesc]
    frame: Frame
    before: Mapping[str, F64 | Words] = field(default_factory=dict)
    index: int = 0  # of the frame
    folder: Path | None = None  # the graph file's
    #: Of outputs with mip levels, the levels below the first; of outputs with a stencil, float64[h, w, 1].
    levels: Mapping[str, tuple[F64, ...]] = field(default_factory=dict)
    stencils: Mapping[str, F64] = field(default_factory=dict)
    scene: Scene | None = None
    camera: Camera | None = None
    #: An input texture rendered at ``factor`` times the frame's size and averaged back: ``supersampled(port, factor)``.
    supersampled: Callable[[str, int], F64] | None = None
    #: What rays hit (measure/truth/surfaces.py), made when first asked for; needs the extra ``reference``.
    trace: Callable[[], Any] | None = None


@dataclass(frozen=True, slots=True)
class Extreme:
    """A case that a node must survive: overrides as ``--set`` takes them, on the node's own graph. ``refused`` is the
    code of the error that must come instead of a picture; ``skips`` are checks left out, each with its reason.
    """

    name: str
    help: str
    overrides: tuple[str, ...] = ()
    refused: str = ""
    skips: Mapping[str, str] = field(default_factory=dict)
