"""Shapes are closed where they say so, face outwards, and carry orthonormal tangents that follow their uv."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from rendergraph.scene.procedural.arcade import arch_ring, column, rib, spandrels, vault
from rendergraph.scene.procedural.block import block
from rendergraph.scene.procedural.furnishings import drape, fountain, lantern_frame, lantern_glass, pot, tie_band
from rendergraph.scene.procedural.geometry import Geometry, merge
from rendergraph.scene.procedural.mesh_builder import placement
from rendergraph.scene.procedural.shapes import bar, disc, lathe, sheet, sphere
from rendergraph.scene.rays import Triangles, cast

SOLIDS = {
    "box": (block((1.0, 2.0, 3.0)), 6.0),
    # A chamfer of width b cuts b^2/2 off each of 12 edges; corners make the difference third order in b.
    "chamfered": (block((1.0, 2.0, 3.0), (5.0, 0.0, 1.0), bevel=0.01), 6.0 - 4 * 6.0 * 0.01**2 / 2),
    "sphere": (sphere(1.0, 96, 64), 4.0 * pi / 3.0),
    "bar": (bar((0, 0, 0), (3, 4, 0), 0.1, 64), pi * 0.01 * 5.0),
    "cone": (lathe([[(0.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (0.0, 3.0)]], 96), pi),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_have_the_volume_of_their_formula(name: str) -> None:
    geometry, volume = SOLIDS[name]
    assert geometry.signed_volume() == pytest.approx(volume, rel=6e-3)
    assert _open_edges(geometry) == 0


def test_a_solid_turned_inside_out_has_negative_volume() -> None:
    solid = block((1.0, 2.0, 3.0), bevel=0.1)
    turned = replace(solid, indices=solid.indices[::-1].copy())
    assert turned.signed_volume() == pytest.approx(-solid.signed_volume())


def test_a_box_without_its_lid_has_open_edges() -> None:
    solid = block((1.0, 1.0, 1.0))
    assert _open_edges(replace(solid, indices=solid.indices[6:])) == 4


@pytest.mark.parametrize("detail", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("solid", [pot, fountain], ids=["pot", "fountain"])
def test_lathed_furniture_is_closed(solid: object, detail: float) -> None:
    geometry = solid(detail)  # type: ignore[operator]
    assert geometry.signed_volume() > 0.01
    assert _open_edges(geometry) <= 2 * _rings_left_open[solid.__name__] * 72  # type: ignore[attr-defined]


#: The fountain's stem stands in the basin without a foot of its own.
_rings_left_open = {"pot": 0, "fountain": 1}


CLOSED = {
    "tie band": tie_band,
    "lantern": lambda d: lantern_frame(1.2, d),
    "lantern glass": lantern_glass,
}


@pytest.mark.parametrize("detail", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("name", CLOSED)
def test_bronze_and_glass_are_closed(name: str, detail: float) -> None:
    geometry = CLOSED[name](detail)
    assert geometry.signed_volume() > 0.0
    assert _open_edges(geometry) == 0


COLUMNS = {"fluted": (3.0, 0.24, True), "plain": (2.3, 0.17, False)}


@pytest.mark.parametrize("detail", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("name", COLUMNS)
def test_no_ray_gets_into_a_column(name: str, detail: float) -> None:
    """Its parts end inside one another: rays from all around that meet it meet a front first. A gap shows a back."""
    height, radius, fluted = COLUMNS[name]
    solid = column(height, radius, detail, fluted=fluted)
    assert _backs_seen(solid, height, radius) == 0


def test_a_ray_gets_into_a_column_without_its_first_ring() -> None:
    """The twin: the quads that join the column's first two mouldings are taken away."""
    solid = column(3.0, 0.24, 1.0, fluted=True)
    corners = solid.positions[solid.indices.reshape(-1, 3)]
    flat = (np.ptp(corners[:, :, 1], axis=1) < 1e-9) & (np.abs(corners[:, 0, 1] - 0.25) < 1e-9)
    assert flat.sum() > 20
    holed = replace(solid, indices=solid.indices.reshape(-1, 3)[~flat].ravel())
    assert _backs_seen(holed, 3.0, 0.24) > 0


def _backs_seen(solid: Geometry, height: float, radius: float) -> int:
    """How many rays towards all parts of a column's mouldings, from above, below and level, meet a back first."""
    triangles = Triangles(np.stack([solid.positions[solid.indices[k::3]] for k in range(3)]),
                          np.zeros(solid.triangles, dtype=bool))  # fmt: skip
    ends = [0.14, 0.25, 0.31, 0.37, 0.40, height - 0.54, height - 0.52, height - 0.49, height - 0.14]
    reach = np.linspace(0.8, 1.5, 57) * radius
    targets = np.array([(0.0, y, z) for y in ends for z in reach])
    seen = 0
    for x, y in ((2.0, 3.9), (2.0, -1.0), (2.0, height / 2), (0.4, 1.2), (0.4, height - 1.2)):
        origin = np.array([x, y, 0.13])
        along = targets - origin
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        # On a silhouette rounding decides between a front and a back: a gap is seen by two rays side by side.
        pair = [cast(triangles, origin + np.array([0.0, 3e-4 * k, 3e-4 * k]), along) for k in (0, 1)]
        backs = [np.isfinite(hits.distance) & ~hits.faced for hits in pair]
        assert np.isfinite(pair[0].distance).sum() > 50
        seen += int((backs[0] & backs[1]).sum())
    return seen


PARTS = {
    "column": lambda d: column(3.0, 0.24, d, fluted=True),
    "plain column": lambda d: column(2.3, 0.17, d, fluted=False),
    "arch ring": arch_ring,
    "spandrels": lambda d: spandrels(1.6, d),
    "rib": rib,
    "vault": lambda d: vault(1.42, d),
    "pot": pot,
    "fountain": fountain,
    "clasp": tie_band,
    "disc": lambda d: disc(1.0, 12, 2),
    "sheet": lambda d: sheet((0, 0, 0), (2, 0, 0), (0, 1, 1), (3, 2)),
    "chamfered": lambda d: block((1.0, 2.0, 3.0), bevel=0.2),
}


@pytest.mark.parametrize("detail", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("name", PARTS)
def test_triangles_face_the_way_their_normals_do(name: str, detail: float) -> None:
    geometry = PARTS[name](detail)
    assert _facing(geometry).min() > 0.0
    assert np.isfinite(geometry.positions).all()


def _tangent_follows_u(geometry: Geometry) -> np.ndarray:
    """For every triangle: whether its tangents point along growing u, and the bitangents along falling v."""
    i = geometry.indices.reshape(-1, 3)
    p, uv = geometry.positions[i], geometry.uv[i]
    e1, e2 = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    d1, d2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    det = d1[:, 0] * d2[:, 1] - d2[:, 0] * d1[:, 1]
    sign = np.sign(det)[:, None]
    along_u = (e1 * d2[:, 1:] - e2 * d1[:, 1:]) * sign
    along_v = (e2 * d1[:, :1] - e1 * d2[:, :1]) * sign
    tangent = geometry.tangents[i, :3].sum(axis=1)
    cross = np.cross(geometry.normals[i], geometry.tangents[i, :3]) * geometry.tangents[i, 3:]
    good = ((along_u * tangent).sum(1) > 0.0) & ((along_v * cross.sum(axis=1)).sum(1) < 0.0)
    return good[np.abs(det) > 1e-9]


@pytest.mark.parametrize("name", ["column", "arch ring", "spandrels", "rib", "vault", "pot", "disc", "sheet"])
def test_tangents_follow_the_texture(name: str) -> None:
    assert _tangent_follows_u(PARTS[name](1.0)).mean() > 0.99


def test_mirrored_texture_coordinates_need_the_other_handedness() -> None:
    flat = sheet((0, 0, 0), (2, 0, 0), (0, 1, 0))
    assert _tangent_follows_u(flat).all()
    mirrored = replace(flat, uv=flat.uv * [-1.0, 1.0])
    assert not _tangent_follows_u(mirrored).any()


def test_placing_turns_normals_with_the_surface() -> None:
    solid = block((1.0, 2.0, 3.0), bevel=0.1)
    turned = solid.placed(placement(1.0, 2.0, 3.0, turn=0.7, scale=(2.0, 1.0, 0.5)))
    assert _facing(turned).min() > 0.0
    assert turned.signed_volume() == pytest.approx(solid.signed_volume())
    assert np.abs((turned.normals * turned.tangents[:, :3]).sum(axis=1)).max() < 1e-12


def test_a_mirroring_placement_is_refused() -> None:
    with pytest.raises(ValueError, match="mirror"):
        block((1.0, 1.0, 1.0)).placed(np.diag([-1.0, 1.0, 1.0, 1.0]))


def test_vault_reaches_the_arches_on_all_four_sides() -> None:
    shell = vault(1.42, 1.0)
    low, high = shell.positions.min(axis=0), shell.positions.max(axis=0)
    np.testing.assert_allclose(low, [-1.5, 0.0, -1.5], atol=1e-9)
    np.testing.assert_allclose(high, [1.5, 1.42, 1.5], atol=1e-9)


def test_a_tied_curtain_is_narrow_at_its_tie_and_hangs_to_its_drop() -> None:
    cloth = drape(np.random.default_rng(0), 1.3, 2.3, 1.35, 1.0)
    x, y = cloth.positions[:, 0], cloth.positions[:, 1]
    near_tie, near_rail = np.abs(y + 1.35) < 0.05, y > -0.05
    assert np.ptp(x[near_tie]) < 0.4 < 1.2 < np.ptp(x[near_rail])
    assert y.min() == pytest.approx(-2.3)
    assert y.max() == 0.0


def test_merging_keeps_every_triangle() -> None:
    parts = [sphere(1.0, 8, 4), block((1, 1, 1))]
    whole = merge(parts)
    assert whole.triangles == sum(p.triangles for p in parts)
    assert whole.signed_volume() == pytest.approx(sum(p.signed_volume() for p in parts))


def _facing(geometry: Geometry) -> np.ndarray:
    """For every triangle the cosine-like product of its own normal and its vertices' normals."""
    i = geometry.indices.reshape(-1, 3)
    a, b, c = (geometry.positions[i[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    return (face * geometry.normals[i].sum(axis=1)).sum(axis=1) / np.linalg.norm(face, axis=1)


def _open_edges(geometry: Geometry) -> int:
    """Edges that do not run once each way, with vertices at one place taken as one."""
    place = {}
    ids = [place.setdefault(tuple(p), len(place)) for p in (np.round(geometry.positions, 7) + 0.0).tolist()]
    triangles = np.array(ids)[geometry.indices.reshape(-1, 3)]
    balance: dict[tuple[int, int], int] = {}
    for a, b in np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).tolist():
        if a != b:
            balance[min(a, b), max(a, b)] = balance.get((min(a, b), max(a, b)), 0) + (1 if a < b else -1)
    return sum(count != 0 for count in balance.values())
