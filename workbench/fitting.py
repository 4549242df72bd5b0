"""Brings LEDs, lamps and cameras inside the body they are in: the remedy for what does not fit.

Each light and camera that the checks refuse is moved as little as the candidates allow: a ring gets
the largest radius that keeps its LEDs' own size and the clearance from the support, in half
millimetres; lamps and cameras go toward the axis, and up to the base. What fits stays as it is.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

import numpy as np

from workbench.core.camera import Camera
from workbench.core.design import SensorDesign
from workbench.core.errors import DesignError
from workbench.core.lighting import Lamp, LedMount, LedRing
from workbench.core.results import MembraneMesh, Solid

RING_STEP_MM = 0.5
SHARES = np.linspace(1.0, 0.0, 21)
"""Parts of the way from the axis at which a lamp or camera is tried [1]."""
ABOVE_BASE_MM = 0.3
"""Height over the base of what was below it [mm]: that of the default camera."""
Placed = TypeVar("Placed", LedRing, Lamp, Camera)


def fitted(design: SensorDesign, solid: Solid) -> tuple[SensorDesign, str]:
    """The design with everything inside, and what was changed for that, else "".

    What no candidate brings inside stays, and is refused by the checks as before.
    """
    from geometry.skins import rough_skins
    from sim.optics.places import check_camera, check_lights

    mesh, said = rough_skins(solid), []
    optics = design.optics
    dark = LedRing(count=0)

    def ring_fits(ring: LedRing) -> None:
        check_lights(mesh, ring)
        if ring.mount is LedMount.CAVITY and ring.radius_mm > ring_room_mm(design, solid, ring):
            raise DesignError("the LEDs touch the support", at="optics.ring.radius_mm")

    if optics.ring.count:
        ring = _first(optics.ring, _rings(design, solid, mesh), ring_fits)
        if ring != optics.ring:
            said.append(_ring_words(optics.ring, ring))
            design = design.replace("optics.ring", ring)
    base_mm = float(mesh.cavity.points_mm[:, 2].min())
    lamps = tuple(
        _first(lamp, _nearer(lamp, base_mm), lambda lamp: check_lights(mesh, dark, (lamp,)))
        for lamp in optics.lamps
    )
    if lamps != optics.lamps:
        said.append(f"lamps: {_moved(optics.lamps, lamps)}")
        design = design.replace("optics.lamps", lamps)
    before = optics.all_cameras
    cameras = [
        _first(eye, _nearer(eye, base_mm), lambda eye: check_camera(mesh, eye)) for eye in before
    ]
    if tuple(cameras) != tuple(before):
        said.append(f"cameras: {_moved(before, cameras)}")
        design = design.replace("optics.camera", cameras[0])
        design = design.replace("optics.cameras", tuple(cameras[1:]))
    return design, "; ".join(said)


def ring_room_mm(design: SensorDesign, solid: Solid, ring: LedRing | None = None) -> float:
    """Largest radius of the LED ring in this support [mm]; infinite where rays miss it."""
    from geometry.rays import RayCaster
    from workbench.core.leds import led_places

    ring, housing = ring or design.optics.ring, design.housing
    places, _ = led_places(dataclasses.replace(ring, radius_mm=1.0))
    axis = np.array([0.0, 0.0, ring.height_mm])
    caster = RayCaster(solid.support.points_mm, solid.support.faces)
    distance, _, _ = caster.hits(np.broadcast_to(axis, places.shape), places - axis)
    half_mm = math.hypot(housing.led_width_mm, housing.led_height_mm) / 2
    return float(distance.min()) - half_mm - 2 * housing.clearance_mm


def _first(now: Placed, others: Iterable[Placed], check: Callable[[Placed], None]) -> Placed:
    """The first that the check takes; what there is now, if none."""
    for one in (now, *others):
        try:
            check(one)
        except DesignError as error:
            # A black light is no matter of place.
            if error.at.endswith(("power", "colour", "colours")):
                return now
        else:
            return one
    return now


def _rings(design: SensorDesign, solid: Solid, mesh: MembraneMesh) -> Iterator[LedRing]:
    """Rings with other radii, then at other heights too, the nearest first."""
    ring = design.optics.ring
    base_mm, top_mm = (float(f(mesh.cavity.points_mm[:, 2])) for f in (np.min, np.max))
    heights = np.clip([ring.height_mm, *np.linspace(0.9, 0.1, 9) * top_mm], base_mm, None)
    for height_mm in heights:
        raised = dataclasses.replace(ring, height_mm=round(float(height_mm), 2))
        if ring.mount is LedMount.CAVITY:
            room_mm = ring_room_mm(design, solid, raised)
            if not math.isfinite(room_mm) or room_mm < RING_STEP_MM:
                continue
            steps = math.floor(min(room_mm, ring.radius_mm) / RING_STEP_MM)
            radii = RING_STEP_MM * np.arange(steps, 0, -1)
        else:
            radii = _shell_radii(mesh, raised)
        for radius_mm in radii:
            yield dataclasses.replace(raised, radius_mm=round(float(radius_mm), 3))


def _shell_radii(mesh: MembraneMesh, ring: LedRing) -> list[float]:
    """The middle of the support all around, where it has one radius for all LEDs."""
    from sim.optics.within import wall_radius
    from workbench.core.leds import led_places

    places, _ = led_places(ring)
    low_mm = max(wall_radius(mesh.cavity, place) for place in places)
    high_mm = min(wall_radius(mesh.inner, place) for place in places)
    return [(low_mm + high_mm) / 2] if low_mm < high_mm < math.inf else []


def _nearer(item: Placed, base_mm: float) -> Iterator[Placed]:
    """A lamp or camera nearer and nearer to the axis, at its height or just above the base."""
    x, y, z = item.position_mm  # pyright: ignore[reportAttributeAccessIssue]
    height_mm = max(z, base_mm + ABOVE_BASE_MM)
    for share in SHARES:
        place = (round(float(share * x), 3), round(float(share * y), 3), round(height_mm, 3))
        yield dataclasses.replace(item, position_mm=place)


def _ring_words(before: LedRing, after: LedRing) -> str:
    words = f"LED ring: radius {after.radius_mm:g} mm instead of {before.radius_mm:g} mm"
    if after.height_mm != before.height_mm:
        words += f", height {after.height_mm:g} mm instead of {before.height_mm:g} mm"
    return f"{words}, to fit inside"


def _moved(before: Iterable[Lamp | Camera], after: Iterable[Lamp | Camera]) -> str:
    pairs = zip(before, after, strict=True)
    return ", ".join(
        f"{number} to ({', '.join(f'{value:g}' for value in new.position_mm)}) mm"
        for number, (old, new) in enumerate(pairs, start=1)
        if old != new
    )
