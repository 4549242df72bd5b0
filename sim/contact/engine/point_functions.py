"""Taichi functions of a surface point: where it is, and the force that holds or pushes it.

Their plain twins are in `reference`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false, reportOptionalCall=false

import taichi as ti

from sim.contact.grid.layout import (
    AXIS,
    CHOICES,
    COUNTS,
    FIRST_COEFFICIENT,
    FREE,
    FRICTION,
    HELD_STILL,
    INVERSE_EDGE,
    LIFTED,
    MEETS_RIGID,
    NUMBERS,
    POINT,
    POSE,
    SHAPE,
    SIDEWAYS,
    SIZE,
    STIFFNESS,
    TOUCHED,
)
from sim.contact.objects.shape_distance_functions import signed_distance


@ti.func
def line_weights(local):
    """Weights of the nodes -1, 0, +1 of one axis (`stencil.line_weights`)."""
    return ti.Vector([0.5 * (0.5 - local) ** 2, 0.75 - local * local, 0.5 * (0.5 + local) ** 2])


@ti.func
def body_rotation(poses: ti.template(), row):
    """Rotation body to sensor of a row of the pose table."""
    base = POSE * row + 3
    return ti.Matrix([[poses[base + 3 * r + c] for c in range(3)] for r in range(3)])


@ti.func
def object_distance(
    place, numbers: ti.template(), choices: ti.template(), coefficients: ti.template(), case
):
    """Signed distance of a case's object and its gradient, in the body frame."""
    size = ti.Vector([numbers[NUMBERS * case + SIZE + c] for c in range(8)])
    counts = ti.Vector([choices[CHOICES * case + COUNTS + c] for c in range(3)])
    shape = choices[CHOICES * case + SHAPE]
    first = choices[CHOICES * case + FIRST_COEFFICIENT]
    return signed_distance(place, shape, size, coefficients, counts, first)


@ti.func
def tangent_slip(place, gradient, anchor, limit):
    """Slip from the anchor in the tangent plane, returned to the friction cone."""
    normal = gradient / ti.max(gradient.norm(), 1e-9)
    slip = place - anchor
    slip -= slip.dot(normal) * normal
    length = slip.norm()
    if length > limit:
        slip *= limit / length
    return slip


@ti.func
def place_in_body(
    point, moved, points: ti.template(), poses: ti.template(), rotation: ti.template(), row
):
    place = moved
    for c in ti.static(range(3)):
        place[c] += points[POINT * point + c] - poses[POSE * row + c]
    return rotation.transpose() @ place


@ti.func
def _holding_force(point, moved, points: ti.template(), goals: ti.template(), share):
    """Spring of a held point toward where it belongs, stiffer along its axis than across."""
    axis = ti.Vector([points[POINT * point + AXIS + c] for c in range(3)])
    away = moved
    for c in ti.static(range(3)):
        start, end = goals[6 * point + c], goals[6 * point + 3 + c]
        away[c] -= start + share * (end - start)
    along = axis.dot(away) * axis
    return -points[POINT * point + STIFFNESS] * (
        along + points[POINT * point + SIDEWAYS] * (away - along)
    )


@ti.func
def _contact_force(
    point,
    moved,
    points: ti.template(),
    anchors: ti.template(),
    states: ti.template(),
    poses: ti.template(),
    numbers: ti.template(),
    choices: ti.template(),
    coefficients: ti.template(),
    case,
    row,
):
    """Penalty and friction of the object on the membrane, in the sensor frame [N]."""
    force = ti.Vector([0.0, 0.0, 0.0])
    rotation = body_rotation(poses, row)
    place = place_in_body(point, moved, points, poses, rotation, row)
    distance, gradient = object_distance(place, numbers, choices, coefficients, case)
    if distance < 0.0:
        anchor = place
        if states[point] == FREE:
            states[point] = TOUCHED
            for c in ti.static(range(3)):
                anchors[3 * point + c] = place[c]
        for c in ti.static(range(3)):
            anchor[c] = anchors[3 * point + c]
        limit = -numbers[NUMBERS * case + FRICTION] * distance * gradient.norm()
        slip = tangent_slip(place, gradient, anchor, limit)
        force = -points[POINT * point + STIFFNESS] * (rotation @ (distance * gradient + slip))
    elif states[point] == TOUCHED or distance * numbers[NUMBERS * case + INVERSE_EDGE] > LIFTED:
        states[point] = FREE
    return force


@ti.func
def point_force(
    point,
    moved,
    points: ti.template(),
    held: ti.template(),
    goals: ti.template(),
    anchors: ti.template(),
    states: ti.template(),
    poses: ti.template(),
    numbers: ti.template(),
    choices: ti.template(),
    coefficients: ti.template(),
    case,
    row,
):
    """Force on the membrane at a surface point that has moved by `moved`, sensor frame [N]."""
    force = ti.Vector([0.0, 0.0, 0.0])
    if held[point] == HELD_STILL:
        share = poses[POSE * row + POSE - 1]
        force = _holding_force(point, moved, points, goals, share)
    elif held[point] == MEETS_RIGID:
        force = _contact_force(
            point, moved, points, anchors, states, poses, numbers, choices,
            coefficients, case, row,
        )  # fmt: skip
    return force
