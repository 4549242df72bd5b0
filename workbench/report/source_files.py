"""`workbench run --sources`: forces of one press from several sources, as a table and as fields."""

from __future__ import annotations

import dataclasses
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.forces.network.spec import Target
from sim.forces.peaks import DISC_MM, Triangles
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField, Source
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.chosen_weights import chosen
from workbench.pipeline.shipped import shipped_weights
from workbench.pipeline.store import Store
from workbench.planning.advised import advised
from workbench.planning.plan import InlineRunner, evaluate, plan
from workbench.report.fabrication_tables import plain_numbers
from workbench.report.source_arrays import source_arrays, source_columns
from workbench.system.folder import SOURCE_FILES, remove_stale
from workbench.system.terminal import Progress, complain, say
from workbench.system.whole_files import write_atomically
from workbench.view.force_sources import Forces, disagreement, totals
from workbench.view.forces import csv_bytes
from workbench.view.press_figures import frame_depths_mm

TABLE, ARRAYS = "sources.csv", "sources.npz"
STAGES = {Source.MPM: "press", Source.FEM: "forces", Source.LEARNED: "learned"}
"""Stages whose results hold each source's forces on the skin of the design."""


def asked_sources(text: str) -> tuple[Source, ...]:
    """The sources of a list like `mpm,learned`, in our order.

    Raises:
        DesignError: If one is unknown.
    """
    names = [name.strip() for name in text.split(",") if name.strip()]
    known = [source.value for source in Source]
    for name in names:
        if name not in known:
            raise DesignError(
                f"there is no source {shown(name)} of forces",
                hint=suggest(name, known),
                at="--sources",
            )
    return tuple(source for source in Source if source.value in names)


def with_weights(case: PressCase, path: Path | None, sources: tuple[Source, ...]) -> PressCase:
    """A press with the force network of a file, if one is given.

    Raises:
        StoreError: If the file is missing or damaged, or a network is asked for and none is there.
    """
    if path is not None:
        learned = dataclasses.replace(case.learned, weights=chosen(path))
        return dataclasses.replace(case, learned=learned)
    if Source.LEARNED in sources and not case.learned.weights:
        shipped_weights(Target.FORCE)
    return case


def write_sources(
    out: Path,
    sources: tuple[Source, ...],
    design: SensorDesign,
    case: PressCase,
    store: Store,
    printer: Progress,
) -> None:
    """Compute what is asked for and not yet stored, write the files, print the last frame.

    Raises:
        WorkbenchError: From the first source that fails.
    """
    calls = plan(design, case)
    wanted = [STAGES[source] for source in sources]
    for outcome in evaluate(design, case, InlineRunner(store), wanted=wanted, monitor=printer):
        if not outcome.cached:
            printer.done(outcome)
    found: dict[Source, Forces] = {s: store.load(STAGES[s], calls[STAGES[s]].key) for s in sources}
    mesh = store.load("mesh", calls["mesh"].key)
    names = write_fields(out, mesh, found, frame_depths_mm(case.press, next(iter(found.values()))))
    rows = last_frame(found, mesh.outer)
    learned = found.get(Source.LEARNED)
    notice = learned.notice if isinstance(learned, ForceField) else ""
    advice = advised(case, calls, notice=notice)
    if printer.as_json:
        told = {"sources": rows, "advice": advice.as_json()}
        say(json.dumps({**plain_numbers(told), "files": names}))
        return
    for row in rows:
        say(
            f"{row['source']:8} normal {row['normal_N']:8.4f} N  tangential "
            f"{row['tangential_N']:8.4f} N  peak {1e3 * row['peak_MPa']:7.2f} kPa, "
            f"{1e3 * row['peak_disc_N']:7.2f} mN in a disc of {DISC_MM:g} mm"
        )
    for row in rows:
        for name in ("notice", "note"):
            if row.get(name):
                complain(f"{name} of {row['source']}: {row[name]}")
    complain(advice.text)


def write_fields(
    out: Path, mesh: MembraneMesh, found: Mapping[Source, Forces], depths_mm: Sequence[float]
) -> list[str]:
    """Write `sources.csv`, `sources.npz` and the VTK files of each source; returns their names.

    Such files of an earlier run that these do not replace go.
    """
    from geometry.workshop.vtk import contact_files

    columns = source_columns(found, np.array(depths_mm), mesh.outer)
    buffer = io.BytesIO()
    arrays = source_arrays(found, columns, mesh.outer)
    np.savez_compressed(buffer, **arrays)  # pyright: ignore[reportArgumentType]
    files = {TABLE: csv_bytes(columns), ARRAYS: buffer.getvalue()}
    for source, forces in found.items():
        files |= contact_files(mesh, forces, depths_mm, name=f"sources_{source.value}")
    remove_stale(out, SOURCE_FILES, keep=files)
    for name, content in files.items():
        write_atomically(out / name, content)
    return list(files)


def last_frame(found: Mapping[Source, Forces], skin: Triangles) -> list[dict[str, Any]]:
    """Totals and peaks of the last frame, and how far each is from finite elements, if there."""
    truth, rows = found.get(Source.FEM), []
    for source, forces in found.items():
        frame = len(forces.reaction_N) - 1
        row = {**dataclasses.asdict(totals(source, forces, frame, skin)), "source": source.value}
        row["disc_mm"] = DISC_MM
        if truth is not None and source is not Source.FEM:
            apart = disagreement(forces, truth, frame)
            row["normal_share"] = apart.normal_share
            row["displacement_rms_mm"] = apart.displacement_mm
        if isinstance(forces, ForceField):
            row |= {"solver": forces.solver, "notice": forces.notice, "note": forces.note}
        rows.append(row)
    return rows
