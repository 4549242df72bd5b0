"""Room of the camera module, and the cup that it slides into from the front."""

from __future__ import annotations

import numpy as np

from geometry.body import csg
from geometry.body.csg_mesh import arrays, evaluate
from geometry.housing.led_holder import LEAST_WALL_MM
from geometry.housing.led_room import half_mm, holder_mm
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedRing
from workbench.core.design.making import Housing

FRONT_SHARE = 0.3
"""How much of the camera module stands out of its mount: the lens."""
CABLE_SHARE = 0.5
"""Width of the cable's slot over the module's."""
UPRIGHT_COSINE = 0.9
FAR_MM = 500.0


def cup_front_mm(camera: Camera, ring: LedRing, options: Housing) -> float:
    """How far in front of the optical centre the mount ends [mm], negative: behind it.

    Below the LED ring's seat, where the camera looks up through the ring.
    """
    front = -FRONT_SHARE * options.camera_depth_mm
    if not ring.count:
        return front
    upright = (_rotation(camera) @ [0.0, 0.0, 1.0])[2] > UPRIGHT_COSINE
    low = ring.height_mm - holder_mm(ring, options) - 2.0 * options.clearance_mm
    below = low - camera.position_mm[2]
    # A cup too low to hold the module is worse than one that the ring cuts into.
    return min(front, below) if upright and below > -0.7 * options.camera_depth_mm else front


def module_room(camera: Camera, options: Housing, gap_mm: float) -> csg.Node:
    """Room of the camera module: its front at the optical centre; with a gap, open to the front."""
    x, y = options.camera_width_mm / 2 + gap_mm, options.camera_height_mm / 2 + gap_mm
    back = -options.camera_depth_mm - gap_mm
    box = csg.Box(low_mm=(-x, -y, back), high_mm=(x, y, gap_mm))
    return _at_camera(box, camera)


def cup_outline(camera: Camera, options: Housing, front_mm: float, gap_mm: float) -> csg.Node:
    """Outline of the camera's mount; with a gap, its seat, open to the back."""
    wall = options.clearance_mm + options.wall_mm + gap_mm
    x, y = options.camera_width_mm / 2 + wall, options.camera_height_mm / 2 + wall
    back = -options.camera_depth_mm - options.clearance_mm - options.wall_mm
    if gap_mm:
        back = -FAR_MM
    return _at_camera(csg.Box(low_mm=(-x, -y, back), high_mm=(x, y, front_mm)), camera)


def cup_seat(
    camera: Camera, ring: LedRing, options: Housing, front_mm: float
) -> tuple[csg.Node, ...]:
    """What the mount's seat takes from the base.

    A ledge between it and the ring's seat that is thinner than a wall goes too, but only where the
    ring's seat is: beside it the base keeps its full height above the mount.
    """
    gap = options.clearance_mm
    seat = cup_outline(camera, options, front_mm + gap, gap)
    low_mm = ring.height_mm - holder_mm(ring, options)
    ledge_mm = low_mm - camera.position_mm[2] - front_mm - 2.0 * gap
    if not ring.count or not 0.0 <= ledge_mm < LEAST_WALL_MM:
        return (seat,)
    higher = cup_outline(camera, options, front_mm + gap + LEAST_WALL_MM, gap)
    outside_mm = ring.radius_mm + half_mm(options) + gap
    if np.linalg.norm(arrays(evaluate(higher))[0][:, :2], axis=1).max() <= outside_mm:
        return (higher,)
    around = csg.cylinder(outside_mm, -FAR_MM, FAR_MM)
    return seat, csg.Intersection(body=higher, other=around)


def cable_slot(camera: Camera, options: Housing) -> csg.Node:
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
