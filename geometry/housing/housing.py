"""The rigid parts of the finished sensor: support, LED ring holder, camera mount and base.

What is bought (camera module, LEDs) takes its room first; each printed part is then cut by the
grown outlines of those before it, so nothing overlaps. Parts:

- `support`: the design's transparent shell, as it is;
- `led_ring_holder`: a ring under the LEDs with a pocket for each, see `led_holder`; none without;
- `camera_mount`: a cup on the camera's axis that the module slides into from the front;
- `housing_base`: the design's foot (`Solid.base`) with seats for holder and mount, open to below
  for the mount; with a sleeve up to a holder that would float above it, see `holder_seat`;
- `slider_0`, ...: for bodies with actuators, see `actuation`.

Leaves out: wiring, screws between the parts, cable glands.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geometry.body import csg
from geometry.body.csg_mesh import arrays, evaluate
from geometry.housing.actuation import ActuatorRod, make_rods
from geometry.housing.camera_mount import (
    cable_slot,
    cup_front_mm,
    cup_outline,
    cup_seat,
    module_room,
)
from geometry.housing.holder_seat import holder_seat
from geometry.housing.housing_checks import Bought, housing_checks
from geometry.housing.led_holder import LEAST_WALL_MM, Shells, shaped_holder
from geometry.housing.led_room import hole_mm, led_rooms, ring_outline
from geometry.housing.supplies import camera_module
from geometry.mould.fabricate import Made, PartPlan, fabricate, largest
from geometry.mould.walls import thinnest_wall
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedMount, LedRing
from workbench.core.design.making import Housing, Printer
from workbench.core.result.fabrication import HousingSet, PartGroup
from workbench.core.result.results import LabelledSurface, Solid

TOUCH_MM3 = 1e-9
APART_MM = 12.0
CLEAR_RESIN = "print in clear resin, polish"
TOUGH = "3D print, opaque"


def make_housing(
    solid: Solid,
    options: Housing,
    *,
    ring: LedRing,
    camera: Camera,
    printer: Printer,
    monitor: Monitor = silent,
) -> HousingSet:
    """Make the rigid parts of a sensor.

    Args:
        ring: Of the LEDs; power, colours and emission are not looked at.
        camera: Only its pose is looked at.
        printer: That prints the parts.

    Raises:
        GeometryError: If a part does not come out as one body.
    """
    rods = make_rods(solid, options)
    bought = Bought(module=module_room(camera, options, 0.0), leds=led_rooms(ring, options, 0.0))
    nodes = _nodes(solid, options, ring, camera, rods)
    places = _exploded(solid, rods)
    processes = {"support": CLEAR_RESIN, **{rod.name: f"{TOUGH}; {rod.title}" for rod in rods}}
    made: list[Made] = []
    for number, (name, node) in enumerate(nodes.items()):
        monitor(0.8 * number / len(nodes), f"making {name}")
        part = PartPlan(
            name=name,
            node=node,
            group=PartGroup.SENSOR,
            explode=places[name],
            process=processes.get(name, TOUGH),
            brep=solid.support_brep if name == "support" else None,
        )
        made.append(fabricate(part, keep_largest=True))
    monitor(0.8, "checking")
    checks = housing_checks(
        made, solid, bought, options, in_shell=ring.mount is LedMount.SHELL, printer=printer
    )
    return HousingSet(
        parts=tuple(one.part for one in made),
        checks=checks,
        notice="; ".join(one.reason for one in made if one.reason),
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
    module = module_room(camera, options, gap)
    front_mm = cup_front_mm(camera, ring, options)
    # Without LEDs nothing holds them and nothing makes room for that.
    seats = [ring_outline(ring, options, gap)] if ring.count else []
    leds = led_rooms(ring, options, gap)
    cup = cup_outline(camera, options, front_mm, 0.0)
    foot = csg.together(_body(solid.base, solid.base_brep), [rod.guide for rod in rods])
    below = [*cup_seat(camera, ring, options, front_mm), cable_slot(camera, options), module]
    base = _cut(foot, [*shells, *seats, *below, *(rod.bore for rod in rods)])
    made = {
        "support": _cut(support, [membrane]),
        "camera_mount": _cut(cup, [*shells, *seats, module, cable_slot(camera, options)]),
        "housing_base": base,
        **{rod.name: _cut(rod.body, [membrane]) for rod in rods},
    }
    if not ring.count:
        return made
    holder = _holder(ring, options, shells, module, leds)
    sleeve = holder_seat(
        holder,
        base,
        Shells(bodies=(membrane, support), gap_mm=gap),
        below,
        hole_mm=hole_mm(ring, options),
        wall_mm=max(options.wall_mm, LEAST_WALL_MM),
    )
    return {
        "support": made.pop("support"),
        "led_ring_holder": holder,
        **made,
        "housing_base": csg.together(base, sleeve),
    }


def _holder(
    ring: LedRing,
    options: Housing,
    shells: Sequence[csg.Node],
    module: csg.Node,
    leds: tuple[csg.Node, ...],
) -> csg.Node:
    """The ring less all it must clear; shaped anew if that leaves walls thinner than can be."""
    whole = ring_outline(ring, options, 0.0)
    plain = _cut(whole, [*shells, module, *leds])
    if _wall_mm(plain) >= LEAST_WALL_MM:
        return plain
    shaped = shaped_holder(
        whole,
        Shells(bodies=tuple(shells[:2]), gap_mm=options.clearance_mm),
        module,
        leds,
        wall_mm=LEAST_WALL_MM,
        tilt_deg=ring.tilt_deg,
    )
    return plain if shaped is None or _wall_mm(shaped) <= _wall_mm(plain) else shaped


def _wall_mm(node: csg.Node) -> float:
    """Thinnest wall or edge of a body's largest piece [mm]; 0 for nothing."""
    solid = largest(evaluate(node))[0]
    return 0.0 if solid.is_empty() else thinnest_wall(*arrays(solid), edges=True).value


def _cut(body: csg.Node, tools: Sequence[csg.Node]) -> csg.Node:
    """The body less those tools that meet it; the others would only slow the CAD kernel down."""
    solid = evaluate(body)
    meeting = [tool for tool in tools if (solid ^ evaluate(tool)).volume() > TOUCH_MM3]
    return csg.without(body, meeting)


def _body(surface: LabelledSurface, brep: np.ndarray) -> csg.Body:
    return csg.Body(points_mm=surface.points_mm, faces=surface.faces, brep=brep)


def _exploded(solid: Solid, rods: tuple[ActuatorRod, ...]) -> dict[str, tuple[float, float, float]]:
    height = float(np.ptp(solid.support.points_mm[:, 2])) + APART_MM
    foot = float(np.ptp(solid.base.points_mm[:, 2])) + APART_MM
    return {
        "support": (0.0, 0.0, height),
        "led_ring_holder": (0.0, 0.0, APART_MM),
        "camera_mount": (0.0, 0.0, -2.0 * foot),
        "housing_base": (0.0, 0.0, 0.0),
        **{rod.name: rod.explode for rod in rods},
    }
