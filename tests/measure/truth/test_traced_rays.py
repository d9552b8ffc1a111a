"""Rays whose hits are known by hand, against every triangle, through holes, far out, and off their own surface."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

from rendergraph.document.messages import RenderGraphError
from rendergraph.measure.truth.rays import Rays
from rendergraph.scene import procedural
from rendergraph.scene.rays import cast, world_triangles
from rendergraph.scene.scene import Alpha, Image, Instance, TextureUse
from tests.measure.truth.traced_scenes import MATT, quads, square

pytest.importorskip("embreex")

DOWN = np.array([[0.0, 0.0, -1.0]])


def along(directions: np.ndarray) -> np.ndarray:
    return directions / np.linalg.norm(directions, axis=-1, keepdims=True)


def test_a_hit_on_a_plane_is_where_it_must_be() -> None:
    rays = Rays(quads([square(-2.0)]))
    direction = along(np.array([[0.3, -0.2, -1.0], [0.0, 0.0, 1.0], [2.0, 0.0, -1.0]]))
    hits = rays.nearest(np.zeros((3, 3)), direction)
    assert hits.hit.tolist() == [True, False, False]
    assert hits.distance[0] == pytest.approx(2.0 * np.sqrt(1.0 + 0.3**2 + 0.2**2), rel=1e-15)
    corners = rays.primitives.corners[hits.primitive[0]]
    assert hits.barycentric[0] @ corners == pytest.approx([0.6, -0.4, -2.0], abs=1e-14)
    assert hits.front[0]


def test_backs_are_seen_unless_they_are_culled() -> None:
    origin = np.array([[0.1, 0.2, -5.0]])
    for double, culled in ((False, [False]), (True, [True])):
        rays = Rays(quads([square(-2.0)], [replace(MATT, double_sided=double)]))
        assert rays.nearest(origin, -DOWN).front.tolist() == [False]
        assert rays.nearest(origin, -DOWN).hit.tolist() == [True]
        assert rays.nearest(origin, -DOWN, cull=True).hit.tolist() == culled


def test_mirrored_instances_keep_their_fronts_outside() -> None:
    for mirror in (1.0, -1.0):
        rays = Rays(quads([square(-2.0)], world=np.diag([mirror, 1.0, 1.0, 1.0])))
        hits = rays.nearest(np.array([[0.1, 0.2, 0.0]]), DOWN)
        assert hits.front.tolist() == [True]
        found = rays.primitives
        placed = hits.barycentric[0] @ rays.scene.positions[found.vertices[hits.primitive[0]]]
        assert placed == pytest.approx([mirror * 0.1, 0.2, -2.0], abs=1e-6)


def test_a_tessellated_sphere_is_hit_between_its_radius_and_its_facets() -> None:
    scene = procedural.build("spheres", detail=1.0)
    ball = scene.instances[0]
    rays = Rays(replace(scene, instances=[Instance(ball.mesh, np.eye(4))]))
    radius = 0.45
    outward = along(np.random.default_rng(3).normal(size=(500, 3)))
    hits = rays.nearest(outward * 3.0, -outward, cull=True)
    place = 3.0 - hits.distance
    around = 72
    # A facet's middle lies below the sphere by the sagitta of its diagonal: 1 - cos of half an edge's angle, twice.
    sagitta = radius * (1.0 - np.cos(np.pi / around)) * 2.0
    assert hits.hit.all()
    assert place.max() <= radius * (1.0 + 1e-6)
    assert place.min() >= radius - sagitta
    assert place.min() < radius - 0.5 * sagitta  # it is the facets that are hit, not a sphere


def test_the_cornell_box_from_the_middle_of_its_open_side() -> None:
    rays = Rays(procedural.build("cornell", detail=0.0))
    low, high = rays.scene.bounds()
    middle = np.array([[0.0, 0.5 * (low[1] + high[1]), 0.0]])
    for axis, sign in ((0, -1), (0, 1), (1, 1)):
        direction = np.zeros((1, 3))
        direction[0, axis] = sign
        origin = np.array([[0.0, 5.0, 2.0]]) if axis == 0 else middle + np.array([2.5, 0.0, 0.0])
        wall = (high if sign > 0 else low)[axis]
        assert rays.nearest(origin, direction).distance[0] == pytest.approx(abs(wall - origin[0, axis]), rel=1e-6)


def test_random_scenes_against_every_triangle() -> None:
    scene = procedural.build("atrium", detail=0.0)
    solid = [i for i in scene.instances if scene.materials[scene.meshes[i.mesh].material].alpha is Alpha.OPAQUE]
    scene = replace(scene, instances=solid)
    rays, triangles = Rays(scene), world_triangles(scene)
    random = np.random.default_rng(11)
    for origin in ((0.3, 1.7, 0.2), (-6.0, 3.0, 2.5)):
        directions = along(random.normal(size=(150, 3)))
        hits = rays.nearest(np.tile(origin, (150, 1)), directions)
        expected = cast(triangles, np.array(origin), directions)
        assert (np.isfinite(hits.distance) == np.isfinite(expected.distance)).all()
        off = np.abs(hits.distance[hits.hit] / expected.distance[hits.hit] - 1.0)
        assert np.quantile(off, 0.98) < 1e-5  # at an edge float32 may find the other one's triangle


# ---------------------------------------------------------------- holes


def half_open() -> Image:
    """The left half of the image is cut out."""
    pixels = np.full((8, 8, 4), 255, dtype=np.uint8)
    pixels[:, :4, 3] = 0
    return Image(pixels, srgb=True)


CUT = replace(MATT, alpha=Alpha.MASKED, base_color_texture=TextureUse(0), double_sided=True)


def test_rays_go_on_through_cut_out_texels() -> None:
    rays = Rays(quads([square(-2.0), square(-3.0)], [CUT, MATT], of=[0, 1], images=[half_open()]))
    hits = rays.nearest(np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]), np.tile(DOWN, (2, 1)))
    assert hits.distance.tolist() == [3.0, 2.0]
    assert hits.passed.tolist() == [True, False]
    occluded = rays.occluded(np.array([[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]]), np.tile(DOWN, (2, 1)), far=2.5)
    assert occluded.tolist() == [False, True]


def test_rays_get_through_many_close_and_even_equal_layers() -> None:
    stack = [square(-2.0)] * 4 + [square(-2.0 - 1e-3 * k) for k in range(1, 40)] + [square(-3.0)]
    rays = Rays(quads(stack, [CUT, MATT], of=[0] * 43 + [1], images=[half_open()]))
    hits = rays.nearest(np.array([[-0.5, 0.1, 0.0]]), DOWN)
    assert hits.distance.tolist() == [3.0]


def test_the_alpha_factor_and_the_cutoff_decide_too() -> None:
    for factor, cutoff, distance in ((0.4, 0.5, 3.0), (0.6, 0.5, 2.0), (0.6, 0.7, 3.0)):
        cut = replace(MATT, alpha=Alpha.MASKED, base_color=(1, 1, 1, factor), alpha_cutoff=cutoff)
        rays = Rays(quads([square(-2.0), square(-3.0)], [cut, MATT], of=[0, 1]))
        assert rays.nearest(np.zeros((1, 3)), DOWN).distance.tolist() == [distance]


def test_blended_surfaces_are_another_set() -> None:
    scene = quads([square(-2.0), square(-3.0)], [replace(MATT, alpha=Alpha.BLENDED), MATT], of=[0, 1])
    assert Rays(scene).nearest(np.zeros((1, 3)), DOWN).distance.tolist() == [3.0]
    assert Rays(scene, (Alpha.BLENDED,)).nearest(np.zeros((1, 3)), DOWN).distance.tolist() == [2.0]


# ---------------------------------------------------------------- precision


def test_a_scene_a_thousand_kilometres_out_loses_nothing() -> None:
    far = np.eye(4)
    far[:3, 3] = (1e6, 2e6, -1e6)
    rays = Rays(quads([square(-2.0)], world=far))
    origin = np.array([[0.25, 0.125, 0.0]]) + far[:3, 3]
    assert rays.nearest(origin, DOWN).distance[0] == pytest.approx(2.0, rel=1e-9)
    assert float(np.float32(1e6 + 0.25 / 16)) != 1e6 + 0.25 / 16  # what float32 world coordinates would lose


def test_a_surface_does_not_occlude_itself_and_does_what_lies_on_it() -> None:
    slab = [[-0.5, -0.5, -1.0 + 1e-4], [1, 0, 0], [0, 1, 0]]
    rays = Rays(quads([square(-1.0, 10.0), slab]))
    random = np.random.default_rng(7)
    points = np.column_stack([random.uniform(-9, 9, (4000, 2)), np.full(4000, -1.0)])
    directions = along(np.column_stack([random.normal(size=(4000, 2)) * 30, np.abs(random.normal(size=4000)) + 0.01]))
    normals = np.tile([0.0, 0.0, 1.0], (4000, 1))
    blocked = rays.occluded(rays.leave(points, normals, directions), directions)
    inside = (np.abs(points[:, :2]) < 0.5).all(axis=1)
    # Under the slab everything is dark, though it lies a tenth of a millimetre above; the floor itself blocks nothing.
    steep = np.abs(directions[:, 2]) > 0.05
    assert blocked[inside & steep].all()
    assert not blocked[np.abs(points[:, :2]).max(axis=1) > 0.51].any()
    assert rays.occluded(points - 1e-3 * normals, directions).mean() > 0.9  # the twin: started on the wrong side


def test_an_empty_scene_is_not_hit() -> None:
    rays = Rays(replace(quads([square(-1.0)]), instances=[]))
    assert not rays.nearest(np.zeros((2, 3)), np.tile(DOWN, (2, 1))).hit.any()
    assert not rays.occluded(np.zeros((2, 3)), np.tile(DOWN, (2, 1))).any()


def test_without_embree_the_error_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "embreex.rtcore_scene", None)
    with pytest.raises(RenderGraphError) as caught:
        Rays(quads([square(-1.0)]))
    assert [d.code for d in caught.value.diagnostics] == ["RG743"]
