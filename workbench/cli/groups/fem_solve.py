"""`workbench fem solve`: press a design by finite elements."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from workbench.cli.command import Command
from workbench.cli.fem_state import add_case_options, fem_state
from workbench.project.project import Project
from workbench.report.fabrication_tables import plain_numbers
from workbench.report.fem_case import solved
from workbench.report.fem_tables import columns, frame_rows, npz_bytes
from workbench.system.terminal import Progress, say
from workbench.system.whole_files import write_atomically
from workbench.view.forces import csv_bytes
from workbench.view.press_figures import frame_depths_mm

FILES = ("forces.npz", "forces.csv")


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    add_case_options(sub)
    text = "where forces.npz and forces.csv go"
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help=text)
    sub.add_argument("--json", action="store_true", help="progress as one JSON object per line")


def run(options: argparse.Namespace, project: Project) -> int:
    """Press a design by finite elements; write forces and displacements."""
    from workbench.system.folder import prepare

    printer = Progress(as_json=options.json)
    state = fem_state(options, project, printer)
    prepare(options.out, clear=FILES)
    found = solved(state, project, printer)
    depths_mm = frame_depths_mm(state.case.press, found)
    write_atomically(options.out / "forces.npz", npz_bytes(found))
    write_atomically(options.out / "forces.csv", csv_bytes(columns(found, depths_mm)))
    if options.json:
        say(
            json.dumps(
                plain_numbers({"solver": found.solver, "frames": frame_rows(found, depths_mm)})
            )
        )
        return 0
    for row in frame_rows(found, depths_mm):
        say(
            f"frame {row['frame']:3}  {row['depth_mm']:6.3f} mm  normal {row['normal_N']:8.4f} N  "
            f"tangential {row['tangential_u_N']:8.4f}, {row['tangential_v_N']:8.4f} N  "
            f"residual {row['residual']:.1e}{_error(row)}"
        )
    say(options.out / "forces.csv")
    return 0


def _error(row: dict[str, Any]) -> str:
    """The estimated error of the force of a frame, where there is one."""
    found = row.get("force_error")
    return "" if found is None or np.isnan(found) else f"  error {100.0 * found:+.1f} %"


COMMAND = Command(place=1, run=run, options=options)
