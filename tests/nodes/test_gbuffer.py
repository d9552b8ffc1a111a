"""The G-buffer: packings over the sphere, depth back to positions, and surfaces as the materials say."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from scene_render import Quad, quad_scene, render_scene
from shader_function import run_shader_function

from rendergraph.device.context import Device
from rendergraph.document.formats import FORMATS, Channel
from rendergraph.document.load import load_document
from rendergraph.nodes.gbuffer import reference
from rendergraph.nodes.gbuffer.packing import NORMAL_FORMATS, normal_defines
from rendergraph.plan.graph import Frame
from rendergraph.run.frame_constants import camera_view, pack_frames
from rendergraph.run.render import RenderOptions, render_document
from rendergraph.scene.scene import Alpha, Camera, Image, Material, TextureUse, Wrap

if TYPE_CHECKING:
    from tests.conftest import Hardware

pytestmark = pytest.mark.gpu

# ---------------------------------------------------------------- normals

PACK = """\
#version 450
#include <packing.glsl>
layout(location = 0) out vec4 out_direction;
layout(location = 1) out vec4 out_packed;
void main() {
    // A spiral over the sphere, and at its first texels the axes and diagonals where packings fold.
    uint index = uint(gl_FragCoord.y) * 1024u + uint(gl_FragCoord.x);
    float z = 1.0 - 2.0 * (float(index) + 0.5) / 1048576.0;
    float angle = float(index) * 2.399963;
    vec3 n = vec3(sqrt(1.0 - z * z) * vec2(cos(angle), sin(angle)), z);
    if (index < 27u && index != 13u) {
        n = vec3(index % 3u, index / 3u % 3u, index / 9u) - 1.0;
    }
    n = normalize(n);
    out_direction = vec4(n, 0.0);
    out_packed = pack_normal(n);
}
"""
UNPACK = """\
#version 450
#include <packing.glsl>
uniform sampler2D u_packed;
layout(location = 0) out vec4 out_normal;
void main() {
    out_normal = vec4(unpack_normal(texelFetch(u_packed, ivec2(gl_FragCoord.xy), 0)), 0.0);
}
"""
GRAPH = """\
rendergraph: 1
frame: {{size: [1024, 1024]}}
resources:
  direction: {{format: rgba32f}}
  packed: {{format: {format}}}
  normal: {{format: rgba32f}}
passes:
  pack:
    node: fullscreen
    write: {{direction: direction, packed: packed}}
    set: {{shader: pack.frag, defines: {defines}}}
  unpack:
    node: fullscreen
    read: {{u_packed: packed}}
    write: {{normal: normal}}
    set: {{shader: unpack.frag, defines: {defines}}}
outputs: {{normal: {{file: normal.npy}}, direction: {{file: direction.npy}}}}
"""

#: Largest error in degrees; half floats may be truncated when written (llvmpipe does), which doubles theirs.
LIMITS = {
    "rg16": 0.005, "rg16_snorm": 0.005, "rgb10_a2": 0.1, "rg8": 0.96, "rg8_snorm": 0.96,
    "rgba8": 0.4, "rgba8_snorm": 0.4, "rg16f": 0.12, "rgba16f": 0.04, "rg32f": 1e-4, "rgba32f": 1e-4,
}  # fmt: skip


def packing_error(folder: Path, format: str, pack: str = PACK) -> np.ndarray:
    (folder / "pack.frag").write_text(pack)
    (folder / "unpack.frag").write_text(UNPACK)
    graph = folder / f"{format}.yaml"
    defines = "{" + ", ".join(f"{k}: {v}" for k, v in normal_defines(format).items()) + "}"
    graph.write_text(GRAPH.format(format=format, defines=defines))
    images = render_document(load_document(graph), RenderOptions(samples=1)).images
    truth, normal = (images[name][..., :3].reshape(-1, 3).astype(np.float64) for name in ("direction", "normal"))
    return reference.angle_degrees(truth, normal / np.linalg.norm(normal, axis=1, keepdims=True))


@pytest.mark.parametrize("format", NORMAL_FORMATS)
def test_normal_survives_its_format(device: Device, hardware: Hardware, tmp_path: Path, format: str) -> None:
    error = packing_error(tmp_path, format)
    normalised = FORMATS[format].channel in (Channel.UNORM, Channel.SNORM)
    assert error.max() < LIMITS[format] * (hardware.rounding / 0.5 if normalised else 1.0)
    if LIMITS[format] > 1e-3:
        assert error.max() > 0.5 * LIMITS[format]  # a test that measures the format, not nothing


AXES = PACK.replace("n = normalize(n);", "n = vec3(0.0); n[index % 3u] = (index & 1u) == 0u ? 1.0 : -1.0;")


def test_signed_formats_keep_the_axes_exactly(device: Device, tmp_path: Path) -> None:
    """Walls and floors: a signed format has a zero, an unsigned one does not (the twin)."""
    assert "n = vec3(0.0)" in AXES
    assert packing_error(tmp_path, "rg16_snorm", AXES).max() < 1e-5
    assert packing_error(tmp_path, "rg16", AXES).max() > 5e-4


def test_sign_of_zero_breaks_the_fold(device: Device, tmp_path: Path) -> None:
    """The twin of the octahedral test: with sign(0) = 0 the -z pole and the folded axes come out elsewhere."""
    bad = PACK.replace(
        "out_packed = pack_normal(n);",
        """
    vec3 p = n / (abs(n.x) + abs(n.y) + abs(n.z));
    out_packed = vec4((p.z >= 0.0 ? p.xy : (1.0 - abs(p.yx)) * sign(p.xy)) * 0.5 + 0.5, 0.0, 0.0);""",
    )
    assert packing_error(tmp_path, "rg16", bad).max() > 45.0


def test_octahedral_errors_in_float64_are_the_published_ones() -> None:
    directions = reference.sphere(1_000_000)
    for bits, limit in ((8, 0.945), (12, 0.0591), (16, 0.00367)):
        decoded = reference.octahedral_decode(reference.quantise_unorm(reference.octahedral_encode(directions), bits))
        assert reference.angle_degrees(directions, decoded).max() == pytest.approx(limit, rel=0.02)
    for bits, limit in ((8, 0.386), (10, 0.0960)):
        raw = reference.quantise_unorm(directions, bits)
        raw /= np.linalg.norm(raw, axis=1, keepdims=True)
        assert reference.angle_degrees(directions, raw).max() == pytest.approx(limit, rel=0.02)


def test_zero_vector_packs_to_a_direction(device: Device, tmp_path: Path) -> None:
    body = """
    vec3 n = unpack_normal(pack_normal(vec3(inputs[i], inputs[i + 1u], inputs[i + 2u])));
    outputs[o] = n.x; outputs[o + 1u] = n.y; outputs[o + 2u] = n.z;"""
    for format in ("rg16", "rgb10_a2"):
        result = run_shader_function(
            device, tmp_path, body, [[0.0, 0.0, 0.0]], 3, includes=("packing.glsl",), defines=normal_defines(format)
        )
        assert np.isfinite(result).all()


# ---------------------------------------------------------------- depth

DEPTH = """
    outputs[o] = view_z(inputs[i]);
    vec3 p = view_position(vec2(inputs[i + 1u], inputs[i + 2u]), inputs[i]);
    outputs[o + 1u] = p.x; outputs[o + 2u] = p.y; outputs[o + 3u] = p.z;"""


def depth_errors(device: Device, folder: Path, convention: str, far: float | None) -> np.ndarray:
    """Relative error of z between near and 1000 m, float32 depth in and out."""
    camera = Camera((0, 0, 0), (0, 0, -1), near=0.1, far=far)
    frame = Frame(640, 360, depth=convention)
    projection = camera_view(camera, frame).projection
    z = -np.geomspace(0.11, 999.0, 20_000)
    clip = projection @ np.stack([np.zeros_like(z), np.zeros_like(z), z, np.ones_like(z)])
    depth = (clip[2] / clip[3]).astype(np.float32)
    uv = np.random.default_rng(1).random((len(z), 2))
    result = run_shader_function(
        device, folder, DEPTH, np.column_stack([depth, uv]), 4, includes=("depth.glsl",),
        defines={"DEPTH_REVERSED": int(convention == "reversed")}, blocks={"Frame": pack_frames(frame, None, [camera])},
    )  # fmt: skip
    back = projection @ np.concatenate([result[:, 1:].astype(np.float64).T, np.ones((1, len(z)))])
    ndc = (back[:2] / back[3]).T
    assert np.abs(ndc - (uv * 2 - 1)).max() < 1e-5
    return np.abs(result[:, 0] / z - 1.0)


def test_depth_reconstruction_error(device: Device, tmp_path: Path) -> None:
    """Reversed depth holds 1e-6 at every distance; standard depth (the twin) loses it with the distance."""
    assert depth_errors(device, tmp_path, "reversed", None).max() < 1e-6
    assert depth_errors(device, tmp_path, "reversed", 1000.0).max() < 2e-6
    standard = depth_errors(device, tmp_path, "standard", 1000.0)
    assert standard.max() > 1e-4
    assert standard[:2000].max() < 1e-5
    assert depth_errors(device, tmp_path, "standard", None).max() < 2e-3


@pytest.mark.parametrize(("convention", "far"), [("reversed", None), ("standard", 100.0), ("standard", None)])
def test_cleared_depth_is_background_and_finite(
    device: Device, tmp_path: Path, convention: str, far: float | None
) -> None:
    cleared = 0.0 if convention == "reversed" else 1.0
    frame, camera = Frame(64, 64, depth=convention), Camera((0, 0, 0), (0, 0, -1), near=0.1, far=far)
    body = DEPTH.replace("outputs[o] = view_z(inputs[i]);", "outputs[o] = is_background(inputs[i]) ? 1.0 : 0.0;")
    result = run_shader_function(
        device, tmp_path, body, [[cleared, 0.5, 0.5], [0.5, 0.5, 0.5]], 4, includes=("depth.glsl",),
        defines={"DEPTH_REVERSED": int(convention == "reversed")}, blocks={"Frame": pack_frames(frame, None, [camera])},
    )  # fmt: skip
    assert np.isfinite(result).all()
    assert result[:, 0].tolist() == [1.0, 0.0]


# ---------------------------------------------------------------- surfaces

SURFACES = """\
rendergraph: 1
frame: {size: [64, 64]}
scene: {source: spheres}
resources:
  depth: {format: d32f}
  normal: {format: rgba32f}
  base_color: {format: rgba32f}
  material: {format: rgba32f}
  emissive: {format: rgba32f}
passes:
  fill:
    node: gbuffer
    write: {depth: depth, normal: normal, base_color: base_color, material: material, emissive: emissive}
    set: {prepass: PREPASS}
outputs:
  depth: {file: depth.npy}
  normal: {file: normal.npy}
  base_color: {file: base_color.npy}
  material: {file: material.npy}
  emissive: {file: emissive.npy}
"""
#: Looks at the square [-1, 1]^2 of the plane z = 0 so that it fills the frame exactly.
FACING = Camera((0, 0, 1), (0, 0, 0), fov=np.pi / 2, near=0.05)
SQUARE = Quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))
CENTRE = (32, 32)


def fill(
    device: Device,
    folder: Path,
    quads: list[Quad],
    *materials: Material,
    images: tuple[Image, ...] = (),
    prepass: str = "off",
):  # type: ignore[no-untyped-def]
    scene = quad_scene(quads, materials, images=images)
    return render_scene(device, folder, SURFACES.replace("PREPASS", prepass), scene, FACING).images


def test_factors_arrive(device: Device, tmp_path: Path) -> None:
    material = Material(base_color=(0.2, 0.4, 0.8, 1.0), metallic=0.25, roughness=0.75, emissive=(1.0, 2.0, 300.0))
    images = fill(device, tmp_path, [SQUARE], material)
    assert images["base_color"][CENTRE][:3] == pytest.approx((0.2, 0.4, 0.8), abs=1e-6)
    assert images["material"][CENTRE] == pytest.approx((0.75, 0.25, 1.0, 0.0), abs=1e-6)
    assert images["emissive"][CENTRE][:3] == pytest.approx((1.0, 2.0, 300.0))
    assert images["normal"][CENTRE][:3] == pytest.approx((0, 0, 1), abs=1e-6)
    assert images["depth"][CENTRE] == pytest.approx(0.05)  # near / distance


def test_scene_without_solid_surfaces_is_background(device: Device, tmp_path: Path) -> None:
    images = fill(device, tmp_path, [SQUARE], Material(alpha=Alpha.BLENDED, emissive=(1, 1, 1)))
    assert all((image == 0).all() for image in images.values())


def test_back_of_double_sided_surface_faces_the_viewer(device: Device, tmp_path: Path) -> None:
    away = Quad((-1, -1, 0), (0, 2, 0), (2, 0, 0))
    images = fill(device, tmp_path, [away], Material(double_sided=True))
    assert images["normal"][CENTRE][:3] == pytest.approx((0, 0, 1), abs=1e-6)
    culled = fill(device, tmp_path, [away], Material())
    assert (culled["depth"] == 0).all()


def test_mirrored_instance_keeps_its_side_and_its_normal_map(device: Device, tmp_path: Path) -> None:
    """A normal map that leans along +u leans along -x once the instance is mirrored in x; its front stays in front."""
    lean = Image(np.full((4, 4, 4), (230, 128, 205, 255), dtype=np.uint8), srgb=False)
    material = Material(normal_texture=TextureUse(0))
    plain = fill(device, tmp_path, [SQUARE], material, images=(lean,))["normal"][CENTRE]
    mirrored = fill(
        device,
        tmp_path,
        [Quad(SQUARE.corner, SQUARE.u, SQUARE.v, world=np.diag([-1.0, 1, 1, 1]))],
        material,
        images=(lean,),
    )
    expected = np.array([230, 128, 205]) / 255 * 2 - 1
    expected /= np.linalg.norm(expected)
    assert plain[:3] == pytest.approx(expected, abs=1e-3)
    assert mirrored["normal"][CENTRE][:3] == pytest.approx(expected * (-1, 1, 1), abs=1e-3)
    upward = Image(np.full((4, 4, 4), (128, 230, 205, 255), dtype=np.uint8), srgb=False)
    mirrored = fill(
        device,
        tmp_path,
        [Quad(SQUARE.corner, SQUARE.u, SQUARE.v, world=np.diag([-1.0, 1, 1, 1]))],
        material,
        images=(upward,),
    )
    assert mirrored["normal"][CENTRE][:3] == pytest.approx((-expected[1], expected[0], expected[2]), abs=1e-4)


def test_normal_map_strength_and_missing_tangents(device: Device, tmp_path: Path) -> None:
    lean = Image(np.full((4, 4, 4), (230, 128, 205, 255), dtype=np.uint8), srgb=False)
    flat = fill(device, tmp_path, [SQUARE], Material(normal_texture=TextureUse(0), normal_scale=0.0), images=(lean,))
    assert flat["normal"][CENTRE][:3] == pytest.approx((0, 0, 1), abs=1e-5)
    scene = quad_scene([SQUARE], [Material(normal_texture=TextureUse(0))], images=[lean])
    scene.tangents[:] = 0
    images = render_scene(device, tmp_path, SURFACES.replace("PREPASS", "off"), scene, FACING).images
    assert images["normal"][CENTRE][:3] == pytest.approx((0, 0, 1), abs=1e-5)


def test_the_normal_maps_frame_is_that_of_mikktspace(device: Device, tmp_path: Path) -> None:
    """Unit normals and tangents at the vertices, interpolated and not normalised; whatever the instance's scale."""
    texel = np.array([230, 90, 205])
    lean = Image(np.full((4, 4, 4), (*texel, 255), dtype=np.uint8), srgb=False)
    left, right = np.array([-0.9, 0.0, 0.436]), np.array([0.6, 0.0, 0.8])
    normals = np.array([left, right, right, left]) / np.linalg.norm([left, right, right, left], axis=1, keepdims=True)
    tangents = np.cross([0.0, 1.0, 0.0], normals)
    share = (CENTRE[1] + 0.5) / 64.0
    n, t = ((1.0 - share) * v[0] + share * v[1] for v in (normals, tangents))
    x, y, z = texel / 255 * 2 - 1
    expected = x * t + y * np.cross(n, t) + z * n
    expected /= np.linalg.norm(expected)
    unit_n, unit_t = n / np.linalg.norm(n), t / np.linalg.norm(t)
    normalised = x * unit_t + y * np.cross(unit_n, unit_t) + z * unit_n
    normalised /= np.linalg.norm(normalised)
    for scale in (1.0, 1e-3, 1e3):
        world = np.diag([scale, scale, scale, 1.0])
        small = Quad(*(np.array(v) / scale for v in (SQUARE.corner, SQUARE.u, SQUARE.v)), world=world)
        scene = quad_scene([small], [Material(normal_texture=TextureUse(0))], images=[lean])
        scene.normals[:] = normals
        scene.tangents[:, :3] = tangents
        images = render_scene(device, tmp_path, SURFACES.replace("PREPASS", "off"), scene, FACING).images
        assert images["normal"][CENTRE][:3] == pytest.approx(expected, abs=1e-4)
        assert images["normal"][CENTRE][:3] != pytest.approx(normalised, abs=1e-2)


def test_non_uniform_scale_tilts_normals_the_right_way(device: Device, tmp_path: Path) -> None:
    slope = Quad((-1, -1, 0), (2, 0, 0), (0, 2, -2))
    images = fill(
        device, tmp_path, [Quad(slope.corner, slope.u, slope.v, world=np.diag([1.0, 1.0, 0.1, 1.0]))], Material()
    )
    normal = np.cross((2, 0, 0), (0, 2, -0.2))
    assert images["normal"][CENTRE][:3] == pytest.approx(normal / np.linalg.norm(normal), abs=1e-5)


@pytest.mark.parametrize("prepass", ["off", "full"])
def test_alpha_mask_cuts_out(device: Device, tmp_path: Path, prepass: str) -> None:
    pixels = np.full((64, 64, 4), 255, dtype=np.uint8)
    pixels[:, :32, 3] = 0  # the left half
    material = Material(base_color_texture=TextureUse(0), alpha=Alpha.MASKED)
    depth = fill(device, tmp_path, [SQUARE], material, images=(Image(pixels, srgb=True),), prepass=prepass)["depth"]
    assert (depth[:, :30] == 0).all()
    assert (depth[:, 34:] > 0).all()


# ---------------------------------------------------------------- texture addressing


def checker() -> Image:
    """64 x 64, blocks of 16 with a colour each: red tells the column, green the row counted from the top."""
    pixels = np.full((64, 64, 4), 255, dtype=np.uint8)
    block = np.arange(64) // 16 * 60
    pixels[..., 0], pixels[..., 1], pixels[..., 2] = block[None, :], block[:, None], 0
    return Image(pixels, srgb=False)


def wrapped(x: np.ndarray, mode: Wrap) -> np.ndarray:
    if mode is Wrap.REPEAT:
        return x - np.floor(x)
    if mode is Wrap.CLAMP:
        return np.clip(x, 0, 1)
    return 1 - np.abs(np.mod(x, 2) - 1)


@pytest.mark.parametrize("mode", list(Wrap))
@pytest.mark.parametrize("rotation", [0.0, 0.6, np.pi / 2])
def test_texture_transform_and_wrap(device: Device, tmp_path: Path, mode: Wrap, rotation: float) -> None:
    """Every texel but those that filtering blends, against KHR_texture_transform's definition worked out here."""
    offset, scale = (0.3, -0.2), (1.7, 2.1)
    use = TextureUse(0, wrap=(mode, mode), offset=offset, scale=scale, rotation=rotation)
    image = checker()
    images = fill(device, tmp_path, [SQUARE], Material(base_color_texture=use), images=(image,))
    at = (np.arange(64) + 0.5) / 64
    u, v = np.meshgrid(at, 1 - at)
    su, sv = u * scale[0], v * scale[1]
    tu = su * np.cos(rotation) + sv * np.sin(rotation) + offset[0]
    tv = sv * np.cos(rotation) - su * np.sin(rotation) + offset[1]
    s, t = (np.minimum(wrapped(x, mode), 1 - 1e-9) * 64 for x in (tu, tv))
    expected = image.pixels[t.astype(int), s.astype(int), :2] / 255
    # Away from block edges (and the seam, unless clamped) by the width of the filter.
    width = 4.0
    clear = np.ones((64, 64), dtype=bool)
    for x in (s, t):
        near_edge = np.abs(x / 16 - np.round(x / 16)) * 16 < width
        edge_of_image = (x < width) | (x > 64 - width)
        clear &= ~near_edge | (edge_of_image if mode is Wrap.CLAMP else False)
    assert clear.sum() > 200
    assert np.abs(images["base_color"][..., :2] - expected)[clear].max() < 0.02


def test_clamped_edge_does_not_bleed_across_the_seam(device: Device, tmp_path: Path) -> None:
    """Left column black, right column white: clamped, the left edge stays black; repeated (the twin), it does not."""
    pixels = np.zeros((8, 8, 4), dtype=np.uint8)
    pixels[:, 4:, :3], pixels[..., 3] = 255, 255
    edge = {}
    for mode in (Wrap.CLAMP, Wrap.MIRROR, Wrap.REPEAT):
        use = TextureUse(0, wrap=(mode, mode))
        image = fill(device, tmp_path, [SQUARE], Material(base_color_texture=use), images=(Image(pixels, srgb=False),))
        edge[mode] = image["base_color"][32, 0, 0]
    assert edge[Wrap.CLAMP] == edge[Wrap.MIRROR] == 0
    assert edge[Wrap.REPEAT] > 0.3


def test_second_uv_set(device: Device, tmp_path: Path) -> None:
    """uv1 of the test scene is half of uv0: only the first quarter of the image is seen."""
    use = TextureUse(0, uv_set=1)
    images = fill(device, tmp_path, [SQUARE], Material(base_color_texture=use), images=(checker(),))
    assert images["base_color"][8:-8, 8:-8, 0].max() <= 60 / 255 + 1e-3


def test_textures_multiply_factors(device: Device, tmp_path: Path) -> None:
    def plain(*rgb: int) -> np.ndarray:
        return np.tile(np.array([*rgb, 255], dtype=np.uint8), (4, 4, 1))

    images = (
        Image(plain(0, 128, 64), srgb=False),  # green roughness, blue metallic
        Image(plain(51, 0, 0), srgb=False),  # red occlusion
        Image(plain(255, 188, 0), srgb=True),
    )
    material = Material(
        metallic=0.5, roughness=0.5, emissive=(2.0, 2.0, 2.0), occlusion_strength=0.5,
        metallic_roughness_texture=TextureUse(0), occlusion_texture=TextureUse(1), emissive_texture=TextureUse(2),
    )  # fmt: skip
    result = fill(device, tmp_path, [SQUARE], material, images=images)
    roughness, metallic, occlusion = 0.5 * 128 / 255, 0.5 * 64 / 255, 1 + 0.5 * (51 / 255 - 1)
    assert result["material"][CENTRE][:3] == pytest.approx((roughness, metallic, occlusion), abs=2e-3)
    assert result["emissive"][CENTRE][:3] == pytest.approx(
        (2.0, 2.0 * ((188 / 255 + 0.055) / 1.055) ** 2.4, 0.0), abs=1e-2
    )


@pytest.mark.parametrize("alpha", [Alpha.OPAQUE, Alpha.MASKED])
def test_every_material_sees_its_own_texture_array(device: Device, tmp_path: Path, alpha: Alpha) -> None:
    """Four squares: three images of unlike sizes, two of them in one array, and none."""
    colours = [(200, 20, 30), (20, 180, 40), (30, 40, 220)]
    images = tuple(
        Image(np.tile(np.array([*colour, 255], dtype=np.uint8), (side, side, 1)), srgb=False)
        for colour, side in zip(colours, (4, 16, 4), strict=True)
    )
    textured = [Material(alpha=alpha, base_color_texture=TextureUse(k)) for k in range(3)]
    corners = [(-1, -1, 0), (0, -1, 0), (-1, 0, 0), (0, 0, 0)]
    quads = [Quad(corner, (1, 0, 0), (0, 1, 0), material=k) for k, corner in enumerate(corners)]
    prepass = "full" if alpha is Alpha.MASKED else "off"
    result = fill(device, tmp_path, quads, *textured, Material(alpha=alpha), images=images, prepass=prepass)
    for k, (row, column) in enumerate([(16, 16), (16, 48), (48, 16), (48, 48)]):
        expected = np.array(colours[k]) / 255 if k < 3 else np.ones(3)
        assert result["base_color"][row, column, :3] == pytest.approx(expected, abs=2e-3)


def test_vertex_colours_reach_the_surface(device: Device, tmp_path: Path) -> None:
    scene = quad_scene([SQUARE], [Material(base_color=(0.5, 0.5, 0.5, 1.0))])
    scene.colors[:] = (0.2, 0.4, 0.8, 1.0)
    images = render_scene(device, tmp_path, SURFACES.replace("PREPASS", "off"), scene, FACING).images
    assert images["base_color"][CENTRE][:3] == pytest.approx((0.1, 0.2, 0.4), abs=1e-6)
