"""A scene on the CPU: one vertex pool, one index buffer, instances, materials, textures, lights, cameras."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Protocol

import numpy as np
import numpy.typing as npt

from rendergraph.scene.features import SceneFeatures

F32 = npt.NDArray[np.float32]
F64 = npt.NDArray[np.float64]
U32 = npt.NDArray[np.uint32]


class Alpha(IntEnum):
    """How a material's alpha is used; the order of the draw queues."""

    OPAQUE = 0
    MASKED = 1
    BLENDED = 2


class Wrap(IntEnum):
    """Texture addressing."""

    REPEAT = 0
    CLAMP = 1
    MIRROR = 2


@dataclass(frozen=True, slots=True)
class TextureUse:
    """A material's reference to an image: index into ``Scene.images``, UV set, addressing, KHR_texture_transform."""

    image: int
    uv_set: int = 0
    wrap: tuple[Wrap, Wrap] = (Wrap.REPEAT, Wrap.REPEAT)
    offset: tuple[float, float] = (0.0, 0.0)
    scale: tuple[float, float] = (1.0, 1.0)
    rotation: float = 0.0  # radians

    @property
    def transformed(self) -> bool:
        """Whether KHR_texture_transform changes the coordinates."""
        return (self.offset, self.scale, self.rotation) != ((0.0, 0.0), (1.0, 1.0), 0.0)


@dataclass(frozen=True, slots=True)
class Material:
    """A glTF metallic-roughness material. Factors are linear."""

    name: str = ""
    base_color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    metallic: float = 1.0
    roughness: float = 1.0
    emissive: tuple[float, float, float] = (0.0, 0.0, 0.0)  # strength multiplied in
    alpha: Alpha = Alpha.OPAQUE
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    unlit: bool = False
    normal_scale: float = 1.0
    occlusion_strength: float = 1.0
    base_color_texture: TextureUse | None = None  # sRGB
    metallic_roughness_texture: TextureUse | None = None  # g roughness, b metallic
    normal_texture: TextureUse | None = None
    occlusion_texture: TextureUse | None = None  # r
    emissive_texture: TextureUse | None = None  # sRGB

    @property
    def textures(self) -> tuple[TextureUse | None, ...]:
        """The five slots, in the order of ``Material.textures`` in shaders/scene.glsl."""
        return (
            self.base_color_texture,
            self.metallic_roughness_texture,
            self.normal_texture,
            self.occlusion_texture,
            self.emissive_texture,
        )


class PixelSource(Protocol):
    """An image not decoded yet: its size is known, its pixels come on demand."""

    @property
    def width(self) -> int: ...

    @property
    def height(self) -> int: ...

    def decode(self) -> npt.NDArray[np.uint8]:
        """``uint8[height, width, 4]``; ``RenderGraphError`` RG613 when the file is corrupt."""
        ...


class Image:
    """8-bit RGBA pixels, first row on top, ``uint8[height, width, 4]``. ``srgb``: colour, decoded when sampled.

    Made from pixels, or from a source that decodes them when they are first asked for.
    """

    __slots__ = ("_pixels", "height", "name", "srgb", "width")

    def __init__(self, pixels: npt.NDArray[np.uint8] | PixelSource, srgb: bool, name: str = "") -> None:
        self._pixels = pixels
        self.srgb = srgb
        self.name = name
        if isinstance(pixels, np.ndarray):
            self.height, self.width = int(pixels.shape[0]), int(pixels.shape[1])
        else:
            self.height, self.width = pixels.height, pixels.width

    @property
    def pixels(self) -> npt.NDArray[np.uint8]:
        """The pixels, decoded at most once. ``RenderGraphError`` RG613 when the file is corrupt."""
        if not isinstance(self._pixels, np.ndarray):
            self._pixels = self._pixels.decode()
        return self._pixels


@dataclass(frozen=True, slots=True)
class Mesh:
    """A run of triangles in the pool: ``first_index``, ``index_count`` into ``Scene.indices``; object-space bounds."""

    first_index: int
    index_count: int
    base_vertex: int
    material: int
    bounds_min: tuple[float, float, float]
    bounds_max: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Instance:
    """A mesh placed in the world. ``world``: ``float64[4, 4]`` object to world."""

    mesh: int
    world: F64
    name: str = ""
    skin: int | None = None


@dataclass(frozen=True, slots=True)
class Camera:
    """A perspective camera. ``fov`` is vertical, radians; ``far`` ``None`` for infinity."""

    position: tuple[float, float, float]
    target: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    fov: float = 1.0471975511965976
    near: float = 0.05
    far: float | None = None
    name: str = ""
    node: str = ""  # name of the scene file's node that holds it


@dataclass(frozen=True, slots=True)
class Sun:
    """A directional light: unit vector the light travels along, irradiance (rgb) on a facing surface."""

    direction: tuple[float, float, float]
    irradiance: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Ambient:
    """Constant hemisphere radiance."""

    sky: tuple[float, float, float]
    ground: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Light:
    """A point light, or a spot when ``outer`` (half angle, radians) is given."""

    position: tuple[float, float, float]
    intensity: tuple[float, float, float]  # rgb radiant intensity
    radius: float
    axis: tuple[float, float, float] = (0.0, -1.0, 0.0)
    inner: float = 0.0
    outer: float | None = None
    circle: float = 0.0  # metres: radius of the level circle it runs around `position`; negative for clockwise
    phase: float = 0.0  # turns: where on the circle it starts

    def position_at(self, turn: float) -> tuple[float, float, float]:
        """World position after ``turn`` of a circle (0 at the first frame), metres; ``position`` for a fixed light."""
        angle = 2.0 * math.pi * (math.copysign(turn, self.circle) + self.phase)
        x, y, z = self.position
        reach = abs(self.circle)
        return (x + reach * math.cos(angle), y, z + reach * math.sin(angle)) if reach else self.position


@dataclass(frozen=True, slots=True)
class Node:
    """A node of the scene file's hierarchy, which skins and animations refer to by index. ``local``: ``float64[4, 4]``
    node to parent at rest; ``parent`` -1 for a root. ``translation``, ``rotation`` (quaternion xyzw) and ``scale``
    are what animation replaces; a node given as a matrix cannot be animated and has them at identity.
    """

    name: str
    parent: int
    local: F64
    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)


@dataclass(frozen=True, slots=True)
class Skin:
    """Joint nodes (indices into ``Scene.nodes``) and inverse bind matrices, kept for later."""

    joints: tuple[int, ...]
    inverse_bind: F32  # float32[joints, 4, 4]


@dataclass(frozen=True, slots=True)
class AnimationChannel:
    """Keyframes of one node's property: ``times`` float32[k] in seconds, ``values`` float32[k, n]."""

    node: int
    path: str  # translation | rotation | scale | weights
    interpolation: str
    times: F32
    values: F32


@dataclass(frozen=True, slots=True)
class Animation:
    """A named clip."""

    name: str
    channels: tuple[AnimationChannel, ...]


@dataclass(slots=True)
class Scene:
    """Geometry and everything placed in it.

    Vertex arrays share the first axis: positions float32[n, 3] metres (object space), normals float32[n, 3] unit,
    tangents float32[n, 4] (w: sign of the bitangent), uv0/uv1 float32[n, 2], colors float32[n, 4] linear;
    joints uint16[n, 4] and weights float32[n, 4] when skinned. ``indices`` uint32[m], relative to ``base_vertex``.
    """

    name: str
    positions: F32
    normals: F32
    tangents: F32
    uv0: F32
    uv1: F32
    colors: F32
    indices: U32
    meshes: list[Mesh]
    instances: list[Instance]
    materials: list[Material]
    images: list[Image] = field(default_factory=list)
    cameras: list[Camera] = field(default_factory=list)
    lights: list[Light] = field(default_factory=list)
    sun: Sun | None = None
    ambient: Ambient | None = None
    joints: npt.NDArray[np.uint16] | None = None
    weights: F32 | None = None
    nodes: list[Node] = field(default_factory=list)
    skins: list[Skin] = field(default_factory=list)
    animations: list[Animation] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @property
    def triangles(self) -> int:
        """Triangles drawn: of every instance of every mesh."""
        return sum(self.meshes[i.mesh].index_count for i in self.instances) // 3

    def bounds(self) -> tuple[F64, F64]:
        """World-space box of all instances' boxes, ``float64[3]`` each; zeros for an empty scene."""
        corners = []
        for instance in self.instances:
            mesh = self.meshes[instance.mesh]
            box = np.array([mesh.bounds_min, mesh.bounds_max])
            points = np.array([[box[x, 0], box[y, 1], box[z, 2], 1.0] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
            corners.append((points @ instance.world.T)[:, :3])
        if not corners:
            return np.zeros(3), np.zeros(3)
        stacked = np.concatenate(corners)
        return stacked.min(axis=0), stacked.max(axis=0)

    def features(self) -> SceneFeatures:
        """The feature set, from the materials that instances really use."""
        from rendergraph.scene.texture_arrays import place_textures  # it imports this module

        used = [self.materials[self.meshes[i.mesh].material] for i in self.instances]
        textures = [texture for material in used for texture in material.textures if texture is not None]
        arrays = len(place_textures(self).arrays)
        return SceneFeatures(
            opaque=any(m.alpha is Alpha.OPAQUE for m in used),
            masked=any(m.alpha is Alpha.MASKED for m in used),
            blended=any(m.alpha is Alpha.BLENDED for m in used),
            double_sided=any(m.double_sided for m in used),
            unlit=any(m.unlit for m in used),
            emissive=any(any(m.emissive) for m in used),
            normal_mapped=any(m.normal_texture is not None for m in used),
            occlusion_mapped=any(m.occlusion_texture is not None for m in used),
            textured=arrays > 0,
            texture_transforms=any(t.transformed for t in textures),
            texture_wraps=any(wrap is not Wrap.REPEAT for t in textures for wrap in t.wrap),
            second_uv=any(t.uv_set == 1 for t in textures),
            vertex_colors=bool((self.colors != 1.0).any()),
            skinned=any(i.skin is not None for i in self.instances),
            sun=self.sun is not None and any(self.sun.irradiance),
            ambient=self.ambient is not None and any((*self.ambient.sky, *self.ambient.ground)),
            point_lights=sum(light.outer is None for light in self.lights),
            spot_lights=sum(light.outer is not None for light in self.lights),
            triangles=self.triangles,
            draws=len(self.instances),
            materials=len(self.materials),
            texture_arrays=arrays,
            texture_slots=sum(1 << slot for slot in range(5) if any(m.textures[slot] is not None for m in used)),
        )
