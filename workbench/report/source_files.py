"""`workbench run --sources`: forces of one press from several sources, side by side in a table."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sim.forces.network.spec import Target
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField, Source
from workbench.pipeline.chosen_weights import chosen
from workbench.pipeline.shipped import shipped_weights
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, evaluate, plan
from workbench.report.fabrication_tables import plain_numbers
from workbench.system.terminal import Progress, complain, say
from workbench.system.whole_files import write_atomically
from workbench.view.force_sources import Forces, disagreement, totals
from workbench.view.forces import Columns, csv_bytes
from workbench.view.press_figures import frame_depths_mm

FILE = "sources.csv"
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
    """Compute what is asked for and not yet stored, write the table, print the last frame.

    Raises:
        WorkbenchError: From the first source that fails.
    """
    calls = plan(design, case)
    wanted = [STAGES[source] for source in sources]
    for outcome in evaluate(design, case, InlineRunner(store), wanted=wanted, monitor=printer):
        if not outcome.cached:
            printer.done(outcome)
    found: dict[Source, Forces] = {s: store.load(STAGES[s], calls[STAGES[s]].key) for s in sources}
    depths_mm = frame_depths_mm(case.press, next(iter(found.values())))
    write_atomically(out / FILE, csv_bytes(source_columns(found, np.array(depths_mm))))
    rows = last_frame(found)
    if printer.as_json:
        say(json.dumps({"sources": plain_numbers(rows)}))
        return
    for row in rows:
        say(
            f"{row['source']:8} normal {row['normal_N']:8.4f} N  tangential "
            f"{row['tangential_N']:8.4f} N  peak {1e3 * row['peak_N']:7.2f} mN"
        )
    for row in rows:
        for name in ("notice", "note"):
            if row.get(name):
                complain(f"{name} of {row['source']}: {row[name]}")


def source_columns(found: Mapping[Source, Forces], depths_mm: np.ndarray) -> Columns:
    """Totals of every frame and source by name, each of shape (K,)."""
    columns: Columns = {"frame": np.arange(1, len(depths_mm) + 1), "depth_mm": depths_mm}
    for source, forces in found.items():
        rows = [totals(source, forces, frame) for frame in range(len(depths_mm))]
        for name in ("normal_N", "tangential_N", "peak_N"):
            values = np.array([getattr(row, name) for row in rows])
            columns[f"{source.value}_{name}"] = values
    return columns


def last_frame(found: Mapping[Source, Forces]) -> list[dict[str, Any]]:
    """Totals of the last frame, and how far each is from finite elements, if those are there."""
    truth, rows = found.get(Source.FEM), []
    for source, forces in found.items():
        frame = len(forces.reaction_N) - 1
        row = {**dataclasses.asdict(totals(source, forces, frame)), "source": source.value}
        if truth is not None and source is not Source.FEM:
            apart = disagreement(forces, truth, frame)
            row["normal_share"] = apart.normal_share
            row["displacement_rms_mm"] = apart.displacement_mm
        if isinstance(forces, ForceField):
            row |= {"solver": forces.solver, "notice": forces.notice, "note": forces.note}
        rows.append(row)
    return rows
