"""What cannot be made, said: the checks of mould, housing and recipe for a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.core.result.fabrication import FabricationCheck, Severity
from workbench.system.terminal import complain

WORDS = {Severity.BAD: "red", Severity.WARNING: "amber", Severity.GOOD: "green"}
FAILED = 1
"""Exit code of a command whose parts cannot be made."""


def check_line(check: FabricationCheck) -> str:
    """One check as a line: colour, name, message, place."""
    place = ", ".join(f"{round(value, 1) + 0.0:.1f}" for value in check.place_mm)
    colour = WORDS[check.severity]
    return f"{colour:5} {check.name}: {check.message} At {place} mm."


def red(checks: Sequence[FabricationCheck]) -> list[FabricationCheck]:
    """Those that say that something cannot be made."""
    return [check for check in checks if check.severity is Severity.BAD]


def complain_of_red(checks: Sequence[FabricationCheck]) -> int:
    """Say what cannot be made on stderr; returns the exit code of a strict command."""
    found = red(checks)
    for check in found:
        complain(check_line(check))
    if found:
        complain(f"red checks: {len(found)}; the sensor cannot be made as it is")
    return FAILED if found else 0
