"""Moulds of every family: one row each, the number of limits that its mould misses.

Looked at, without shrinkage and draft: every part one closed body after an STL file; overlap;
volume of the cavity against the membrane's; walls of 2 mm, or a warning that says where; motions
that are free. What was found, and the time it took, stands in the row's case; the time itself is
judged by the benchmarks.
"""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from workbench.core.base.errors import WorkbenchError
from workbench.core.base.monitor import silent
from workbench.core.design.design import MouldOptions
from workbench.core.result.fabrication import FabricationPart, MouldSet, Severity
from workbench.core.result.results import Solid
from workbench.pipeline.stages.mould import MouldInputs, mould
from workbench.proof.row import Row, bounded, failed
from workbench.proof.validation.geometry.meshes import default_solid, family_names

OVERLAP_MM3 = 1e-6
VOLUME_ERROR = 0.005
WALL_MM = 2.0


def rows(names: Sequence[str] = ()) -> list[Row]:
    """One row for each family, or for those named."""
    return [_row(name) for name in names or family_names()]


def _row(name: str) -> Row:
    try:
        solid = default_solid(name)
        begin = time.perf_counter()
        moulds = mould(
            MouldInputs(solid=solid, options=MouldOptions(shrink_percent=0.0, draft_deg=0.0)),
            monitor=silent,
        )
        seconds = time.perf_counter() - begin
    except WorkbenchError as error:
        return failed(f"mould_{name}", "default shape", unit="limits missed", why=error.message)
    error = volume_error(moulds, solid)
    undercut = max(c.value for c in moulds.checks if c.name == "undercut")
    missed = [
        not all(is_one_body(part) for part in moulds.parts),
        moulds.overlap_mm3 > OVERLAP_MM3,
        error > VOLUME_ERROR,
        not thin_walls_are_told(moulds),
        not all(motion.free for motion in moulds.motions),
    ]
    case = (
        f"{len(moulds.parts)} parts in {seconds:.1f} s, overlap {moulds.overlap_mm3:.1e} mm3, "
        f"volume error {error:.1e}, thinnest wall {moulds.thinnest_wall_mm:.2f} mm, "
        f"undercut {100 * undercut:.1f} %"
    )
    return bounded(f"mould_{name}", case, float(sum(missed)), unit="limits missed", limit=0.0)


def is_one_body(part: FabricationPart) -> bool:
    """Whether the part is one closed body when another program reads its STL file."""
    import trimesh

    from geometry.workshop.export import stl_bytes

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{part.name}.stl"
        path.write_bytes(stl_bytes(part.points_mm, part.faces))
        mesh: Any = trimesh.load_mesh(path)
    return mesh.is_watertight and mesh.is_winding_consistent and mesh.body_count == 1


def thin_walls_are_told(moulds: MouldSet) -> bool:
    """Whether every part has a wall check, and each wall under 2 mm a warning with its place."""
    walls = {check.part: check for check in moulds.checks if check.name == "minimum_wall"}
    if walls.keys() != {part.name for part in moulds.parts}:
        return False
    thin = [check for check in walls.values() if check.value < WALL_MM]
    return all(
        check.severity is not Severity.GOOD and all(map(math.isfinite, check.place_mm))
        for check in thin
    )


def volume_error(moulds: MouldSet, solid: Solid) -> float:
    """Relative difference of the cavity's volume and that of the membrane's triangles."""
    from geometry.surface.surface import mesh_volume

    wanted = mesh_volume(solid.membrane.points_mm, solid.membrane.faces)
    return abs(moulds.cast_volume_mm3 / wanted - 1.0)
