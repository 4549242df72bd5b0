"""Second pass of a substep: elastic and surface forces of each cell into the cell's own slots.

Taichi function; its plain twin is `reference.stress_forces`.
"""

# Taichi reads annotations and operators in its own way.
# pyright: reportInvalidTypeForm=false, reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false

import taichi as ti
from taichi.lang.impl import expr_init

from sim.contact.engine.blocks import CELL_THREADS, block_size
from sim.contact.engine.point_functions import line_weights
from sim.contact.grid.layout import CHOICES, IDLE, LOCAL, MODE, POINT
from sim.contact.grid.stencil import gather_gradient, scatter_gradient
from sim.contact.region.domain import BLOCK
from sim.material import SMALLEST_VOLUME_RATIO, first_piola_rows


def _inverse_cube_root(ratio):
    """J^(-1/3) by Newton's iteration: `exp` and `log` would take a third of the substep."""
    guarded = expr_init(ti.max(ratio, SMALLEST_VOLUME_RATIO))
    root = expr_init(ti.select(guarded < 0.6, 1.6 - guarded, 4.0 / (3.0 + guarded)))
    for _ in range(4):
        root = expr_init(root * (4.0 - guarded * root * root * root) * (1.0 / 3.0))
    return root


def _cell_forces(nodal, volumes, inverse_edge, moduli, linear):
    """Forces [N] on 27 nodes of a cell: -sum over points of volume P grad(weight)."""
    gradients = [gather_gradient(component, expr_init) for component in nodal]
    flux = [[[] for _ in range(8)] for _ in range(3)]
    for p in range(8):
        rows = [[expr_init(gradients[r][p][c] * inverse_edge) for c in range(3)] for r in range(3)]
        stress = first_piola_rows(rows, moduli, _inverse_cube_root, keep=expr_init, linear=linear)
        scale = expr_init(-volumes[p] * inverse_edge)
        for r in range(3):
            flux[r][p] = [expr_init(scale * stress[r][c]) for c in range(3)]
    return [scatter_gradient(component, expr_init) for component in flux]


@ti.func
def entry(row, column, width):
    """Index of an entry of a table whose rows interleave in blocks (`batch.interleaved`)."""
    return (row // BLOCK) * (width * BLOCK) + column * BLOCK + row % BLOCK


@ti.func
def cell_pass(
    nodes: ti.template(),
    cells: ti.template(),
    surface: ti.template(),
    cases: ti.template(),
    count,
    linear: ti.template(),
):
    """Forces of each cell on its nodes; those of its surface points are known."""
    ti.loop_config(block_dim=ti.static(block_size(CELL_THREADS)))
    for cell in range(count):
        case = cells.cell_cases[cell]
        if cases.choices[CHOICES * case + MODE] != IDLE:
            first = [cells.rows[entry(cell, r, 9)] for r in range(9)]
            volume = [cells.volumes[entry(cell, p, 8)] for p in range(8)]
            nodal = [
                [nodes.displacement[3 * (first[n // 3] + n % 3) + c] for n in range(27)]
                for c in range(3)
            ]
            shear, bulk = cells.moduli[entry(cell, 0, 3)], cells.moduli[entry(cell, 1, 3)]
            inverse_edge = cells.moduli[entry(cell, 2, 3)]
            forces = ti.static(_cell_forces(nodal, volume, inverse_edge, (shear, bulk), linear))
            for point in range(cells.starts[cell], cells.starts[cell + 1]):
                force = ti.Vector([surface.point_forces[3 * point + c] for c in range(3)])
                if force.norm_sqr() > 0.0:
                    x = line_weights(surface.points[POINT * point + LOCAL])
                    y = line_weights(surface.points[POINT * point + LOCAL + 1])
                    z = line_weights(surface.points[POINT * point + LOCAL + 2])
                    for n in ti.static(range(27)):
                        weight = x[n // 9] * y[n // 3 % 3] * z[n % 3]
                        for c in ti.static(range(3)):
                            forces[c][n] += weight * force[c]
            base = entry(cell, 0, 81)
            for n in ti.static(range(27)):
                for c in ti.static(range(3)):
                    cells.slots[base + (3 * n + c) * BLOCK] = forces[c][n]
