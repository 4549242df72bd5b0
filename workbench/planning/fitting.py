"""Brings LEDs, lamps and cameras inside the body they are in: the remedy for what does not fit.

Each light and camera that the checks refuse is moved as little as the candidates allow: a ring gets
the largest radius that keeps its LEDs' own size and the clearance from the support, in half
millimetres; lamps and cameras go toward the axis at their height, else to other heights in the
cavity, the nearest first. What fits stays as it is.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TypeVar

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import Lamp, LedMount, LedRing
from workbench.core.result.results import MembraneMesh, Solid

RING_STEP_MM = 0.5
SHARES = np.linspace(1.0, 0.0, 21)
"""Parts of the way from the axis at which a lamp or camera is tried [1]."""
FEW_SHARES = SHARES[::5]
LEVELS = np.linspace(1.0, 0.0, 21)
"""Parts of the cavity's height at which they are tried then [1]."""
ABOVE_BASE_MM = 0.3
"""Height over the base of what was below it [mm]: that of the default camera."""
Placed = TypeVar("Placed", LedRing, Lamp, Camera)


def fitted(design: SensorDesign, solid: Solid) -> tuple[SensorDesign, str]:
    """The design with everything inside, and what was changed for that, else "".

    What no candidate brings inside stays, and is refused by the checks as before.
    """
    from geometry.volume.skins import rough_skins
    from sim.optics.light.places import check_camera, check_lights

    mesh, said = rough_skins(solid), []
    optics = design.optics
    dark = LedRing(count=0)

    def ring_fits(ring: LedRing) -> None:
        check_lights(mesh, ring)
        if ring.mount is LedMount.CAVITY and ring.radius_mm > ring_room_mm(design, solid, ring):
            raise DesignError("the LEDs touch the support", at="optics.ring.radius_mm")

    if optics.ring.count:
        ring = _first(optics.ring, _rings(design, solid, mesh), ring_fits)
        if ring is None:
            said.append("LED ring: no radius and height were found at which it fits")
        elif ring != optics.ring:
            said.append(_ring_words(optics.ring, ring))
            design = design.replace("optics.ring", ring)
    lamps = [
        _first(lamp, _nearer(lamp, mesh), lambda lamp: check_lights(mesh, dark, (lamp,)))
        for lamp in optics.lamps
    ]
    design = design.replace("optics.lamps", _placed("lamp", optics.lamps, lamps, said))
    before = optics.all_cameras
    cameras = [
        _first(eye, _nearer(eye, mesh), lambda eye: check_camera(mesh, eye)) for eye in before
    ]
    first, *others = _placed("camera", before, cameras, said)
    design = design.replace("optics.camera", first).replace("optics.cameras", tuple(others))
    return design, "; ".join(said)


def ring_room_mm(design: SensorDesign, solid: Solid, ring: LedRing | None = None) -> float:
    """Largest radius of the LED ring in this support [mm]; infinite where rays miss it."""
    from geometry.surface.rays import RayCaster
    from workbench.core.design.leds import led_places

    ring, housing = ring or design.optics.ring, design.housing
    places, _ = led_places(dataclasses.replace(ring, radius_mm=1.0))
    axis = np.array([0.0, 0.0, ring.height_mm])
    caster = RayCaster(solid.support.points_mm, solid.support.faces)
    distance, _, _ = caster.hits(np.broadcast_to(axis, places.shape), places - axis)
    half_mm = math.hypot(housing.led_width_mm, housing.led_height_mm) / 2
    return float(distance.min()) - half_mm - 2 * housing.clearance_mm


def _first(now: Placed, others: Iterable[Placed], check: Callable[[Placed], None]) -> Placed | None:
    """The first that the check takes, what there is now before all others; None if none is."""
    for one in (now, *others):
        try:
            check(one)
        except DesignError as error:
            # A black light is no matter of place.
            if error.at.endswith(("power", "colour", "colours")):
                return now
        else:
            return one
    return None


def _rings(design: SensorDesign, solid: Solid, mesh: MembraneMesh) -> Iterator[LedRing]:
    """Rings with other radii, then at other heights too, the nearest first."""
    ring = design.optics.ring
    base_mm, top_mm = (float(f(mesh.cavity.points_mm[:, 2])) for f in (np.min, np.max))
    others = sorted(LEVELS[2:-2:2] * top_mm, key=lambda height: abs(height - ring.height_mm))
    for height_mm in np.clip([ring.height_mm, *others], base_mm, None):
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
    from sim.optics.camera.inside_skin import wall_radius
    from workbench.core.design.leds import led_places

    places, _ = led_places(ring)
    low_mm = max(wall_radius(mesh.cavity, place) for place in places)
    high_mm = min(wall_radius(mesh.inner, place) for place in places)
    return [(low_mm + high_mm) / 2] if low_mm < high_mm < math.inf else []


def _nearer(item: Placed, mesh: MembraneMesh) -> Iterator[Placed]:
    """A lamp or camera toward the axis at its height, then at other heights, the nearest first."""
    position = np.array(item.position_mm)  # pyright: ignore[reportAttributeAccessIssue]
    low_mm, high_mm = (float(f(mesh.cavity.points_mm[:, 2])) for f in (np.min, np.max))
    low_mm += ABOVE_BASE_MM
    level_mm = max(float(position[2]), low_mm)
    places = [np.array([*(share * position[:2]), level_mm]) for share in SHARES]
    grid = [
        np.array([*(share * position[:2]), low_mm + level * (high_mm - low_mm)])
        for level in LEVELS
        for share in FEW_SHARES
    ]
    places += sorted(grid, key=lambda place: float(np.linalg.norm(place - position)))
    for place in places:
        x, y, z = (round(float(value), 3) for value in place)
        yield dataclasses.replace(item, position_mm=(x, y, z))


def _ring_words(before: LedRing, after: LedRing) -> str:
    words = f"LED ring: radius {after.radius_mm:g} mm instead of {before.radius_mm:g} mm"
    if after.height_mm != before.height_mm:
        words += f", height {after.height_mm:g} mm instead of {before.height_mm:g} mm"
    return f"{words}, to fit inside"


def _placed(
    what: str, before: Sequence[Placed], after: Sequence[Placed | None], said: list[str]
) -> tuple[Placed, ...]:
    """Where each is now, with a word for each that has moved and each that found no place."""
    for number, (old, new) in enumerate(zip(before, after, strict=True), start=1):
        name = f"{what} {number}" if len(before) > 1 else what
        if new is None:
            said.append(f"{name}: no place was found at which it fits")
        elif new != old:
            place = ", ".join(f"{value:g}" for value in new.position_mm)  # pyright: ignore[reportAttributeAccessIssue]
            said.append(f"{name} to ({place}) mm")
    return tuple(new or old for old, new in zip(before, after, strict=True))
