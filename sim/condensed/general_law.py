"""How skins harden in general: the law for one whose own presses have not been made yet.

One law for the presses of several designs together. What it is off by is measured on each of them
with its own presses left out.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.condensed.hardening import FIRST, PlayedPress, fit, residuals
from workbench.core.result.condensed import Hardening
from workbench.system.record import Record

RECORD = Record(
    path=Path(__file__).with_name("general_law.json"),
    command="python -m workbench.proof.validation.sensor.general_law_figures FOLDER",
    sources=("sim.condensed.lessons", "sim.condensed.general_law"),
    apart=(
        "designs",
        "geometry",
        "sim.contact",
        "sim.fem",
        "sim.optics",
        "workbench.core",
        "workbench.system",
    ),
)


@functools.cache
def general_law() -> Hardening:
    """The law; `errors` are the worst of any design that it was not fitted to, by object.

    Raises:
        StoreError: If the file that holds it is missing.
    """
    found = RECORD.figures()
    errors: dict[str, float] = {}
    for of_design in found["left_out"].values():
        for name, error in of_design.items():
            errors[name] = max(error, errors.get(name, 0.0))
    return Hardening(
        normal=tuple(found["normal"]),
        tangential=tuple(found["tangential"]),
        deepest=found["deepest"],
        errors=errors,
    )


def generalised(presses: Mapping[str, Sequence[PlayedPress]]) -> dict[str, Any]:
    """The law of the presses of designs, for a record: its numbers, and its largest error in the
    normal force of each press when the press's design was left out of the fit."""
    law = fit([press for own in presses.values() for press in own])
    left_out = {}
    for design, own in presses.items():
        others = [p for name, theirs in presses.items() if name != design for p in theirs]
        without = fit(others)
        left_out[design] = {
            press.name: float(np.abs(residuals(press, without)[0][FIRST:]).max()) for press in own
        }
    return {
        "normal": law.normal,
        "tangential": law.tangential,
        "deepest": law.deepest,
        "left_out": left_out,
    }
