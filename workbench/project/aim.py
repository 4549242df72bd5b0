"""What only a built body can tell: where a press lands, and where it makes sense."""

from __future__ import annotations

import numpy as np

from geometry.surface.surface_place import SkinPlace, place_near
from workbench.core.design.design import SensorDesign
from workbench.core.design.imported import IMPORTED
from workbench.core.press.press import Press
from workbench.core.result.results import Label, Solid
from workbench.core.result.sensing import Contact

OFF_SKIN_MM = 1.0
"""Distance of a chosen target from the skin that is worth a word."""
FLAT_TOP_MM = 0.02
"""Faces this near to the highest point are its flat top [mm]."""


def default_target_mm(
    design: SensorDesign, solid: Solid | None = None
) -> tuple[float, float, float]:
    """Point near the skin by the family, or the top of an imported body [mm].

    Args:
        design: The sensor.
        solid: Its body; only imported designs need it, and aim at the origin without.
    """
    from designs.family import family, resolve_shape

    if design.family == IMPORTED and solid is not None:
        membrane = solid.membrane
        faces = membrane.faces[membrane.has(Label.OUTER)]
        corners = membrane.points_mm[faces]
        top_mm = corners[:, :, 2].max()
        highest = corners[(corners[:, :, 2] > top_mm - FLAT_TOP_MM).all(axis=1)]
        if len(highest):
            # In the middle of a flat top, not at one of its corners; on it where it is a rim.
            edges = highest[:, 1:] - highest[:, :1]
            area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
            middle = area @ highest.mean(axis=1) / area.sum()
            top = np.arange(3 * len(highest)).reshape(-1, 3)
            point = place_near(highest.reshape(-1, 3), top, middle).point_mm
        else:
            point = corners.reshape(-1, 3)[np.argmax(corners[:, :, 2])]
        x, y, z = (round(float(c), 3) for c in point)
        return x, y, z
    shape = resolve_shape(design.family, design.shape)
    x, y, z = (round(float(c), 3) for c in family(design.family).target(shape, design.layers))
    return x, y, z


def sensing_skin(solid: Solid) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (N, 3) [mm] and triangles (M, 3) of a body's sensing skin, for `skin_place`.

    Copies in memory, float64: of arrays in a file each step of a search would cost anew.
    """
    membrane = solid.membrane
    sensing = np.array(membrane.faces[membrane.has(Label.OUTER)])
    return np.array(membrane.points_mm, dtype=np.float64), sensing


def skin_place(
    skin: tuple[np.ndarray, np.ndarray], place_mm: tuple[float, float, float]
) -> SkinPlace:
    """The place of a `sensing_skin` nearest to a point, and how far that is off [mm].

    Distances go to triangles: a straight wall has corners only at its ends.
    """
    return place_near(*skin, place_mm)


def target_notice(design: SensorDesign, solid: Solid, path: Press, contact: Contact) -> str:
    """What to say of a target that was chosen well off the skin, else ""."""
    if path.trajectory is not None or path.target_mm == default_target_mm(design, solid):
        return ""
    away_mm = float(np.linalg.norm(contact.target_mm - np.array(path.target_mm)))
    if away_mm <= OFF_SKIN_MM:
        return ""
    asked, used = (
        ", ".join(f"{value:g}" for value in np.round(place, 2) + 0.0)
        for place in (path.target_mm, contact.target_mm)
    )
    return (
        f"the target ({asked}) mm is {away_mm:.1f} mm off the skin; "
        f"the press went to the nearest place of the skin, ({used}) mm"
    )
