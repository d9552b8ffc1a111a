"""Materials at points of triangles, in float64: textures bilinear at their first mip level, factors, normal maps.

glTF 2.0, section 3.9 and appendix B; KHR_texture_transform. Shares no code with shaders/surface.glsl: wrap modes act on
texel indices (OpenGL 4.5, table 8.20) instead of coordinates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rendergraph.measure.truth.decode import srgb_decode
from rendergraph.scene.gpu_layout import mirrored, normal_matrix
from rendergraph.scene.scene import F64, Alpha, Scene, TextureUse, Wrap
from rendergraph.scene.texture_arrays import place_textures, resample

Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]


class Textures:
    """A scene's textures as uploaded, their first mip levels alone, in linear values. Decoded when first sampled."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._placement = place_textures(scene)
        self._texels: dict[int, F64] = {}

    def size(self, use: TextureUse) -> int:
        """Texels a side, of the layer that the image was stretched to."""
        place = self._placement.ref(use.image)
        return self._placement.arrays[place[0]].size if place else 1

    def sample(self, use: TextureUse, uv: F64) -> F64:
        """Bilinear rgba float64[n, 4], sRGB decoded before filtering, at ``uv`` float64[n, 2] of the mesh."""
        texels = self._level(use)
        size = texels.shape[0]
        position = transformed(use, uv) * size - 0.5
        corner = np.floor(position)
        share = position - corner
        result = np.zeros((len(uv), 4))
        for right in (0, 1):
            for down in (0, 1):
                column = _wrapped(corner[:, 0].astype(np.int64) + right, size, use.wrap[0])
                row = _wrapped(corner[:, 1].astype(np.int64) + down, size, use.wrap[1])
                weight = (share[:, 0] if right else 1.0 - share[:, 0]) * (share[:, 1] if down else 1.0 - share[:, 1])
                result += weight[:, None] * texels[row, column]
        return result

    def _level(self, use: TextureUse) -> F64:
        if use.image not in self._texels:
            image = self._scene.images[use.image]
            values = resample(image.pixels, self.size(use), image.srgb) / 255.0
            if image.srgb:
                values[..., :3] = srgb_decode(values[..., :3])
            self._texels[use.image] = values
        return self._texels[use.image]


def transformed(use: TextureUse, uv: F64) -> F64:
    """KHR_texture_transform of coordinates float64[n, 2]: scale, turn counter-clockwise in the image, move."""
    c, s = np.cos(use.rotation), np.sin(use.rotation)
    return np.asarray(uv * np.array(use.scale) @ np.array([[c, s], [-s, c]]).T + np.array(use.offset))


def _wrapped(index: Ints, size: int, mode: Wrap) -> Ints:
    if mode is Wrap.CLAMP:
        return np.clip(index, 0, size - 1)
    if mode is Wrap.MIRROR:
        folded = index % (2 * size)
        return np.where(folded < size, folded, 2 * size - 1 - folded)
    return index % size


def interpolate(values: npt.NDArray[np.float32], vertices: Ints, barycentric: F64) -> F64:
    """A vertex attribute float32[v, k] at points of triangles, float64[n, k]."""
    return np.asarray(np.einsum("nck,nc->nk", values[vertices].astype(np.float64), barycentric))


def coordinates(scene: Scene, use: TextureUse, vertices: Ints, barycentric: F64) -> F64:
    """The texture coordinates that a texture use names, before its transform, float64[n, 2]."""
    return interpolate(scene.uv1 if use.uv_set == 1 else scene.uv0, vertices, barycentric)


def is_cut_out(scene: Scene, textures: Textures, material: Ints, vertices: Ints, barycentric: F64) -> Bools:
    """Whether points of alpha-tested materials lie where the base colour's alpha is below the cutoff, bool[n]."""
    cut = np.zeros(len(material), dtype=bool)
    for index in np.unique(material):
        rows = np.nonzero(material == index)[0]
        found = scene.materials[index]
        alpha = found.base_color[3] * interpolate(scene.colors, vertices[rows], barycentric[rows])[:, 3]
        if found.base_color_texture is not None:
            uv = coordinates(scene, found.base_color_texture, vertices[rows], barycentric[rows])
            alpha = alpha * textures.sample(found.base_color_texture, uv)[:, 3]
        cut[rows] = (found.alpha is Alpha.MASKED) & (alpha < found.alpha_cutoff)
    return cut


@dataclass(frozen=True, slots=True)
class Shading:
    """What light needs of points: ``normal`` unit, world, on the viewer's side of double-sided materials,
    ``base_color`` and ``emissive`` linear, all float64[n, 3]; ``alpha``, perceptual ``roughness``, ``metallic``,
    ``occlusion`` float64[n]; ``unlit`` bool[n].
    """

    normal: F64
    base_color: F64
    alpha: F64
    roughness: F64
    metallic: F64
    occlusion: F64
    emissive: F64
    unlit: Bools


def shade_inputs(
    scene: Scene, textures: Textures, instance: Ints, material: Ints, vertices: Ints, barycentric: F64, front: Bools
) -> Shading:
    """Materials at points of triangles: int64[n] instance and material, int64[n, 3] vertices, float64[n, 3] weights."""
    count = len(material)
    out = Shading(
        normal=np.zeros((count, 3)), base_color=np.zeros((count, 3)), alpha=np.ones(count), roughness=np.zeros(count),
        metallic=np.zeros(count), occlusion=np.ones(count), emissive=np.zeros((count, 3)),
        unlit=np.zeros(count, dtype=bool),
    )  # fmt: skip
    for index in np.unique(material):
        rows = np.nonzero(material == index)[0]
        found = scene.materials[index]

        def texel(use: TextureUse | None, rows: Ints = rows) -> F64:
            if use is None:
                return np.ones((len(rows), 4))
            return textures.sample(use, coordinates(scene, use, vertices[rows], barycentric[rows]))

        color = np.array(found.base_color) * interpolate(scene.colors, vertices[rows], barycentric[rows])
        color = color * texel(found.base_color_texture)
        packed = texel(found.metallic_roughness_texture)
        out.base_color[rows], out.alpha[rows] = color[:, :3], color[:, 3]
        out.roughness[rows] = np.clip(found.roughness * packed[:, 1], 0.0, 1.0)
        out.metallic[rows] = np.clip(found.metallic * packed[:, 2], 0.0, 1.0)
        out.occlusion[rows] = 1.0 + found.occlusion_strength * (texel(found.occlusion_texture)[:, 0] - 1.0)
        out.emissive[rows] = np.array(found.emissive) * texel(found.emissive_texture)[:, :3]
        out.unlit[rows] = found.unlit
        lean = None
        if found.normal_texture is not None:
            lean = (texel(found.normal_texture)[:, :3] * 2.0 - 1.0) * (found.normal_scale, found.normal_scale, 1.0)
        normal = shading_normal(scene, instance[rows], vertices[rows], barycentric[rows], lean)
        out.normal[rows] = np.where((found.double_sided & ~front[rows])[:, None], -normal, normal)
    return out


def shading_normal(scene: Scene, instance: Ints, vertices: Ints, barycentric: F64, lean: F64 | None) -> F64:
    """World-space unit normals float64[n, 3] of the vertices' normals, tilted by a normal map's ``lean`` (-1..1).

    Normals and tangents are unit at the vertices, then interpolated as they are: the frame of MikkTSpace.
    """
    normal, tangent, side = np.zeros((len(instance), 3)), np.zeros((len(instance), 3)), np.ones(len(instance))
    for index in np.unique(instance):
        rows = np.nonzero(instance == index)[0]
        world = scene.instances[index].world
        normals = _unit(scene.normals[vertices[rows]].astype(np.float64) @ normal_matrix(world).T)
        normal[rows] = np.einsum("nck,nc->nk", normals, barycentric[rows])
        tangents = _unit(scene.tangents[vertices[rows]][..., :3].astype(np.float64) @ world[:3, :3].T)
        tangent[rows] = np.einsum("nck,nc->nk", tangents, barycentric[rows])
        handed = interpolate(scene.tangents[:, 3:], vertices[rows], barycentric[rows])[:, 0]
        side[rows] = np.where((-handed if mirrored(world) else handed) < 0.0, -1.0, 1.0)
    flat = _unit(normal)
    flat[np.abs(flat).max(axis=1) == 0.0] = (0.0, 1.0, 0.0)
    if lean is None:
        return flat
    bitangent = np.cross(normal, tangent) * side[:, None]
    tilted = _unit(tangent * lean[:, :1] + bitangent * lean[:, 1:2] + normal * lean[:, 2:3])
    usable = (np.sum(tangent * tangent, axis=1) > 1e-20) & (np.abs(tilted).max(axis=1) > 0.0)
    return np.where(usable[:, None], tilted, flat)


def _unit(v: F64) -> F64:
    largest = np.abs(v).max(axis=-1, keepdims=True)
    scaled = np.divide(v, largest, out=np.zeros_like(v), where=largest > 0.0)
    length = np.linalg.norm(scaled, axis=-1, keepdims=True)
    return np.asarray(np.divide(scaled, length, out=np.zeros_like(v), where=length > 0.0))
