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
    KINETIC,
    LIFTED,
    MEETS_RIGID,
    NUMBERS,
    POINT,
    POSE,
    SHAPE,
    SIDEWAYS,
    SIZE,
    SLID,
    STIFFNESS,
    TOUCHED,
)
from sim.contact.objects.shape_distance_functions import signed_distance


@ti.func
def line_weights(local):
    """Weights of the nodes -1, 0, +1 of one axis (`stencil.line_weights`)."""
    return ti.Vector([0.5 * (0.5 - local) ** 2, 0.75 - local * local, 0.5 * (0.5 + local) ** 2])


@ti.func
def body_rotation(cases: ti.template(), row):
    """Rotation body to sensor of a row of the pose table."""
    base = POSE * row + 3
    return ti.Matrix([[cases.poses[base + 3 * r + c] for c in range(3)] for r in range(3)])


@ti.func
def object_distance(place, cases: ti.template(), case):
    """Signed distance of a case's object and its gradient, in the body frame."""
    size = ti.Vector([cases.numbers[NUMBERS * case + SIZE + c] for c in range(8)])
    counts = ti.Vector([cases.choices[CHOICES * case + COUNTS + c] for c in range(3)])
    shape = cases.choices[CHOICES * case + SHAPE]
    first = cases.choices[CHOICES * case + FIRST_COEFFICIENT]
    return signed_distance(place, shape, size, cases.coefficients, counts, first)


@ti.func
def friction_now(point, surface: ti.template(), cases: ti.template(), case):
    """Coefficient of a point: kinetic where it slid in the last settled state, else static."""
    found = cases.numbers[NUMBERS * case + FRICTION]
    if surface.states[point] == SLID:
        found = cases.numbers[NUMBERS * case + KINETIC]
    return found


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
    point, moved, surface: ti.template(), cases: ti.template(), rotation: ti.template(), row
):
    place = moved
    for c in ti.static(range(3)):
        place[c] += surface.points[POINT * point + c] - cases.poses[POSE * row + c]
    return rotation.transpose() @ place


@ti.func
def _holding_force(point, moved, surface: ti.template(), share):
    """Spring of a held point toward where it belongs, stiffer along its axis than across."""
    axis = ti.Vector([surface.points[POINT * point + AXIS + c] for c in range(3)])
    away = moved
    for c in ti.static(range(3)):
        start, end = surface.goals[6 * point + c], surface.goals[6 * point + 3 + c]
        away[c] -= start + share * (end - start)
    along = axis.dot(away) * axis
    return -surface.points[POINT * point + STIFFNESS] * (
        along + surface.points[POINT * point + SIDEWAYS] * (away - along)
    )


@ti.func
def _contact_force(point, moved, surface: ti.template(), cases: ti.template(), case, row):
    """Penalty and friction of the object on the membrane, in the sensor frame [N]."""
    force = ti.Vector([0.0, 0.0, 0.0])
    rotation = body_rotation(cases, row)
    place = place_in_body(point, moved, surface, cases, rotation, row)
    distance, gradient = object_distance(place, cases, case)
    if distance < 0.0:
        anchor = place
        if surface.states[point] == FREE:
            surface.states[point] = TOUCHED
            for c in ti.static(range(3)):
                surface.anchors[3 * point + c] = place[c]
        for c in ti.static(range(3)):
            anchor[c] = surface.anchors[3 * point + c]
        limit = -friction_now(point, surface, cases, case) * distance * gradient.norm()
        slip = tangent_slip(place, gradient, anchor, limit)
        stiffness = surface.points[POINT * point + STIFFNESS]
        force = -stiffness * (rotation @ (distance * gradient + slip))
    elif surface.states[point] == TOUCHED or (
        distance * cases.numbers[NUMBERS * case + INVERSE_EDGE] > LIFTED
    ):
        surface.states[point] = FREE
    return force


@ti.func
def point_force(point, moved, surface: ti.template(), cases: ti.template(), case, row):
    """Force on the membrane at a surface point that has moved by `moved`, sensor frame [N]."""
    force = ti.Vector([0.0, 0.0, 0.0])
    if surface.held[point] == HELD_STILL:
        share = cases.poses[POSE * row + POSE - 1]
        force = _holding_force(point, moved, surface, share)
    elif surface.held[point] == MEETS_RIGID:
        force = _contact_force(point, moved, surface, cases, case, row)
    return force
