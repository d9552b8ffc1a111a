"""Scenes made by code, shipped with the package. Importing this module loads no numpy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from rendergraph.scene.scene import Scene

#: Names that ``scene.source`` may give instead of a file.
SHIPPED: Final = ("atrium", "cornell", "spheres")


def build(name: str, *, detail: float = 1.0, seed: int = 0) -> Scene:
    """Build a shipped scene.

    ``detail`` 0..1 scales tessellation and texture size and keeps the silhouette; ``seed`` varies everything random.
    Equal arguments give identical arrays. ``KeyError`` for a name that is not in ``SHIPPED``; ``ValueError`` for a
    detail out of range.
    """
    if not 0.0 <= detail <= 1.0:
        raise ValueError(f"detail {detail} is not in 0..1")
    if name == "atrium":
        from rendergraph.scene.procedural.atrium import atrium

        return atrium(detail, seed)
    if name == "cornell":
        from rendergraph.scene.procedural.cornell import cornell

        return cornell(detail, seed)
    if name == "spheres":
        from rendergraph.scene.procedural.spheres import spheres

        return spheres(detail, seed)
    raise KeyError(name)
