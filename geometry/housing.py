"""The rigid parts of the finished sensor: support, LED ring holder, camera mount and base.

What is bought (camera module, LEDs) takes its room first; each printed part is then cut by the
grown outlines of those before it, so nothing overlaps. Parts:

- `support`: the design's transparent shell, as it is;
- `led_ring_holder`: a ring under the LEDs with a pocket for each, see `led_holder`;
- `camera_mount`: a cup on the camera's axis that the module slides into from the front;
- `base`: the design's foot with seats for holder and mount, open to below for the mount; with a
  sleeve up to a holder that would float above it, see `holder_seat`;
- `slider_0`, ...: for bodies with actuators, see `actuation`.

Leaves out: wiring, screws between the parts, cable glands.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry import csg
from geometry.actuation import ActuatorRod, make_rods
from geometry.castability import Worst, thinnest_wall
from geometry.csg_mesh import arrays, evaluate
from geometry.fabricate import fabricate, largest
from geometry.holder_seat import holder_seat
from geometry.housing_checks import LEAST_WALL_MM, housing_checks
from geometry.led_holder import SPARE_MM, shaped_holder
from geometry.supplies import camera_module
from workbench.core.design import Camera, LedMount, LedRing
from workbench.core.fabrication import FabricationPart, HousingSet, PartGroup
from workbench.core.leds import led_places
from workbench.core.making import Housing
from workbench.core.monitor import Monitor, silent
from workbench.core.results import LabelledSurface, Solid

LED_DEPTH_MM = 0.8
"""Height of an LED with its solder. Source: WS2812 packages are 0.5 to 0.7 mm high."""
FLOOR_MM = 1.2
"""Material under the LEDs: three layers of a resin print or a flexible circuit [mm]."""
FRONT_SHARE = 0.3
"""How much of the camera module stands out of its mount: the lens."""
CABLE_SHARE = 0.5
"""Width of the cable's slot over the module's."""
TOUCH_MM3 = 1e-9
UPRIGHT_COSINE = 0.9
APART_MM = 12.0
FAR_MM = 500.0
CLEAR_RESIN = "print in clear resin, polish"
TOUGH = "3D print, opaque"


@dataclass(frozen=True, kw_only=True, slots=True)
class Bought:
    """Rooms of the bought parts, without gaps."""

    module: csg.Node
    leds: tuple[csg.Node, ...]


def make_housing(
    solid: Solid,
    options: Housing,
    *,
    ring: LedRing,
    camera: Camera,
    bed_mm: tuple[float, float, float],
    monitor: Monitor = silent,
) -> HousingSet:
    """Make the rigid parts of a sensor.

    Args:
        ring: Of the LEDs; power, colours and emission are not looked at.
        camera: Only its pose is looked at.
        bed_mm: Room of the printer.

    Raises:
        GeometryError: If a part does not come out as one body.
    """
    rods = make_rods(solid, options)
    bought = Bought(module=_module(camera, options, 0.0), leds=_leds(ring, options, 0.0))
    nodes = _nodes(solid, options, ring, camera, rods)
    places = _exploded(solid, rods)
    processes = {"support": CLEAR_RESIN, **{rod.name: f"{TOUGH}; {rod.title}" for rod in rods}}
    parts: list[FabricationPart] = []
    reasons: list[str] = []
    lost: dict[str, Worst] = {}
    for number, (name, node) in enumerate(nodes.items()):
        monitor(0.8 * number / len(nodes), f"making {name}")
        made = fabricate(
            name,
            node,
            group=PartGroup.SENSOR,
            explode=places[name],
            process=processes.get(name, TOUGH),
            keep_largest=True,
            brep=solid.support_brep if name == "support" else None,
        )
        parts.append(made.part)
        lost[name] = made.lost
        reasons += [made.reason] if made.reason else []
    monitor(0.8, "checking")
    checks = housing_checks(
        parts,
        solid,
        bought.module,
        bought.leds,
        options,
        in_shell=ring.mount is LedMount.SHELL,
        bed_mm=bed_mm,
        lost=lost,
    )
    return HousingSet(
        parts=tuple(parts),
        checks=checks,
        notice="; ".join(reasons),
        bought=(camera_module(options),),
    )


def _nodes(
    solid: Solid, options: Housing, ring: LedRing, camera: Camera, rods: tuple[ActuatorRod, ...]
) -> dict[str, csg.Node]:
    gap = options.clearance_mm
    # Without its B-rep: only parts that do not fit meet the skin, and cutting splines is slow.
    membrane = csg.Body(points_mm=solid.membrane.points_mm, faces=solid.membrane.faces)
    support = _body(solid.support, solid.support_brep)
    # The support a hair smaller lies inside its own cavity: what it takes away is the gap.
    reach = ring.radius_mm + options.led_width_mm / 2 + options.wall_mm
    shrunk = csg.scaled(support, 1.0 - 2.0 * gap / max(reach, 1.0), (0.0, 0.0, 0.0))
    shells = [membrane, support, shrunk]
    module = _module(camera, options, gap)
    front_mm = _cup_front_mm(camera, ring, options)
    seat = _ring(ring, options, gap)
    leds = _leds(ring, options, gap)
    cup = _cup(camera, options, front_mm, 0.0)
    foot = csg.together(_body(solid.base, solid.base_brep), [rod.guide for rod in rods])
    room = [seat, *_cup_seat(camera, ring, options, front_mm), _cable(camera, options), module]
    holder = _holder(ring, options, shells, module, leds)
    base = _cut(foot, [*shells, *room, *(rod.bore for rod in rods)])
    sleeve = holder_seat(
        holder,
        base,
        [membrane, support],
        room[1:],
        hole_mm=_hole_mm(ring, options),
        gap_mm=gap,
        wall_mm=max(options.wall_mm, LEAST_WALL_MM),
        least_mm=LEAST_WALL_MM,
    )
    return {
        "support": _cut(support, [membrane]),
        "led_ring_holder": holder,
        "camera_mount": _cut(cup, [*shells, seat, module, _cable(camera, options)]),
        "base": csg.together(base, sleeve),
        **{rod.name: _cut(rod.body, [membrane]) for rod in rods},
    }


def _holder(
    ring: LedRing,
    options: Housing,
    shells: Sequence[csg.Node],
    module: csg.Node,
    leds: tuple[csg.Node, ...],
) -> csg.Node:
    """The ring less all it must clear; shaped anew if that leaves walls thinner than can be."""
    whole = _ring(ring, options, 0.0)
    plain = _cut(whole, [*shells, module, *leds])
    if _wall_mm(plain) >= LEAST_WALL_MM:
        return plain
    shaped = shaped_holder(
        whole,
        shells[:2],
        module,
        leds,
        gap_mm=options.clearance_mm,
        wall_mm=LEAST_WALL_MM,
        tilt_deg=ring.tilt_deg,
    )
    return plain if shaped is None or _wall_mm(shaped) <= _wall_mm(plain) else shaped


def _wall_mm(node: csg.Node) -> float:
    """Thinnest wall of a body's largest piece [mm]; 0 for nothing."""
    solid = largest(evaluate(node))[0]
    return 0.0 if solid.is_empty() else thinnest_wall(*arrays(solid)).value


def _cut(body: csg.Node, tools: Sequence[csg.Node]) -> csg.Node:
    """The body less those tools that meet it; the others would only slow the CAD kernel down."""
    solid = evaluate(body)
    meeting = [tool for tool in tools if (solid ^ evaluate(tool)).volume() > TOUCH_MM3]
    return csg.without(body, meeting)


def _cup_front_mm(camera: Camera, ring: LedRing, options: Housing) -> float:
    """How far in front of the optical centre the mount ends [mm], negative: behind it.

    Below the LED ring's seat, where the camera looks up through the ring.
    """
    front = -FRONT_SHARE * options.camera_depth_mm
    upright = (_rotation(camera) @ [0.0, 0.0, 1.0])[2] > UPRIGHT_COSINE
    low = ring.height_mm - _holder_mm(ring, options) - 2.0 * options.clearance_mm
    below = low - camera.position_mm[2]
    # A cup too low to hold the module is worse than one that the ring cuts into.
    return min(front, below) if upright and below > -0.7 * options.camera_depth_mm else front


def _body(surface: LabelledSurface, brep: np.ndarray) -> csg.Body:
    return csg.Body(points_mm=surface.points_mm, faces=surface.faces, brep=brep)


def _module(camera: Camera, options: Housing, gap_mm: float) -> csg.Node:
    """Room of the camera module: its front at the optical centre; with a gap, open to the front."""
    x, y = options.camera_width_mm / 2 + gap_mm, options.camera_height_mm / 2 + gap_mm
    back = -options.camera_depth_mm - gap_mm
    box = csg.Box(low_mm=(-x, -y, back), high_mm=(x, y, gap_mm))
    return _at_camera(box, camera)


def _cup(camera: Camera, options: Housing, front_mm: float, gap_mm: float) -> csg.Node:
    """Outline of the camera's mount; with a gap, its seat, open to the back."""
    wall = options.clearance_mm + options.wall_mm + gap_mm
    x, y = options.camera_width_mm / 2 + wall, options.camera_height_mm / 2 + wall
    back = -options.camera_depth_mm - options.clearance_mm - options.wall_mm
    if gap_mm:
        back = -FAR_MM
    return _at_camera(csg.Box(low_mm=(-x, -y, back), high_mm=(x, y, front_mm)), camera)


def _cup_seat(
    camera: Camera, ring: LedRing, options: Housing, front_mm: float
) -> tuple[csg.Node, ...]:
    """What the mount's seat takes from the base.

    A ledge between it and the ring's seat that is thinner than a wall goes too, but only where the
    ring's seat is: beside it the base keeps its full height above the mount.
    """
    gap = options.clearance_mm
    seat = _cup(camera, options, front_mm + gap, gap)
    low_mm = ring.height_mm - _holder_mm(ring, options)
    ledge_mm = low_mm - camera.position_mm[2] - front_mm - 2.0 * gap
    if not 0.0 <= ledge_mm < LEAST_WALL_MM:
        return (seat,)
    higher = _cup(camera, options, front_mm + gap + LEAST_WALL_MM, gap)
    outside_mm = ring.radius_mm + _half_mm(options) + gap
    if np.linalg.norm(arrays(evaluate(higher))[0][:, :2], axis=1).max() <= outside_mm:
        return (higher,)
    around = csg.cylinder(outside_mm, -FAR_MM, FAR_MM)
    return seat, csg.Intersection(body=higher, other=around)


def _cable(camera: Camera, options: Housing) -> csg.Node:
    """Slot for the camera's flat cable, out of the back."""
    x = CABLE_SHARE * options.camera_width_mm / 2
    y = CABLE_SHARE * options.camera_height_mm / 4
    box = csg.Box(low_mm=(-x, -y, -FAR_MM), high_mm=(x, y, -options.camera_depth_mm))
    return _at_camera(box, camera)


def _at_camera(node: csg.Node, camera: Camera) -> csg.Node:
    matrix = np.column_stack([_rotation(camera), camera.position_mm])
    return csg.Placed(body=node, matrix=matrix)


def _rotation(camera: Camera) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    w, x, y, z = camera.wxyz
    return Rotation.from_quat([x, y, z, w]).as_matrix()


def _leds(ring: LedRing, options: Housing, gap_mm: float) -> tuple[csg.Node, ...]:
    """Room of each LED behind its emitting face; with a gap, a pocket open to the front."""
    x, y = options.led_width_mm / 2 + gap_mm, options.led_height_mm / 2 + gap_mm
    front = options.wall_mm if gap_mm else 0.0
    box = csg.Box(low_mm=(-x, -y, -LED_DEPTH_MM), high_mm=(x, y, front))
    found = []
    for place, axis in zip(*led_places(ring), strict=True):
        outward = np.array([place[0], place[1], 0.0])
        if not outward.any():
            found.append(csg.along(box, axis, place))
            continue
        around = np.cross([0.0, 0.0, 1.0], outward / np.linalg.norm(outward))
        frame = np.column_stack([np.cross(around, axis), around, axis, place])
        found.append(csg.Placed(body=box, matrix=frame))
    return tuple(found)


def _ring(ring: LedRing, options: Housing, gap_mm: float) -> csg.Node:
    """Outline of the LEDs' ring; with a gap, its seat."""
    top = ring.height_mm + gap_mm
    low = ring.height_mm - _holder_mm(ring, options) - gap_mm
    disc = csg.cylinder(ring.radius_mm + _half_mm(options) + gap_mm, low, top)
    hole = _hole_mm(ring, options, gap_mm)
    if hole <= 0.0:
        return disc
    return csg.without(disc, [csg.cylinder(hole, low - 1.0, top + 1.0)])


def _holder_mm(ring: LedRing, options: Housing) -> float:
    """Height of the LEDs' holder: enough for a wall below the pockets of tilted LEDs.

    The lowest corner of an LED of width w tilted by t is sin t (w / 2 + gap) + cos t depth below.
    """
    tilt = np.radians(min(abs(ring.tilt_deg), 90.0))
    beside = options.led_width_mm / 2 + options.clearance_mm
    corner = np.sin(tilt) * beside + np.cos(tilt) * LED_DEPTH_MM
    return max(LED_DEPTH_MM + FLOOR_MM, float(corner) + LEAST_WALL_MM + SPARE_MM)


def _half_mm(options: Housing) -> float:
    """Half the width of the LEDs' ring."""
    return max(options.led_width_mm, options.led_height_mm) / 2 + options.wall_mm


def _hole_mm(ring: LedRing, options: Housing, gap_mm: float = 0.0) -> float:
    """Radius of the hole of the LEDs' ring; 0 where it is too small to be made."""
    hole = ring.radius_mm - _half_mm(options) - gap_mm
    return 0.0 if hole <= options.wall_mm else hole


def _exploded(solid: Solid, rods: tuple[ActuatorRod, ...]) -> dict[str, tuple[float, float, float]]:
    height = float(np.ptp(solid.support.points_mm[:, 2])) + APART_MM
    foot = float(np.ptp(solid.base.points_mm[:, 2])) + APART_MM
    return {
        "support": (0.0, 0.0, height),
        "led_ring_holder": (0.0, 0.0, APART_MM),
        "camera_mount": (0.0, 0.0, -2.0 * foot),
        "base": (0.0, 0.0, 0.0),
        **{rod.name: rod.explode for rod in rods},
    }
