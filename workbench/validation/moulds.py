"""Moulds of every family: one row each, the number of limits that its mould misses.

Looked at: closed after an STL file, overlap, volume of the cavity against the membrane's (without
shrinkage), thinnest wall and time. What was found stands in the row's case.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

from workbench.core.design import Layers, MouldOptions
from workbench.core.errors import WorkbenchError
from workbench.core.fabrication import MouldSet
from workbench.core.monitor import silent
from workbench.core.results import Solid
from workbench.rows import Row, bounded, failed
from workbench.stages import build, mould

OVERLAP_MM3 = 1e-6
VOLUME_ERROR = 0.005
SECONDS = 20.0
"""Of a machine that does nothing else it takes 2 to 5; a shared one may take four times that."""
ELONGATION = 3.0
IMPORTED = "imported"


def rows(names: Sequence[str] = ()) -> list[Row]:
    """One row for each family, or for those named."""
    from designs.family import families

    return [_row(name) for name in names or families() if name != IMPORTED]


def _row(name: str) -> Row:
    from designs.family import resolve_shape

    try:
        solid = build(name, resolve_shape(name, {}), Layers(), monitor=silent)
        begin = time.perf_counter()
        moulds = mould(solid, MouldOptions(shrink_percent=0.0), ELONGATION, monitor=silent)
        seconds = time.perf_counter() - begin
    except WorkbenchError as error:
        return failed(f"mould_{name}", "default shape", unit="limits missed", why=error.message)
    error = volume_error(moulds, solid)
    undercut = max(c.value for c in moulds.checks if c.name == "undercut")
    missed = [
        not all(part.watertight for part in moulds.parts),
        moulds.overlap_mm3 > OVERLAP_MM3,
        error > VOLUME_ERROR,
        seconds > SECONDS,
    ]
    case = (
        f"{len(moulds.parts)} parts in {seconds:.1f} s, overlap {moulds.overlap_mm3:.1e} mm3, "
        f"volume error {error:.1e}, thinnest wall {moulds.thinnest_wall_mm:.2f} mm, "
        f"undercut {100 * undercut:.1f} %"
    )
    return bounded(f"mould_{name}", case, float(sum(missed)), unit="limits missed", limit=0.0)


def volume_error(moulds: MouldSet, solid: Solid) -> float:
    """Relative difference of the cavity's volume and that of the membrane's triangles."""
    from geometry.surface import mesh_volume

    wanted = mesh_volume(solid.membrane.points_mm, solid.membrane.faces)
    return abs(moulds.cast_volume_mm3 / wanted - 1.0)
