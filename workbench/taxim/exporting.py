"""Fitting a design's table, measuring its images, writing the pack."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.base.version import VERSION
from workbench.core.design.design import SensorDesign
from workbench.core.objects.kind import Shape, kinds
from workbench.core.press.indenter import BALL, IndenterKind
from workbench.core.press.press_case import PressCase
from workbench.live.live_press import live_design, small
from workbench.planning.plan import InlineRunner, StageMonitor, evaluate, plan
from workbench.project.project import Project
from workbench.system.whole_files import write_atomically
from workbench.taxim.files import files_of
from workbench.taxim.programs import PROGRAMS, shown
from workbench.taxim.table import BINS, TableFit

if TYPE_CHECKING:
    from workbench.taxim.dents import Dent, DentMaker
    from workbench.taxim.flatness import FlatView

DENTS, TESTS = 160, 16
"""Dents that a table is fitted to, and others that it is measured on, of each object."""
OTHER = next(IndenterKind(name) for name, kind in kinds().items() if kind.shape is Shape.CUBE)
"""An object with edges, that no table is fitted to."""
REPORT = "taxim.json"


def export_taxim(
    design: SensorDesign,
    folder: Path,
    project: Project,
    *,
    width_px: int | None = None,
    monitor: StageMonitor,
) -> list[Path]:
    """Write the table of a design for Taxim, TacEx and Isaac Lab; returns the paths.

    Args:
        design: Flat, seen straight on.
        folder: Made where there is none; files of an earlier one are written anew.
        project: Where results are kept.
        width_px: Width of the images, the camera's own where left out.
        monitor: Told stage, fraction and note.

    Raises:
        DesignError: If the design is not flat, or the camera sees pins.
        WorkbenchError: If a stage fails, or a file cannot be written.
    """
    maker, view = _opened(plain(design, width_px), project, monitor)
    fits = {program: TableFit(*maker.rest.shape[:2]) for program in PROGRAMS}
    bases = {program: program.base(maker.rest) for program in PROGRAMS}
    for program, fit in fits.items():
        fit.rest(maker.rest - bases[program], view.flat)
    for number, dent in enumerate(maker.dents(BALL, DENTS, 0)):
        monitor("taxim", 0.8 * number / DENTS, f"dent {number + 1} of {DENTS}")
        for program, fit in fits.items():
            fit.add(dent.height_px, dent.rgb - bases[program], dent.moved)
    tables = {program: fit.table() for program, fit in fits.items()}
    errors = {}
    for kind in (BALL, OTHER):
        monitor("taxim", 0.9, f"images of {kind.value}")
        dents = list(maker.dents(kind, TESTS, 1))
        errors[kind.value] = {
            program.name: measured(bases[program], tables[program], maker.rest, dents)
            for program in PROGRAMS
        }
    files = {
        f"{program.name}/{name}": content
        for program in PROGRAMS
        for name, content in files_of(program, maker.rest, tables[program], view.mm_per_px).items()
    }
    files[REPORT] = f"{json.dumps(report(design, maker, view, errors), indent=1)}\n".encode()
    for name, content in files.items():
        write_atomically(folder / name, content)
    return [folder / name for name in files]


def plain(design: SensorDesign, width_px: int | None) -> SensorDesign:
    """The design as a table can show it: no markers, noise or blur, light as it was baked."""
    found = live_design(design)
    for field, value in {
        "optics.markers.visible": False,
        "optics.camera.sensor.noise": False,
        "optics.camera.aperture_mm": 0.0,
    }.items():
        found = found.replace(field, value)
    width_px = found.optics.camera.width_px if width_px is None else width_px
    return dataclasses.replace(found, optics=small(found.optics, width_px))


def measured(
    base: np.ndarray, table: np.ndarray, rest: np.ndarray, dents: Sequence[Dent]
) -> dict[str, float]:
    """Mean error of images from a table in the dents, beside that of the image at rest.

    Args:
        base: What the program adds to, shape (H, W, 3).
        table: Shape (125, 125, 6, 3).
        rest: The image at rest, shape (H, W, 3).
        dents: What they are compared with.

    Returns:
        Grey values: `error` in what moved, `null` of the image at rest there, `whole_image`.
    """
    rows = []
    for dent in dents:
        truth = dent.rgb.astype(float)
        off = np.abs(shown(base, table, dent.height_px) - truth)
        null = np.abs(rest - truth)
        rows.append((off[dent.moved].mean(), null[dent.moved].mean(), off.mean()))
    error, null, whole = np.mean(rows, axis=0)
    return {
        "error": round(float(error), 2),
        "null": round(float(null), 2),
        "whole_image": round(float(whole), 2),
    }


def report(
    design: SensorDesign, maker: DentMaker, view: FlatView, errors: dict[str, Any]
) -> dict[str, Any]:
    """What `taxim.json` says."""
    rows, columns = maker.rest.shape[:2]
    return {
        "made_by": f"sensor workbench {VERSION}",
        "design": design.name,
        "pixmm": view.mm_per_px,
        "pixmm_between": list(view.between_mm_per_px),
        "h": rows,
        "w": columns,
        "numBins": BINS,
        "flat_share": view.share,
        "errors_grey": errors,
        "errors_meaning": (
            "mean absolute difference from the workbench's renders in what a dent moved; null: of "
            f"the image at rest; {BALL} at other places than it was fitted to, {OTHER} not fitted"
        ),
        "left_out": ["shadows", "markers", "noise", "blur"],
    }


def _opened(
    design: SensorDesign, project: Project, monitor: StageMonitor
) -> tuple[DentMaker, FlatView]:
    from sim.optics.camera.camera import rotation_camera_to_sensor
    from sim.optics.raster.skin_view import open_skin_view
    from workbench.taxim.flatness import flat_view

    calls = plan(design, PressCase())

    def found(*names: str) -> dict[str, Any]:
        names = tuple(name for name in names if name in calls)
        for _ in evaluate(
            design, PressCase(), InlineRunner(project.store), wanted=names, monitor=monitor
        ):
            pass
        return {name: project.store.load(name, calls[name].key) for name in names}

    mesh, camera = found("mesh")["mesh"], design.optics.camera
    if len(mesh.tips_mm):
        raise DesignError(
            "the camera sees pins, and the format of Taxim is for smooth gels",
            hint="take --pack",
            at="--taxim",
        )
    axis = rotation_camera_to_sensor(camera)[:, 2]
    # Light takes long: what is not flat is refused before.
    seen = open_skin_view(mesh, camera, index=design.optics.refractive_index)
    view = flat_view(seen, mesh.seen, axis)
    light = found("bake", "table")
    from workbench.pipeline.devices import open_device

    open_device()
    from sim.optics.studio.render import Studio
    from workbench.taxim.dents import DentMaker

    studio = Studio(mesh, light["bake"], design.optics, table=light.get("table"))
    return DentMaker(studio, mesh.seen, view, axis), view
