"""What only a built body can tell: where a press lands or makes sense, which LED ring fits."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from geometry.surface_place import SkinPlace, place_near
from workbench.bodies import IMPORTED
from workbench.core.design import SensorDesign
from workbench.core.lighting import LedMount
from workbench.core.press import Press
from workbench.core.results import Label, Solid
from workbench.core.sensing import Contact

OFF_SKIN_MM = 1.0
"""Distance of a chosen target from the skin that is worth a word."""
RING_STEP_MM = 0.5
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
            # In the middle of a flat top, not at one of its corners.
            edges = highest[:, 1:] - highest[:, :1]
            area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
            point = area @ highest.mean(axis=1) / area.sum()
        else:
            point = corners.reshape(-1, 3)[np.argmax(corners[:, :, 2])]
        x, y, z = (round(float(c), 3) for c in point)
        return x, y, z
    shape = resolve_shape(design.family, design.shape)
    x, y, z = (round(float(c), 3) for c in family(design.family).target(shape, design.layers))
    return x, y, z


def skin_place(solid: Solid, place_mm: tuple[float, float, float]) -> SkinPlace:
    """The place of a body's sensing skin nearest to a point, and how far that is off [mm].

    Distances go to triangles: a straight wall has corners only at its ends.
    """
    membrane = solid.membrane
    return place_near(membrane.points_mm, membrane.faces[membrane.has(Label.OUTER)], place_mm)


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


def with_fitting_ring(design: SensorDesign, solid: Solid) -> tuple[SensorDesign, str]:
    """An imported design whose LEDs fit inside, and what was changed for that, else "".

    A designer whose body comes from a file has not chosen a ring yet, and the default is that of a
    finger. The radius is the largest that keeps the LEDs' own size and the clearance from the
    support, in half millimetres.
    """
    ring = design.optics.ring
    if design.family != IMPORTED or ring.mount is not LedMount.CAVITY or not ring.count:
        return design, ""
    room_mm = _ring_room_mm(design, solid)
    if ring.radius_mm <= room_mm:
        return design, ""
    radius_mm = max(RING_STEP_MM, math.floor(room_mm / RING_STEP_MM) * RING_STEP_MM)
    notice = f"LED ring: radius {radius_mm:g} mm instead of {ring.radius_mm:g} mm, to fit inside"
    return design.replace("optics.ring.radius_mm", radius_mm), notice


def _ring_room_mm(design: SensorDesign, solid: Solid) -> float:
    """Largest radius of the LED ring in this support [mm]; infinite where rays miss it."""
    from geometry.rays import RayCaster
    from workbench.core.leds import led_places

    ring, housing = design.optics.ring, design.housing
    places, _ = led_places(dataclasses.replace(ring, radius_mm=1.0))
    axis = np.array([0.0, 0.0, ring.height_mm])
    caster = RayCaster(solid.support.points_mm, solid.support.faces)
    distance, _, _ = caster.hits(np.broadcast_to(axis, places.shape), places - axis)
    half_mm = math.hypot(housing.led_width_mm, housing.led_height_mm) / 2
    return float(distance.min()) - half_mm - 2 * housing.clearance_mm
