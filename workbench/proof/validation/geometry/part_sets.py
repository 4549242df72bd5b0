"""Full sets of parts of random sensors: is what is handed out what it says, or is that said?

Each set is made as `workbench export` makes it and then looked at from its files alone: every STEP
file read back, every STL closed, and the recipe's motions replayed in steps of 1 mm with the parts
as a slicer reads them. A set that cannot be made is refused with a message, and one whose mould
jams has a red check; what counts as a failure is a fault without a word.
"""

from __future__ import annotations

import functools
import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.errors import WorkbenchError
from workbench.core.design.design import SensorDesign
from workbench.core.result.fabrication import MouldSet, Severity
from workbench.core.result.results import Bundle
from workbench.proof.row import Row, bounded, failed
from workbench.proof.validation.geometry.meshes import family_names
from workbench.proof.validation.geometry.trial_workers import Workers
from workbench.proof.validation.geometry.trials import Finding, Trial, draw

SETS = 20
SEED = 20261123
HANG_S = 400.0
"""Time after which a set counts as hung [s]; the largest take a minute of a core."""
SAME_SHARE = 0.005
"""Largest relative difference of a STEP file's volume from that of the STL."""
OVERLAP_MM = 1e-3
"""Overlap over half the area of the smaller part that is rounding of faces that touch [mm]."""
STEP_MM = 1.0
JAMMED = ("demoulding", "undercut", "core_removal", "part_removal")
"""Checks of which a red one says that the mould cannot be opened."""


def judge_set(trial: Trial) -> Finding:
    """Make all parts of one random sensor and look at their files; never raises."""
    from designs.family import family
    from geometry.housing.housing import make_housing
    from geometry.mould.moulds import make_mould
    from geometry.workshop.export import package_files
    from geometry.workshop.recipe import WantedMaterial, make_recipe
    from workbench.core.result.fabrication import SheetHead
    from workbench.pipeline.building import build_solid
    from workbench.planning.fitting import fitted

    start = time.perf_counter()
    try:
        solid = build_solid(family(trial.family), trial.shape, trial.layers)
        design = SensorDesign(family=trial.family, layers=trial.layers)
        design, _ = fitted(design, solid)
        moulds = make_mould(solid, design.mould)
        eye = design.optics.camera
        housing = make_housing(
            solid,
            design.housing,
            ring=design.optics.ring,
            camera=eye,
            printer=design.mould.printer,
        )
        recipe = make_recipe(
            solid,
            moulds,
            housing,
            ring=design.optics.ring,
            casting=design.casting,
            wanted=WantedMaterial(
                young_MPa=design.material.young_MPa,
                density_g_cm3=design.material.density_g_cm3,
                backing_MPa=design.material.backing_MPa,
            ),
        )
        head = SheetHead(name="set", family=trial.family, shrink_percent=0.2, draft_deg=0.0)
        bundle = package_files(moulds, housing, recipe, head)
    except WorkbenchError as error:
        return Finding(trial=trial, refused=error.message, seconds=time.perf_counter() - start)
    except Exception as error:
        return Finding(trial=trial, fault=f"bug: {error!r}")
    red = {c.name for c in (*moulds.checks, *recipe.checks) if c.severity is Severity.BAD}
    notices = "; ".join((bundle.notice, moulds.notice, housing.notice))
    faults = [*file_faults(bundle, notices), *motion_faults(bundle, moulds, red)]
    return Finding(
        trial=trial,
        fault=", ".join(faults),
        softened="facets" in bundle.notice,
        jammed=bool(red & set(JAMMED)),
        seconds=time.perf_counter() - start,
    )


def file_faults(bundle: Bundle, notices: str) -> Iterator[str]:
    """What another program would find wrong in the STL and STEP files, and is not told."""
    from geometry.workshop.step import read_back

    for name, data in bundle.files.items():
        if not name.endswith(".stl"):
            continue
        mesh = _mesh(data)
        if not mesh.is_watertight and f"{Path(name).stem} touches itself" not in notices:
            yield f"{name} is not closed"
        step = bundle.files.get(name.replace(".stl", ".step"))
        if step is None:
            if Path(name).stem not in bundle.notice:
                yield f"{name} has no STEP file and nothing is said"
            continue
        found = read_back(step.tobytes())
        off = abs(found.volume_mm3 / mesh.volume - 1.0)
        if found.solids != 1 or not found.valid or off > SAME_SHARE:
            yield f"the STEP file of {name} has {found.solids} solids, volume off by {off:.2%}"


def motion_faults(bundle: Bundle, moulds: MouldSet, red: set[str]) -> Iterator[str]:
    """Overlaps of rigid parts on the recipe's way, of which no red check tells."""
    import manifold3d

    def solid(name: str) -> Any:
        mesh = _mesh(bundle.files[f"moulds/{name}.stl"])
        points, faces = mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32)
        return manifold3d.Manifold(manifold3d.Mesh(points, faces))

    there = {part.name: solid(part.name) for part in moulds.parts}
    rows = json.loads(bundle.files["recipe.json"].tobytes())
    if sorted(row["part"] for row in rows) != sorted(there):
        yield "the recipe does not name each part once"
        return
    for row in rows:
        moving, way = there.pop(row["part"]), np.array(row["direction"])
        for way_mm in np.arange(0.0, row["distance_mm"] + STEP_MM, STEP_MM):
            moved = moving.translate(min(way_mm, row["distance_mm"]) * way)
            for name, other in there.items():
                overlap_mm3 = float((moved ^ other).volume())
                most_mm3 = OVERLAP_MM * min(moving.surface_area(), other.surface_area()) / 2.0
                if overlap_mm3 > most_mm3 and not red & set(JAMMED):
                    yield (f"{row['part']} meets {name} after {way_mm:g} mm: {overlap_mm3:.3g} mm3")
                    return


def _mesh(data: np.ndarray) -> Any:
    import io

    import trimesh

    return trimesh.load_mesh(io.BytesIO(data.tobytes()), file_type="stl")


def sweep_sets(names: list[str], count: int = SETS, *, workers: int | None = None) -> list[Finding]:
    """Judge full sets of parts of each family in worker processes."""
    todo = [trial for name in names for trial in draw(name, count, seed=SEED)]
    return Workers(judge_set, workers, hang_s=HANG_S).judge(todo)


def rows(count: int = SETS, *, names: list[str] | None = None) -> list[Row]:
    """One row per family: how many sets have a fault of which nothing is said; none may."""
    found = []
    for name in names or family_names():
        found.append(_row(name, functools.partial(sweep_sets, [name], count)))
    return found


def _row(name: str, run: Any) -> Row:
    try:
        found = run()
    except WorkbenchError as error:
        return failed(f"parts_{name}", "random sets of parts", why=error.message)
    faults = [finding.fault for finding in found if finding.fault]
    refused = [finding.refused for finding in found if finding.refused]
    case = (
        f"{len(found)} sets, {sum(f.jammed for f in found)} told to jam, "
        f"{sum(f.softened for f in found)} with STEP files of facets, {len(refused)} refused, "
        f"{sum(f.seconds for f in found) / len(found):.0f} s each"
    )
    case += f"; the first refusal: {refused[0]}" if refused else ""
    case += f"; the first failure: {faults[0]}" if faults else ""
    return bounded(f"parts_{name}", case, len(faults), unit="1", limit=0)
