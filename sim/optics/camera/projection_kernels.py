"""Gauss-Newton on the ray map as Taichi functions; `projection.project_points` is the twin."""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti
import taichi.math as tm

from sim.optics.camera.projection import LARGEST_STEP, NO_PIXEL

MOST_STEPS = 10
LOST_MM = 0.1
"""Distance from the ray beyond which a point has no pixel inside the map [mm]."""
ARRIVED_PX = 0.02
"""A step this short is the last one [px]: convergence is quadratic, 1e-5 px remain."""


@ti.func
def sample(values: ti.template(), x: ti.f32, y: ti.f32):
    """Bilinear value at map coordinates, and its slopes per column and row."""
    column = ti.min(int(x), values.shape[1] - 2)
    row = ti.min(int(y), values.shape[0] - 2)
    right, down = x - column, y - row
    a, b = values[row, column], values[row, column + 1]
    c, d = values[row + 1, column], values[row + 1, column + 1]
    top = a + right * (b - a)
    bottom = c + right * (d - c)
    return top + down * (bottom - top), (1.0 - down) * (b - a) + down * (d - c), bottom - top


@ti.func
def project(point: tm.vec3, start: tm.vec2, foot_map: ti.template(), way_map: ti.template()):
    """Map coordinates of a point, and the direction of the ray that passes through it.

    A point outside the map stands on its border, so that its triangles reach up to there; one
    that no ray passes through inside has `NO_PIXEL`.
    """
    place = start
    last_x, last_y = float(foot_map.shape[1] - 1), float(foot_map.shape[0] - 1)
    going = 0
    while going < MOST_STEPS:
        going += 1
        foot, foot_x, foot_y = sample(foot_map, place.x, place.y)
        way, way_x, way_y = sample(way_map, place.x, place.y)
        size = way.norm()
        way /= size
        offset = point - foot
        along = offset.dot(way)
        miss = offset - along * way
        move_x = foot_x + (along / size) * way_x
        move_y = foot_y + (along / size) * way_y
        move_x -= move_x.dot(way) * way
        move_y -= move_y.dot(way) * way
        xx, yy, xy = move_x.dot(move_x), move_y.dot(move_y), move_x.dot(move_y)
        right_x, right_y = move_x.dot(miss), move_y.dot(miss)
        determinant = xx * yy - xy * xy
        if determinant > 1e-20:
            step = tm.vec2(yy * right_x - xy * right_y, xx * right_y - xy * right_x) / determinant
            length = ti.max(step.norm(), 1e-12)
            place += step * ti.min(1.0, LARGEST_STEP * last_x / length)
            if length < ARRIVED_PX:
                going = MOST_STEPS
        place.x = tm.clamp(place.x, 0.0, last_x)
        place.y = tm.clamp(place.y, 0.0, last_y)
    way = sample(way_map, place.x, place.y)[0].normalized()
    offset = point - sample(foot_map, place.x, place.y)[0]
    inside = place.x > 0.0 and place.y > 0.0 and place.x < last_x and place.y < last_y
    if inside and (offset - offset.dot(way) * way).norm() > LOST_MM:
        place = tm.vec2(NO_PIXEL)
    return place, way
