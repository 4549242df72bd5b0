"""Robustness of the finite elements: how many cases of a matrix complete, from a record of them.

The matrix takes a CPU hour or more, so `python -m workbench.proof.validation.fem.fem_matrix --jobs
N --out FILE` solves it once, case by case in processes of one thread; it goes on where it was
stopped, as long as the code is the same. The rows read the record that ships with the package, and
solve two of its cases anew: a record that the program no longer reproduces is as bad as none.
"""

from __future__ import annotations

import argparse
import dataclasses
import datetime
import functools
import json
import os
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.errors import StoreError
from workbench.core.base.version import VERSION
from workbench.core.press.fem import DRAFT_MM, FemSettings
from workbench.proof.row import Row, bounded, failed, stated
from workbench.proof.validation.contact.finger_record import FEM_APART
from workbench.proof.validation.fem.fem_cases import (
    DEPTH_MM,
    FAMILIES,
    OBJECTS,
    SHEAR_MM,
    TWIST_DEG,
    WEDGE,
    MatrixCase,
    body_digest,
    every_case,
)
from workbench.proof.validation.fem.fem_solving import conditions, solve_case
from workbench.system.record import Record

RECORD = Record(
    path=Path(__file__).with_name("fem_matrix.json"),
    command="python -m workbench.proof.validation.fem.fem_matrix --jobs 16 --out FILE",
    sources=(
        "workbench.proof.validation.fem.fem_solving",
        *(f"designs.{family}" for family in FAMILIES),
        *(f"workbench.core.objects.kinds.{thing}" for thing in OBJECTS if thing != WEDGE),
        "workbench.core.objects.kinds.mesh",
    ),
    apart=(*FEM_APART, "workbench.core.base.codec"),
)
PARTS = {"version", "made", "conditions", "bodies", "cases"}
SAME = ("version", "conditions", "bodies", "code")
"""What a record must share with the program that goes on with it."""
LEAST = 31
"""Of the 32 cases of a family."""
REPEATED = 2
REPEAT_LIMIT = 1e-6
THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")


def rows() -> list[Row]:
    """The record, and two of its cases solved anew: minutes."""
    return [*recorded_rows(), *repeated_rows()]


def recorded_rows(kept: Record = RECORD) -> list[Row]:
    """What the record says, family by family."""
    try:
        record = read_record(kept)
    except StoreError as error:
        return [failed("fem_matrix", family, why=error.message) for family in FAMILIES]
    if record["conditions"] != conditions():
        why = f"the record of version {record['version']} was made with other settings or paths"
        return [failed("fem_matrix", family, why=why) for family in FAMILIES]
    return [row for family in FAMILIES for row in _family_rows(family, record, kept)]


def _family_rows(family: str, record: dict[str, Any], kept: Record) -> Iterator[Row]:
    if record["bodies"].get(family) != body_digest(family):
        why = "not recorded since the family's default body was changed"
        yield failed("fem_matrix", family, why=why)
        return
    cases = [case for case in every_case() if case.family == family]
    found = {case.name: record["cases"].get(case.name) for case in cases}
    done = {
        name: outcome for name, outcome in found.items() if outcome is not None and outcome["ok"]
    }
    others = [
        f"{name}: {'not in the record' if outcome is None else outcome['why']}"
        for name, outcome in found.items()
        if name not in done
    ]
    made = (
        f"recorded {record['made']} with version {record['version']} ({record['conditions'][:8]})"
    )
    turned = "" if family == "finger" else f", twist of {TWIST_DEG:g} degrees"
    case = (
        f"{family}: {len(OBJECTS)} objects at {len(cases) // len(OBJECTS)} places, {DEPTH_MM:g} mm "
        f"deep, shear of {SHEAR_MM:g} mm two ways{turned}, release; {made}"
    )
    yield bounded(
        "fem_matrix",
        f"{case}: cases that complete" + "".join(f"; {other}" for other in others),
        float(len(done)),
        unit="1",
        limit=float(LEAST),
        sense="min",
        null=0.0,
        record=kept,
    )
    if done:
        plain = [outcome["cpu_s"] for outcome in done.values() if not _by_gpu(outcome)]
        if plain:
            words = f"{case}: median CPU time of the {len(plain)} cases solved without a GPU"
            yield stated("fem_matrix_cpu", words, float(np.median(plain)), unit="s", record=kept)
        yield bounded(
            "fem_matrix_residual",
            f"{case}: worst relative residual",
            max(outcome["worst_residual"] for outcome in done.values()),
            unit="1",
            limit=FemSettings().tolerance,
            null=1.0,
            record=kept,
        )


def repeated_rows(kept: Record = RECORD) -> list[Row]:
    """The two cheapest cases that completed, solved anew; null: a record of no force."""
    try:
        record = read_record(kept)
    except StoreError as error:
        return [failed("fem_matrix_repeated", "two cases", why=error.message)]
    known = {
        case.name: case
        for case in every_case()
        if record["bodies"].get(case.family) == body_digest(case.family)
    }
    done = {n: outcome for n, outcome in record["cases"].items() if outcome["ok"] and n in known}
    by_cost = sorted(done, key=lambda name: (_by_gpu(done[name]), done[name]["cpu_s"]))
    cheapest = by_cost[:REPEATED]
    return [
        bounded(
            "fem_matrix_repeated",
            f"{name}, solved anew: largest difference of its forces from the record over the "
            "largest force",
            functools.partial(_difference, known[name], done[name]),
            unit="1",
            limit=REPEAT_LIMIT,
            null=1.0,
        )
        for name in cheapest
    ]


def _by_gpu(outcome: dict[str, Any]) -> bool:
    """Whether a GPU solved its equations; the CPU time says less then."""
    return "GPU" in outcome["solver"]


def _difference(case: MatrixCase, outcome: dict[str, Any]) -> float:
    """Infinity where the case no longer completes."""
    anew = solve_case(case)
    if not anew["ok"]:
        return float("inf")
    before_N, now_N = np.array(outcome["reaction_N"]), np.array(anew["reaction_N"])
    return float(np.abs(now_N - before_N).max() / np.abs(before_N).max())


def read_record(kept: Record) -> dict[str, Any]:
    """A record, as `main` writes it.

    Raises:
        StoreError: If there is none, or it is damaged.
    """
    record = kept.figures()
    if not set(record) >= PARTS:
        name, hint = kept.path.name, f"make one: {kept.command}"
        raise StoreError(f"{name} is no record of the matrix", hint=hint, at=str(kept.path))
    return record


def solve_all(todo: Sequence[MatrixCase], path: Path, jobs: int, hex_mm: float) -> dict[str, Any]:
    """Solve the cases that a file does not hold yet, and write each into it as it is done.

    Raises:
        StoreError: If the file cannot be written, or belongs to other settings.
    """
    from workbench.system.whole_files import write_atomically

    record = _begun(path, hex_mm)
    left = [case for case in todo if case.name not in record["cases"]]
    print(f"{len(left)} of {len(todo)} cases to solve", file=sys.stderr, flush=True)
    for name in THREADS:
        # Read when a process imports its libraries: one thread each.
        os.environ[name] = "1"
    # A child that was forked would share the parent's threads and CAD kernel.
    with ProcessPoolExecutor(max_workers=jobs, mp_context=get_context("spawn")) as pool:
        waiting: dict[Future[dict[str, Any]], MatrixCase] = {
            pool.submit(solve_case, case): case for case in left
        }
        for count, future in enumerate(as_completed(waiting), 1):
            case, outcome = waiting[future], future.result()
            record["cases"][case.name] = outcome
            record["made"] = datetime.datetime.now(datetime.UTC).date().isoformat()
            write_atomically(path, json.dumps(record, indent=1).encode())
            state = "done" if outcome["ok"] else f"FAILED ({outcome['why']})"
            line = f"{count} of {len(left)}: {case.name}: {state}, {outcome['cpu_s']:.0f} s"
            print(line, file=sys.stderr, flush=True)
    return record


def _begun(path: Path, hex_mm: float) -> dict[str, Any]:
    """The record of a file, or an empty one."""
    fresh = {
        **RECORD.head(),
        "version": VERSION,
        "conditions": conditions(hex_mm),
        "bodies": {family: body_digest(family) for family in FAMILIES},
        "cases": {},
    }
    if not path.exists():
        return fresh
    record = read_record(dataclasses.replace(RECORD, path=path))
    if any(record.get(name) != fresh[name] for name in SAME):
        raise StoreError(
            f"{path} was made by version {record['version']} with other code, settings, paths or "
            "bodies",
            hint="name another file",
            at=str(path),
        )
    return record


def main(words: Sequence[str] | None = None) -> int:
    """Solve the matrix, or a part of it."""
    parser = argparse.ArgumentParser(description="Solve many presses by finite elements.")
    parser.add_argument("--out", type=Path, required=True, help="record to write or go on with")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--family", choices=FAMILIES, help="this one only")
    parser.add_argument("--cases", type=int, default=0, help="the first so many; 0 for all")
    parser.add_argument("--draft", action="store_true", help=f"hexahedra of {DRAFT_MM:g} mm")
    options = parser.parse_args(words)
    hex_mm = DRAFT_MM if options.draft else FemSettings().hex_mm
    todo = [case for case in every_case(hex_mm) if options.family in (None, case.family)]
    todo = todo[: options.cases or None]
    record = solve_all(todo, options.out, options.jobs, hex_mm)
    good = sum(record["cases"][case.name]["ok"] for case in todo)
    print(f"{good} of {len(todo)} cases complete")
    return 0 if good == len(todo) else 1


if __name__ == "__main__":
    sys.exit(main())
