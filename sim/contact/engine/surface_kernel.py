"""First pass of a substep: the force of each surface point, a thread per point.

Points stand apart from the cells that they lie in: where the cells' threads found these forces
too, the few with points kept the rest of their warp waiting, and every thread paid registers for
the objects' distances.

Taichi functions; their plain twin is `reference.surface_forces`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false

import taichi as ti

from sim.contact.engine.cell_kernel import entry
from sim.contact.engine.point_functions import line_weights, point_force
from sim.contact.grid.layout import CHOICES, IDLE, LOCAL, MODE, POINT


@ti.func
def point_displacement(
    nodes: ti.template(), cells: ti.template(), surface: ti.template(), cell, point
):
    """Displacement [mm] of a surface point from the nodes of its cell."""
    x = line_weights(surface.points[POINT * point + LOCAL])
    y = line_weights(surface.points[POINT * point + LOCAL + 1])
    z = line_weights(surface.points[POINT * point + LOCAL + 2])
    moved = ti.Vector([0.0, 0.0, 0.0])
    for n in ti.static(range(27)):
        weight = x[n // 9] * y[n // 3 % 3] * z[n % 3]
        base = 3 * (cells.rows[entry(cell, n // 3, 9)] + n % 3)
        for c in ti.static(range(3)):
            moved[c] += weight * nodes.displacement[base + c]
    return moved


@ti.func
def surface_pass(
    nodes: ti.template(),
    cells: ti.template(),
    surface: ti.template(),
    cases: ti.template(),
    count,
    case_count,
    step,
):
    """Contact and holding force of each point of the cases that are not idle."""
    for point in range(count):
        cell = surface.owners[point]
        if cell >= 0:
            case = cells.cell_cases[cell]
            if cases.choices[CHOICES * case + MODE] != IDLE:
                moved = point_displacement(nodes, cells, surface, cell, point)
                row = step * case_count + case
                force = point_force(point, moved, surface, cases, case, row)
                for c in ti.static(range(3)):
                    surface.point_forces[3 * point + c] = force[c]
