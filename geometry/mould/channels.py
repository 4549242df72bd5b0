"""Where silicone goes in and air goes out: gate, vents and holes for trapped air.

The mould is used upside down. The cast's face on the base plane is then its highest place: gate and
vents end there, on the medial axis of that face (corners of the Voronoi cells of its outline), the
gate where there is most room, each vent as far from all others as it can be.

A cast without a core has its inner face there, which the camera looks through. Gate and vents then
stand along its edge, 2 mm inside, the gate toward +Y and the vents at equal turns from it.

Trapped air (`trapped`) gets thin holes of its own where nothing of the cast is in the way; the
rest is reported.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.mould.cast import Cast, footprint
from geometry.mould.trapped import can_leave, pockets
from workbench.core.base.errors import GeometryError

GATE_GAP_SHARE = 0.9
"""Width of the gate's throat over the room it ends in."""
VENT_GAP_SHARE = 0.8
LARGEST_THROAT_MM = 2.0
"""Radius [mm]."""
LARGEST_VENT_MM = 0.8
"""Radius of a vent [mm]; wider ones would let silicone pour out."""
EDGE_MM = 2.0
"""From the outline of a face that the camera looks through to gate and vents [mm]."""
OUTLINE_STEP_MM = 0.4
ROOMY_SHARE = 0.6
"""Places with at least this share of the gate's room may get a vent."""
EQUAL_SHARE = 0.97
"""Places with this share of the most room are as good a gate."""
MOST_POCKETS = 64


@dataclass(frozen=True, kw_only=True, slots=True)
class Channels:
    """Holes of the mould, in the sensor frame."""

    gate_mm: np.ndarray
    """x and y of the gate [mm], shape (2,)."""
    throat_mm: float
    """Radius of the gate where it ends [mm]."""
    vents_mm: np.ndarray
    """x and y of the vents [mm], shape (V, 2)."""
    vent_mm: float
    """Radius of the vents [mm]."""
    pockets_mm: np.ndarray
    """Trapped air that gets a hole straight up, shape (P, 3)."""
    trapped_mm: np.ndarray
    """Trapped air that nothing lets out, shape (Q, 3)."""
    trapped_height_mm: float
    """Highest air that nothing lets out [mm]; 0 when there is none."""


def make_channels(cast: Cast, vent_count: int) -> Channels:
    """Gate, vents and holes for trapped air of a cast.

    Raises:
        GeometryError: If the cast has no face on the base plane.
    """
    places, room = (medial_points if cast.core else edge_points)(cast, vent_count)
    found = pockets(cast)
    free = can_leave(cast, found.places_mm)
    free[MOST_POCKETS:] = False
    return Channels(
        gate_mm=places[0],
        throat_mm=min(GATE_GAP_SHARE * float(room[0]), LARGEST_THROAT_MM),
        vents_mm=places[1:],
        vent_mm=min(VENT_GAP_SHARE * float(room[1:].min()), LARGEST_VENT_MM),
        pockets_mm=found.places_mm[free],
        trapped_mm=found.places_mm[~free],
        trapped_height_mm=float(found.height_mm[~free].max(initial=0.0)),
    )


def medial_points(cast: Cast, vent_count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gate and vents midway between outlines of the cast on the base plane, far from each other.

    Returns:
        x and y [mm], the gate's first, shape (1 + V, 2); distance to the outline [mm].
    """
    import shapely
    from scipy.spatial import Voronoi

    area = _face(cast)
    outline = shapely.get_coordinates(shapely.segmentize(area.boundary, OUTLINE_STEP_MM))
    corners = Voronoi(np.unique(outline, axis=0)).vertices
    shapely.prepare(area)
    places = corners[shapely.contains_xy(area, corners[:, 0], corners[:, 1])]
    places = places[np.lexsort((-places[:, 0], -places[:, 1]))]
    room = _room(area, places)
    # Of equally roomy places the one farthest along +Y, so that the answer has one reason.
    gate = int(np.flatnonzero(room >= EQUAL_SHARE * room.max())[0])
    chosen = [gate, *_far_apart(places, room, gate, vent_count)]
    return places[chosen], room[chosen]


def edge_points(cast: Cast, vent_count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gate and vents along the edge of the cast's face on the base plane, at equal turns from +Y.

    They move only as far as the outline does, so a small change of an option moves them little.

    Returns:
        As of `medial_points`.
    """
    import shapely

    area = _face(cast)
    deep_mm = shapely.maximum_inscribed_circle(area).length
    inset = area.buffer(-min(EDGE_MM, deep_mm / 2)).boundary
    low_x, low_y, high_x, high_y = area.bounds
    middle = np.array([(low_x + high_x) / 2, (low_y + high_y) / 2])
    far_mm = high_x - low_x + high_y - low_y
    places = []
    for turn in np.pi / 2 + 2.0 * np.pi * np.arange(1 + vent_count) / (1 + vent_count):
        ray = shapely.LineString([middle, middle + far_mm * np.array([np.cos(turn), np.sin(turn)])])
        met = shapely.get_coordinates(inset.intersection(ray))
        # A face that lies all on one side of the middle is met nowhere on the other.
        if not len(met):
            met = shapely.get_coordinates(shapely.shortest_line(inset, ray))[:1]
        places.append(met[np.argmax(np.linalg.norm(met - middle, axis=1))])
    return np.array(places), _room(area, np.array(places))


def _face(cast: Cast) -> Any:
    """The cast's face on the base plane as a shapely polygon.

    Raises:
        GeometryError: If there is none.
    """
    area = footprint(cast)
    if area.area <= 0.0:
        raise GeometryError(
            "the body has no face on its base plane, so nothing can be poured in",
            hint="cut the body flat at z = 0",
            at="shape",
        )
    return area


def _room(area: Any, places_mm: np.ndarray) -> np.ndarray:
    """Distance of places inside an area to its outline [mm], shape (N,)."""
    import shapely

    return np.asarray(shapely.distance(area.boundary, shapely.points(places_mm)))


def _far_apart(places: np.ndarray, room: np.ndarray, first: int, count: int) -> list[int]:
    """Numbers of places, each as far as possible from the first and from all before it."""
    allowed = np.flatnonzero(room >= ROOMY_SHARE * room[first])
    nearest = np.linalg.norm(places[allowed] - places[first], axis=1)
    chosen = []
    for _ in range(count):
        # Rounded, so that equally far places are told apart by their order, not by noise.
        best = int(np.argmax(np.round(nearest, 2)))
        chosen.append(int(allowed[best]))
        distance = np.linalg.norm(places[allowed] - places[chosen[-1]], axis=1)
        nearest = np.minimum(nearest, distance)
    return chosen
