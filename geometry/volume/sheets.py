"""Two sheets of quadrilaterals on the inner and outer face of a wall, node for node.

What hexahedra are stacked between. A cap's sheets end on the base plane; a slab's end on its
free sides, which belong to the sensing surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.volume.ogrid import axis_of, on_base, ray_grid
from geometry.volume.skins import curved_region, labelled_faces
from workbench.core.result.results import Label, LabelledSurface


@dataclass(frozen=True, kw_only=True, slots=True)
class Sheets:
    """Nodes on both faces of a wall."""

    inside: np.ndarray
    """Nodes on the inner face [mm], shape (N, 3)."""
    outside: np.ndarray
    """Nodes on the outer face [mm], shape (N, 3)."""
    quads: np.ndarray
    """Nodes of each cell, counter-clockwise from outside the sensor, shape (Q, 4), int32."""
    ring: np.ndarray
    """Nodes on the border, counter-clockwise from above, shape (R,), int32."""
    rim: Label
    """What lies between the two borders: BASE, or OUTER for a slab's free sides."""


def cap_sheets(membrane: LabelledSurface, spacing_mm: float) -> Sheets:
    """Sheets of a cap that stands on the base plane, by rays from its axis.

    Raises:
        MeshingError: If a ray misses a face.
    """
    outer = curved_region(membrane, Label.OUTER)
    inner = curved_region(membrane, Label.INNER)
    inner_points = membrane.points_mm[labelled_faces(membrane, Label.INNER)].reshape(-1, 3)
    grid = ray_grid(outer, axis_of(inner_points), spacing_mm)
    return Sheets(
        inside=on_base(inner.points(grid.origins, grid.directions), grid),
        outside=on_base(outer.points(grid.origins, grid.directions), grid),
        quads=grid.quads,
        ring=grid.ring,
        rim=Label.BASE,
    )
