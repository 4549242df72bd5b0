"""Random sensors of every family: does each come out as one closed body of the right size?

Each of the sets that `trials` draws is built by `workbench.pipeline.building` in a process of
`trial_workers`. The result is then measured in ways the builder does not use: a finer integral of
the fields, the box of the fields' zero set, and every B-rep body written as STEP and read back.
"""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from workbench.core.base.errors import WorkbenchError
from workbench.core.result.results import BodyMethod, Solid
from workbench.proof.row import Row, bounded, failed
from workbench.proof.validation.geometry.meshes import family_names
from workbench.proof.validation.geometry.trial_workers import Workers
from workbench.proof.validation.geometry.trials import Finding, Trial, draw

SETS = 200
SURFACE_LIMIT = 0.003
FIELD_LIMIT = 0.03
FINE_MM = 0.6
"""Grid of the reference integral [mm]: good to about 0.5 % of a 1 mm wall."""
FINEST_MM = 0.3
"""The same where it stands in for the kernel's volume [mm]: within 0.04 % of a grid of 0.15 mm on
16 random sensors."""
SIZE_LIMIT_MM = 1.0
STEP_BODIES = ("membrane", "outer", "core", "support", "base")
"""Bodies with a B-rep, of which `outer` and `core` have no triangles of their own."""


def judge(trial: Trial) -> Finding:
    """Build one random sensor and measure it; never raises."""
    from designs.family import family
    from workbench.pipeline.building import build_solid

    start = time.perf_counter()
    one = family(trial.family)
    try:
        solid = build_solid(one, trial.shape, trial.layers)
    except WorkbenchError as error:
        return Finding(trial=trial, fault=f"not built: {error.message}")
    except Exception as error:
        return Finding(trial=trial, fault=f"bug: {error!r}")
    seconds = time.perf_counter() - start
    return _measured(trial, solid, one.fields(trial.shape, trial.layers), seconds)


def _measured(trial: Trial, solid: Solid, fields: Any, seconds: float) -> Finding:
    from geometry.surface.surface import mesh_volume, open_edges
    from workbench.pipeline.building import body_count, coarse_volume_mm3

    points, faces = solid.membrane.points_mm, solid.membrane.faces
    volume_mm3 = mesh_volume(points, faces)
    distance = solid.method is BodyMethod.SIGNED_DISTANCE
    reference_mm3 = coarse_volume_mm3(fields, FINEST_MM if distance else FINE_MM)
    # Without a kernel's volume to compare with, the finer integral stands in for it.
    surface = abs(volume_mm3 / (reference_mm3 if distance else solid.volume_mm3) - 1.0)
    field = abs(volume_mm3 / reference_mm3 - 1.0)
    high, low = points.max(axis=0), points.min(axis=0)
    size_mm = float(
        max(np.abs(high - fields.high_mm).max(), np.abs((low - fields.low_mm)[:2]).max())
    )
    faults = {
        f"{open_edges(faces)} open edges": open_edges(faces) > 0,
        f"{body_count(faces)} pieces": body_count(faces) != 1,
        f"volume {volume_mm3:.4g} mm3": volume_mm3 <= 0.0,
        f"surface off its reference volume by {surface:.2%}": surface > SURFACE_LIMIT,
        f"volume off the fields' by {field:.2%}": field > FIELD_LIMIT,
        f"size off by {size_mm:.2g} mm": size_mm > SIZE_LIMIT_MM,
    }
    named = [text for text, bad in faults.items() if bad]
    return Finding(
        trial=trial,
        fault=", ".join([*named, *_step_faults(solid)]),
        softened=bool(solid.notice) and not distance,
        distance=distance,
        surface_error=surface,
        field_error=field,
        size_error_mm=size_mm,
        seconds=seconds,
    )


def _step_faults(solid: Solid) -> Iterator[str]:
    """What a reader finds wrong in the STEP files of the bodies that have a B-rep."""
    from geometry.body.solid import part_from_brep
    from geometry.surface.surface import mesh_volume
    from geometry.workshop.step import expect_read_back, step_bytes

    for name in STEP_BODIES:
        brep, surface = getattr(solid, f"{name}_brep"), getattr(solid, name, None)
        if not brep.size:
            continue
        body = part_from_brep(brep)
        wanted_mm3 = mesh_volume(surface.points_mm, surface.faces) if surface else body.volume
        try:
            expect_read_back(step_bytes([body], name), wanted_mm3, what=name)
        except WorkbenchError as error:
            yield error.message


def sweep(names: list[str], count: int = SETS, *, workers: int | None = None) -> list[Finding]:
    """Judge `count` random sensors of each family in worker processes.

    Args:
        workers: Processes; as many as there are cores when left out.
    """
    todo = [trial for name in names for trial in draw(name, count)]
    return Workers(judge, workers).judge(todo)


def rows(count: int = SETS, *, names: list[str] | None = None) -> list[Row]:
    """One row per family: how many of its random sensors failed; none may."""
    return [
        sweep_row(name, functools.partial(sweep, [name], count)) for name in names or family_names()
    ]


def sweep_row(name: str, run: Callable[[], list[Finding]]) -> Row:
    """The row of one family's findings."""
    try:
        found = run()
    except WorkbenchError as error:
        return failed(f"sweep_{name}", "random sets", why=error.message)
    faults = [finding.fault for finding in found if finding.fault]
    surface, field = (max(getattr(f, f"{of}_error") for f in found) for of in ("surface", "field"))
    case = (
        f"{len(found)} random sets, {sum(f.trial.refused for f in found)} more refused, "
        f"{sum(f.softened for f in found)} softened, "
        f"{sum(f.distance for f in found)} by signed distance; volume off the kernel's by at most "
        f"{surface:.2%}, off the fields' by {field:.2%}"
    )
    if faults:
        case += f"; the first failure: {faults[0]}"
    return bounded(f"sweep_{name}", case, len(faults), unit="1", limit=0)
