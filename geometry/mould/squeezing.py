"""How far the skin must stretch to make way for a rigid part of the mould that is drawn off it.

Where a wall of the part, moving along its way, runs into the skin, the skin must give way by the
depth d at which the wall passes below the surface that it has shaped:

- with another rigid part behind it, at a distance r from the wall where that passes, the skin is
  squeezed from d + r to r; being incompressible it stretches along itself by d / r (plane strain);
- with nothing behind it, a skin of half width R dents by d, which stretches it by about d / R.

Leaves out: that skin may slide along to where there is room, which lowers the first.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geometry.body.csg import Body
from geometry.body.csg_mesh import evaluate
from geometry.mould.cast import Cast
from geometry.mould.castability import LIFT_MM, Worst
from geometry.mould.parting import Parting
from geometry.surface.rays import RayCaster
from geometry.surface.spread import spread
from geometry.surface.surface import closest_point

MOST_WAYS = 100
"""Ways through the skin that are looked at, the longest."""
PLACES = 5
"""Places looked at along each."""
ENTER_MM = 1e-4
LEVEL = 1e-6
"""A way that falls by less of its length never reaches the base plane [1]."""
LEAST_MM = 1e-3
"""A skin squeezed to less is torn: keeps the strain finite."""
SAMPLES = 2000


class Ways(NamedTuple):
    """Straight pieces of ways of a wall that lie in the skin."""

    start_mm: np.ndarray
    """Shape (W, 3)."""
    vector_mm: np.ndarray
    """Shape (W, 3)."""


def outer_strain(cast: Cast, parting: Parting, number: int, *, backed: bool) -> Worst:
    """Strain of the skin when an outer part is pulled off it.

    Args:
        backed: Whether the core is still behind the skin.
    """
    places = spread(cast.sensing.points_mm, cast.sensing.faces, SAMPLES)
    mine = parting.part_of(places.points_mm) == number
    start = places.points_mm[mine] + LIFT_MM * places.normals[mine]
    places_mm = _along(_through(cast.outer, start, parting.pulls[number], cast.base_mm))
    if not len(places_mm):
        return Worst(0.0, (0.0, 0.0, 0.0))
    depth_mm = _depth_mm(cast.sensing, places_mm)
    if backed:
        return _worst(depth_mm / np.maximum(_behind_mm(cast, places_mm), LEAST_MM), places_mm)
    return _worst(depth_mm / _half_widths_mm(cast, places_mm), places_mm)


def confined_strain(cast: Cast, pull: np.ndarray) -> Worst:
    """Strain of the skin when the core is drawn while the outer parts still hold the skin."""
    core = cast.core
    if core is None:
        return Worst(0.0, (0.0, 0.0, 0.0))
    places = spread(core.points_mm, core.faces, SAMPLES)
    above_base = places.points_mm[:, 2] > cast.base_mm + LIFT_MM
    start = (places.points_mm - LIFT_MM * places.normals)[above_base]
    places_mm = _along(_through(core, start, pull, cast.base_mm))
    if not len(places_mm):
        return Worst(0.0, (0.0, 0.0, 0.0))
    behind_mm = _depth_mm(cast.sensing, places_mm)
    return _worst(_depth_mm(core, places_mm) / np.maximum(behind_mm, LEAST_MM), places_mm)


def _through(body: Body, start_mm: np.ndarray, pull: np.ndarray, base_mm: float) -> Ways:
    """The longest pieces of ways from places of a wall that lie in the skin.

    Args:
        body: Whose surface the wall is on; the skin is inside it, or outside for the core.
        start_mm: Places a hair off that surface, on the wall's side, shape (S, 3).
    """
    along = np.tile(pull, (len(start_mm), 1))
    caster = RayCaster(body.points_mm, body.faces)
    enter = caster.hits(start_mm, along)[0]
    met = np.flatnonzero(np.isfinite(enter))
    entry = start_mm[met] + (enter[met, None] + ENTER_MM) * pull
    # The base plane is where the skin ends: what leaves there meets none.
    within = entry[:, 2] > base_mm + LIFT_MM
    entry = entry[within]
    leave = caster.hits(entry, along[: len(entry)])[0]
    if pull[2] < -LEVEL:
        leave = np.minimum(leave, (entry[:, 2] - base_mm) / -pull[2])
    # A way that only grazes the body goes in and never comes out.
    leave, entry = leave[np.isfinite(leave)], entry[np.isfinite(leave)]
    longest = np.argsort(-leave, kind="stable")[:MOST_WAYS]
    return Ways(entry[longest], leave[longest, None] * pull)


def _along(ways: Ways) -> np.ndarray:
    """Places along ways [mm], shape (W * PLACES, 3)."""
    share = (np.arange(PLACES) + 0.5) / PLACES
    places = ways.start_mm[:, None] + share[None, :, None] * ways.vector_mm[:, None]
    return places.reshape(-1, 3)


def _depth_mm(body: Body, places_mm: np.ndarray) -> np.ndarray:
    return closest_point(body.points_mm, body.faces, places_mm)[1]


def _behind_mm(cast: Cast, places_mm: np.ndarray) -> np.ndarray:
    """Distance to what is rigid behind the skin: the core, or the lid of a body without one."""
    if cast.core is None:
        return places_mm[:, 2] - cast.base_mm
    return _depth_mm(cast.core, places_mm)


def _half_widths_mm(cast: Cast, places_mm: np.ndarray) -> np.ndarray:
    """Half the smaller width of the body's section at the height of each place [mm], shape (P,).

    However the section is turned; fins and toes beside each other bend aside as a whole.
    """
    import shapely

    body = evaluate(cast.outer)
    heights_mm, rows = np.unique(np.round(places_mm[:, 2], 1), return_inverse=True)
    found = np.full(len(heights_mm), LEAST_MM)
    for number, height_mm in enumerate(heights_mm):
        outlines = body.slice(float(height_mm)).to_polygons()
        if not outlines:
            continue
        around = shapely.MultiPoint(np.concatenate(outlines)).minimum_rotated_rectangle
        sides_mm = np.linalg.norm(np.diff(shapely.get_coordinates(around)[:3], axis=0), axis=1)
        found[number] = max(LEAST_MM, float(sides_mm.min()) / 2)
    return found[rows.reshape(-1)]


def _worst(strain: np.ndarray, places_mm: np.ndarray) -> Worst:
    worst = int(np.argmax(strain))
    x, y, z = (float(value) for value in places_mm[worst])
    return Worst(float(strain[worst]), (x, y, z))
