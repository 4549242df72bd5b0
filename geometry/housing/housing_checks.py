"""Checks of the rigid parts: gaps around LEDs and camera, walls, room on the printer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.body.csg import Node
from geometry.body.csg_mesh import closed, evaluate
from geometry.housing.holder_seat import seat_gap
from geometry.housing.led_holder import LEAST_WALL_MM
from geometry.mould.castability import Worst
from geometry.mould.fabricate import Made
from geometry.mould.print_checks import Bound, PrintLimits, bed_check, check, wall_check
from geometry.mould.walls import thinnest_wall
from geometry.surface.rays import RayCaster
from geometry.surface.surface import closest_point
from workbench.core.design.making import Housing, Printer
from workbench.core.result.fabrication import FabricationCheck, FabricationPart, Severity
from workbench.core.result.results import Label, LabelledSurface, Solid

SEARCH_MM = 50.0
"""Gaps wider than this are not measured [mm]."""

HOUSING_LIMITS = PrintLimits(
    LEAST_WALL_MM,
    thin="raise housing.wall_mm, or move the LED ring or the camera away from what is near it",
    large="lower housing.wall_mm or the shape's own sizes, or use a larger printer",
)
SPOT_MM = 0.01
"""Size of a place that gaps are measured from [mm]."""
BESIDE_MM = 0.3
"""What a pocket is wider than its LED and the clearance, at most, where it is open [mm]."""
LARGEST_DROP_MM = 1.0
"""What glue under a part still fills [mm]."""
MOST_LOST = 0.01
"""Share of a part that may be left away as crumbs between cuts [1]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Bought:
    """Rooms of the bought parts, without gaps."""

    module: Node
    """Of the camera module."""
    leds: tuple[Node, ...]
    """Of each LED."""


def housing_checks(
    made: Sequence[Made],
    solid: Solid,
    bought: Bought,
    options: Housing,
    *,
    in_shell: bool,
    printer: Printer,
) -> tuple[FabricationCheck, ...]:
    """Gaps around the bought parts, and walls and sizes of the printed ones.

    Args:
        made: The printed parts, with what was left away of each in loose pieces.
        solid: The bodies of the design.
        bought: Rooms of camera module and LEDs.
        options: Clearances and walls.
        in_shell: Whether LEDs touch the support on purpose, to feed light into it.
        printer: That prints the parts.
    """
    parts = [one.part for one in made]
    walls = [solid.membrane] if in_shell else [solid.membrane, solid.support]
    shells = [closed("shell", surface.points_mm, surface.faces) for surface in walls]
    camera = evaluate(bought.module)
    lights = [evaluate(led) for led in bought.leds]
    cavity = Cavity(solid.membrane)
    checks = [_camera_clearance(camera, shells, cavity, solid, options)]
    if lights:
        clearance = _led_clearance(lights, [*shells, camera], cavity, options)
        checks = [clearance, *checks, _holder_seat(parts, options)]
    for part in parts:
        edge, limits = thinnest_wall(part.points_mm, part.faces, edges=True), HOUSING_LIMITS
        if part.name == "led_ring_holder":
            shell = closed("support", solid.support.points_mm, solid.support.faces)
            limits = limits._replace(thin=holder_advice(edge, lights, shell, options))
        checks.append(_wall(part, edge, limits, printer))
        checks.append(bed_check(part, printer.bed_mm, limits))
    checks += [_whole(one.part.name, one.lost) for one in made if one.lost.value > 0.0]
    return tuple(checks)


def holder_advice(wall: Worst, lights: Sequence[Any], support: Any, options: Housing) -> str:
    """What makes a thin wall of the LEDs' holder thicker, from what it is between.

    More of `housing.wall_mm` does not help between two pockets, nor between a pocket and the
    cavity's wall, where the holder cannot grow.

    Args:
        wall: Its value and middle.
        lights: Room of each LED.
    """
    import manifold3d

    spot = manifold3d.Manifold.cube((SPOT_MM, SPOT_MM, SPOT_MM), True).translate(wall.place_mm)
    reach_mm = wall.value / 2 + options.clearance_mm + BESIDE_MM
    near = [light for light in lights if _gap(light, spot) < reach_mm]
    smaller = "use smaller LEDs (housing.led_width_mm and led_height_mm)"
    if len(near) > 1:
        return (
            "it is between the pockets of two LEDs: lower optics.ring.count, raise "
            f"optics.ring.radius_mm where there is room, or {smaller}"
        )
    if not near or _gap(support, spot) > reach_mm:
        return HOUSING_LIMITS.thin
    x, y, _ = _centre(near[0])
    if np.hypot(x, y) > np.hypot(*wall.place_mm[:2]):
        return HOUSING_LIMITS.thin
    # Pockets leave the wall at up to 35 degrees to the ring's radius: 1.2 is one over the cosine.
    nearer_mm = np.ceil(12.0 * (LEAST_WALL_MM - wall.value)) / 10.0
    return (
        "it is between the pocket of an LED and the wall of the cavity: lower "
        f"optics.ring.radius_mm by {nearer_mm:.1f} mm, or {smaller}"
    )


def _whole(name: str, lost: Worst) -> FabricationCheck:
    """Whether cuts have parted more than crumbs from a part."""
    return check(
        "loose_pieces",
        name,
        lost,
        Bound(limit=MOST_LOST, unit="of its volume", bad=MOST_LOST),
        message="camera, LEDs or shell cut the part in two: use a smaller camera module, move it "
        "by optics.camera.position_mm, or make room for it in the shape",
    )


def _wall(
    part: FabricationPart, edge: Worst, limits: PrintLimits, printer: Printer
) -> FabricationCheck:
    """Thinnest wall of a part, or a knife edge: that can be made, but chips and lets light by.

    Args:
        edge: The thinnest place, edges counted.
    """
    if edge.value >= limits.wall_mm:
        return wall_check(part.name, edge, limits, printer.feature_mm)
    wall = wall_check(
        part.name, thinnest_wall(part.points_mm, part.faces), limits, printer.feature_mm
    )
    if wall.severity is Severity.BAD:
        return wall
    return wall_check(part.name, edge, limits, None)


class Cavity:
    """The room below a skin: what is bought must be there, or in the foot under it."""

    def __init__(self, membrane: LabelledSurface) -> None:
        self.membrane = membrane
        self.caster = RayCaster(membrane.points_mm, membrane.faces)

    def outside_mm(self, place_mm: tuple[float, float, float]) -> float:
        """How far a place is from what the cavity is under [mm]; 0 inside it.

        Straight up from a place in the cavity, or under it, the first that is met of the skin is
        neither its outside nor its base.
        """
        start = np.array([place_mm])
        face = int(self.caster.hits(start, np.array([[0.0, 0.0, 1.0]]))[1][0])
        away = self.membrane.has(Label.OUTER) | self.membrane.has(Label.BASE)
        if face >= 0 and not away[face]:
            return 0.0
        points, faces = self.membrane.points_mm, self.membrane.faces[~away]
        return float(closest_point(points, faces, start)[1][0])

    def room_mm(self, place_mm: tuple[float, float, float], gap_mm: float) -> float:
        """The gap of what stands at a place; below 0 where that is not in the cavity at all."""
        outside_mm = self.outside_mm(place_mm)
        return min(gap_mm, -outside_mm) if outside_mm else gap_mm


def _led_clearance(
    lights: list[Any], others: list[Any], cavity: Cavity, options: Housing
) -> FabricationCheck:
    """Smallest gap between an LED and support, skin, camera or the next LED."""
    gaps = []
    for number, light in enumerate(lights):
        following = [lights[(number + 1) % len(lights)]] if len(lights) > 1 else []
        gap = min(_gap(light, other) for other in [*others, *following])
        gaps.append(Worst(cavity.room_mm(_centre(light), gap), _centre(light)))
    return check(
        "led_clearance",
        "led_ring_holder",
        min(gaps, key=lambda gap: gap.value),
        Bound(limit=options.clearance_mm, unit="mm", sense="min", bad=0.0),
        message="change optics.ring.radius_mm or height_mm, lower its count, or use smaller LEDs",
    )


def _camera_clearance(
    camera: Any, shells: list[Any], cavity: Cavity, solid: Solid, options: Housing
) -> FabricationCheck:
    """Smallest gap between the module and support or skin, or left below its mount in the foot."""
    gap = cavity.room_mm(_centre(camera), min(_gap(camera, shell) for shell in shells))
    box = camera.bounding_box()
    bottom = box[2] - options.clearance_mm - options.wall_mm
    below = float(bottom - solid.base.points_mm[:, 2].min())
    return check(
        "camera_clearance",
        "camera_mount",
        Worst(min(gap, below), _centre(camera)),
        Bound(limit=options.clearance_mm, unit="mm", sense="min", bad=0.0),
        message="move optics.camera.position_mm, raise shape.base_height_mm or take a smaller one",
    )


def _holder_seat(parts: Sequence[FabricationPart], options: Housing) -> FabricationCheck:
    """How far the holder of the LEDs is above what it stands on."""
    named = {part.name: part for part in parts}
    holder, base = (
        closed(name, named[name].points_mm, named[name].faces)
        for name in ("led_ring_holder", "housing_base")
    )
    gap = seat_gap(holder, base)
    return check(
        "led_holder_seat",
        "led_ring_holder",
        # The parts' triangles are good to a thousandth.
        gap._replace(value=round(gap.value, 3)),
        Bound(limit=options.clearance_mm, unit="mm", bad=LARGEST_DROP_MM),
        message="nothing under it carries it: lower optics.ring.height_mm, or bring "
        "optics.ring.radius_mm nearer to the wall of the cavity, or use a smaller camera module",
    )


def _gap(one: Any, other: Any) -> float:
    """Distance of two manifolds [mm], or minus the cube root of their overlap's volume."""
    shared = float((one ^ other).volume())
    return -(shared ** (1 / 3)) if shared > 1e-9 else float(one.min_gap(other, SEARCH_MM))


def _centre(solid: Any) -> tuple[float, float, float]:
    box = np.array(solid.bounding_box())
    x, y, z = (float(value) for value in (box[:3] + box[3:]) / 2)
    return x, y, z
