"""Robustness of the contact engine: what share of many different presses settles?

Presses of one sensor are solved side by side (`sim.contact.solver.solver.solve`), so that a GPU is
filled. A press may be refused with a DesignError before it begins, settle in all its frames, or
end as a SolveError that carries its settled frames; anything else is a fault. What settles must be
finite and a contact: forces are due, and reaction, support and cut must balance.

`python -m workbench.proof.validation.contact.robustness --save FILE` writes the five sensors, and
`--load FILE` presses them on a machine without the CAD kernel; `--cases N --seed S` takes a random
choice.
"""

from __future__ import annotations

import argparse
import dataclasses
import enum
import itertools
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from workbench.core.base.errors import DesignError, SolveError
from workbench.core.design.design import Elastomer
from workbench.core.press.press import ContactSettings
from workbench.core.press.press_case import PressCase
from workbench.core.result.sensing import Contact
from workbench.pipeline.devices import open_device
from workbench.proof.row import Row, bounded, gathered
from workbench.proof.validation.contact import trials
from workbench.proof.validation.contact.trials import Sensor, Trial

if TYPE_CHECKING:
    from sim.contact.readout.problem import Problem

SETTLED_LIMIT = 0.98
FAMILY_LIMIT = 0.95
"""Of one family, where a single press is almost a percent."""
REFUSED_LIMIT = 0.05
SAMPLE = 40
SEED = 20260811
SIDE_BY_SIDE = {"cpu": 7, "cuda": 126}
"""Presses of one launch: a GPU wants many; on a CPU they take turns, and fewer are told sooner."""


class State(enum.StrEnum):
    """What became of a trial."""

    SETTLED = "settled"
    REFUSED = "refused"
    UNSETTLED = "unsettled"
    FAULT = "fault"


@dataclass(frozen=True, kw_only=True, slots=True)
class Finding:
    """What became of a trial, and why."""

    trial: Trial
    state: State
    why: str = ""
    not_finite: int = 0
    """Numbers of the result that are not finite."""
    substeps: int = 0


def rows() -> list[Row]:
    """All 630 presses and 500 more."""
    from workbench.proof.validation.contact import endurance

    return [*judged(lambda: tried(trials.every_trial())), endurance.row()]


def sample_rows() -> list[Row]:
    """A random choice of presses."""
    return judged(lambda: tried(trials.some_trials(SAMPLE, SEED)))


def tried(
    todo: Sequence[Trial], find_sensor: Callable[[str], Sensor] = trials.sensor
) -> list[Finding]:
    """Press them all, and tell on stderr what did not settle as it happens."""
    count = SIDE_BY_SIDE[open_device()]
    found: list[Finding] = []
    started = time.monotonic()
    for name, group in itertools.groupby(todo, key=lambda trial: trial.family):
        sensor = find_sensor(name)
        for some in _pieces(list(group), count):
            fresh = press_together(some, sensor)
            found += fresh
            for finding in fresh:
                if finding.state is not State.SETTLED:
                    print(f"{finding.state}: {finding.trial}: {finding.why}", file=sys.stderr)
            spent_s = time.monotonic() - started
            print(f"{len(found)} of {len(todo)} after {spent_s:.0f} s", file=sys.stderr, flush=True)
    return found


def _pieces(todo: list[Trial], count: int) -> Iterator[list[Trial]]:
    for first in range(0, len(todo), count):
        yield todo[first : first + count]


def press_together(todo: Sequence[Trial], sensor: Sensor) -> list[Finding]:
    """Press one sensor many times in one batch; never raises."""
    findings: dict[Trial, Finding] = {}
    ready: dict[Trial, Problem] = {}
    for trial in todo:
        try:
            ready[trial] = _problem(trial, sensor)
        except DesignError as error:
            state = State.REFUSED if error.hint else State.FAULT
            findings[trial] = Finding(trial=trial, state=state, why=error.message)
        except Exception as error:
            findings[trial] = Finding(trial=trial, state=State.FAULT, why=repr(error))
    for trial, result in zip(ready, _solved(list(ready.values())), strict=True):
        findings[trial] = judge(trial, result)
    return [findings[trial] for trial in todo]


def _problem(trial: Trial, sensor: Sensor) -> Problem:
    from sim.contact.readout.problem import make_problem

    path, thing = trials.path_of(trial, sensor), trials.object_of(trial)
    settings = ContactSettings(grid_mm=sensor.points.grid_mm)
    return make_problem(
        sensor.mesh,
        sensor.points,
        Elastomer(),
        PressCase(indenter=thing, press=path, settings=settings),
    )


def _solved(problems: list[Problem]) -> list[Contact | Exception]:
    """Results of a batch; where the batch itself breaks, of each press alone."""
    from sim.contact.solver.solver import solve

    if not problems:
        return []
    try:
        return list(solve(problems))
    except Exception as error:
        if len(problems) == 1:
            return [error]
        return [result for problem in problems for result in _solved([problem])]


def judge(trial: Trial, result: Contact | Exception) -> Finding:
    """Name what became of a press that was solved."""
    if isinstance(result, SolveError):
        usable = result.partial is not None and result.hint and not bad_numbers(result.partial)
        state = State.UNSETTLED if usable else State.FAULT
        why = result.message if usable else f"no usable frame or remedy: {result.message}"
        return Finding(trial=trial, state=state, why=why)
    if isinstance(result, Exception):
        return Finding(trial=trial, state=State.FAULT, why=repr(result))
    bad = bad_numbers(result)
    return Finding(
        trial=trial,
        state=State.FAULT if bad else State.SETTLED,
        why=f"{bad} numbers are not finite" if bad else "",
        not_finite=bad,
        substeps=result.substeps,
    )


def bad_numbers(contact: Contact) -> int:
    """Numbers of a result that are not finite."""
    values = (getattr(contact, field.name) for field in dataclasses.fields(contact))
    arrays = [v for v in values if isinstance(v, np.ndarray)]
    return sum(int(np.count_nonzero(~np.isfinite(array))) for array in arrays)


def judged(press: Callable[[], list[Finding]]) -> list[Row]:
    """Rows over all findings, and one for each family."""
    found = press()
    settled, refused = (_count(found, state) for state in (State.SETTLED, State.REFUSED))
    begun = max(1, len(found) - refused)
    case = (
        f"{len(found)} presses of objects of {trials.SIZE_MM:g} mm, {trials.DEPTH_SHARE:.0%} of "
        f"the wall deep, with shear of {trials.SHEAR_MM[0]:g} mm or twist of "
        f"{trials.TWIST_DEG:g} degrees"
    )
    result = [
        bounded(
            "robustness_settled",
            f"{case}: share that settles; {begun - settled} do not",
            settled / begun,
            unit="1",
            limit=SETTLED_LIMIT,
            sense="min",
        ),
        bounded(
            "robustness_errors",
            f"{case}: failures without usable frames or a remedy",
            _count(found, State.FAULT),
            unit="1",
            limit=0,
        ),
        bounded(
            "robustness_nan",
            f"{case}: numbers of the results that are not finite",
            sum(finding.not_finite for finding in found),
            unit="1",
            limit=0,
        ),
        bounded(
            "robustness_refused",
            f"{case}: share refused before it begins",
            refused / max(1, len(found)),
            unit="1",
            limit=REFUSED_LIMIT,
        ),
    ]
    return [*result, *_family_rows(found)]


def _family_rows(found: list[Finding]) -> list[Row]:
    result = []
    for name in sorted({finding.trial.family for finding in found}):
        own = [f for f in found if f.trial.family == name and f.state is not State.REFUSED]
        result.append(
            bounded(
                f"robustness_{name}",
                f"{len(own)} presses: share that settles, in at most "
                f"{max((f.substeps for f in own), default=0)} substeps",
                _count(own, State.SETTLED) / max(1, len(own)),
                unit="1",
                limit=FAMILY_LIMIT,
                sense="min",
            )
        )
    return result


def _count(found: list[Finding], state: State) -> int:
    return sum(finding.state is state for finding in found)


def main(words: Sequence[str] | None = None) -> int:
    """Save the sensors, or press saved ones."""
    from workbench.proof.row import as_json

    parser = argparse.ArgumentParser(description="Press many objects into many sensors.")
    parser.add_argument("--save", type=Path, help="write the sensors to this file and end")
    parser.add_argument("--load", type=Path, help="read the sensors from this file")
    parser.add_argument("--cases", type=int, default=0, help="random presses; 0 for all")
    parser.add_argument("--seed", type=int, default=SEED)
    options = parser.parse_args(words)
    if options.save:
        trials.save(options.save)
        return 0
    todo = trials.every_trial()
    if options.cases:
        todo = trials.some_trials(options.cases, options.seed)
    find_sensor = trials.load(options.load).__getitem__ if options.load else trials.sensor
    found = gathered("robustness", lambda: judged(lambda: tried(todo, find_sensor)))
    print(as_json(found))
    return 0 if all(row.ok for row in found) else 1


if __name__ == "__main__":
    sys.exit(main())
