"""The atrium's ground plan and heights, in metres: where bays, columns and walls stand."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Final

from rendergraph.scene.procedural.arcade import BAY

HALF_X: Final = 10.5  # courtyard, to the columns' axes
HALF_Z: Final = 4.5
OUTER_X: Final = HALF_X + BAY  # inner faces of the outer walls
OUTER_Z: Final = HALF_Z + BAY

SPRING: Final = 3.0  # springing of the lower arches
ARCH_TOP: Final = 1.6  # from the springing to the cornice
GALLERY: Final = 4.8  # floor of the upper storey
GALLERY_SPRING: Final = 7.1
CEILING: Final = 8.85  # of the upper storey
ROOF: Final = 9.05


@dataclass(frozen=True, slots=True)
class Place:
    """A point on the plan and the turn about the vertical that makes local +z face the courtyard."""

    x: float
    z: float
    turn: float


def _axis(half: float) -> list[float]:
    """Column axes along one side, from ``-half`` to ``half``."""
    return [-half + BAY * k for k in range(round(2.0 * half / BAY) + 1)]


#: Columns around the courtyard.
COLUMNS: Final = tuple(
    [(x, z) for z in (-HALF_Z, HALF_Z) for x in _axis(HALF_X)]
    + [(x, z) for x in (-HALF_X, HALF_X) for z in _axis(HALF_Z)[1:-1]]
)


def _middles(half: float) -> list[float]:
    return [a + BAY / 2.0 for a in _axis(half)[:-1]]


#: Arches: the middle of every bay of the courtyard's four sides.
ARCHES: Final = tuple(
    [Place(x, -HALF_Z, 0.0) for x in _middles(HALF_X)]
    + [Place(x, HALF_Z, pi) for x in _middles(HALF_X)]
    + [Place(-HALF_X, z, pi / 2.0) for z in _middles(HALF_Z)]
    + [Place(HALF_X, z, -pi / 2.0) for z in _middles(HALF_Z)]
)

#: Vaulted cells of the arcade: a ring around the courtyard.
CELLS: Final = tuple((x, z) for x in _middles(OUTER_X) for z in _middles(OUTER_Z) if abs(x) > HALF_X or abs(z) > HALF_Z)

#: Where ribs and pilasters stand between the cells: the middle of the rib, spanning along local z, wall at local -z.
RIBS: Final = tuple(
    [Place(x, -HALF_Z - BAY / 2.0, 0.0) for x in _axis(HALF_X)]
    + [Place(x, HALF_Z + BAY / 2.0, pi) for x in _axis(HALF_X)]
    + [Place(-HALF_X - BAY / 2.0, z, pi / 2.0) for z in _axis(HALF_Z)]
    + [Place(HALF_X + BAY / 2.0, z, -pi / 2.0) for z in _axis(HALF_Z)]
)
