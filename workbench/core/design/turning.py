"""How an object is turned before it is pressed: angles about the fixed axes X, then Y, then Z.

The rotation is R = Rz(c) Ry(b) Rx(a); a place p of the object as it came lies at R p afterwards.
Its -Z side then meets the skin. Source of the angles of a matrix: Diebel, Representing attitude,
2006, sequence (1, 2, 3) of fixed axes.
"""

from __future__ import annotations

import math

import numpy as np

Angles = tuple[float, float, float]
"""Degrees about X, Y and Z."""

AS_IT_CAME: Angles = (0.0, 0.0, 0.0)
FARTHEST_DEG = 360.0
DECIMALS = 3
"""Of angles that are found: a thousandth of a degree moves nothing by a micrometre."""
UPRIGHT_SINE = 1.0 - 1e-9
"""Sine of the middle angle from which the outer two are about one axis."""


def turn_matrix(turn_deg: Angles) -> np.ndarray:
    """Rotation matrix, shape (3, 3); quarter turns are exact."""
    (ca, sa), (cb, sb), (cc, sc) = (
        (math.cos(math.radians(angle)), math.sin(math.radians(angle))) for angle in turn_deg
    )
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, ca, -sa], [0.0, sa, ca]])
    about_y = np.array([[cb, 0.0, sb], [0.0, 1.0, 0.0], [-sb, 0.0, cb]])
    about_z = np.array([[cc, -sc, 0.0], [sc, cc, 0.0], [0.0, 0.0, 1.0]])
    # Adding zero turns minus zero into zero.
    return np.round(about_z @ about_y @ about_x, 15) + 0.0


def turn_angles(rotation: np.ndarray) -> Angles:
    """The angles of a rotation matrix, shape (3, 3), in degrees from -180 to 180.

    Where Y turns by a quarter, X and Z are about one axis: then Z is 0.
    """
    sine = -float(rotation[2, 0])
    if abs(sine) < UPRIGHT_SINE:
        first = math.atan2(rotation[2, 1], rotation[2, 2])
        last = math.atan2(rotation[1, 0], rotation[0, 0])
    else:
        first, last = math.atan2(-rotation[1, 2], rotation[1, 1]), 0.0
    middle = math.asin(max(-1.0, min(1.0, sine)))
    x, y, z = (round(math.degrees(angle), DECIMALS) + 0.0 for angle in (first, middle, last))
    return x, y, z


def touching_with(turn_deg: Angles, normal: np.ndarray) -> Angles:
    """The turn that lets a face touch: its normal is -Z afterwards, by the shortest way there.

    Args:
        turn_deg: How the object is turned now.
        normal: Outward normal of the face as it stands now, shape (3,).
    """
    unit = np.asarray(normal, dtype=np.float64) / np.linalg.norm(normal)
    down = np.array([0.0, 0.0, -1.0])
    axis, cosine = np.cross(unit, down), float(unit @ down)
    if cosine < -UPRIGHT_SINE:
        # Straight up: over by half a turn about X.
        way = np.diag([1.0, -1.0, -1.0])
    else:
        x, y, z = axis
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        way = np.eye(3) + cross + cross @ cross / (1.0 + cosine)
    return turn_angles(way @ turn_matrix(turn_deg))
