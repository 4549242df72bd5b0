"""Options of the command line about a body from a file: its unit, placing and repair."""

from __future__ import annotations

import argparse
import dataclasses
import math

from workbench.core.base.errors import DesignError
from workbench.core.design.design import SensorDesign
from workbench.core.design.imported import IMPORTED, LengthUnit

TURNS = ("turn_x_deg", "turn_y_deg", "turn_z_deg")


def add_body_options(sub: argparse.ArgumentParser) -> None:
    """Unit, turns, cut and repair; none has a default here."""
    sub.add_argument(
        "--unit",
        choices=[unit.value for unit in LengthUnit],
        help="unit of an STL design (default: inferred from its size)",
    )
    text = "turn a body from a file about X, then Y, then Z"
    sub.add_argument("--body-turn-deg", metavar="X,Y,Z", help=text)
    text = "then cut it off flat so far above its lowest point"
    sub.add_argument("--body-cut-mm", type=float, metavar="MM", help=text)
    text = "remesh a body that cannot be used as it is; the refusal says by how much it deviates"
    sub.add_argument("--repair", action="store_true", help=text)


def placed_design(options: argparse.Namespace, design: SensorDesign) -> SensorDesign:
    """The design with its body read and placed as the options say.

    Raises:
        DesignError: If they are given for a design without a body of its own, or are no numbers.
    """
    given = {
        "--unit": options.unit,
        "--body-turn-deg": options.body_turn_deg,
        "--body-cut-mm": options.body_cut_mm,
        "--repair": options.repair or None,
    }
    named = [name for name, value in given.items() if value is not None]
    if not named:
        return design
    if design.family != IMPORTED or design.body is None:
        raise DesignError(
            f"{named[0]} is for a body from a file, and {design.name[:80]} is of the family "
            f"{design.family}",
            hint=f"leave {' and '.join(named)} away, or give the path of an STL or STEP file",
            at=named[0],
        )
    body = design.body
    if options.unit is not None:
        body = dataclasses.replace(body, unit=LengthUnit(options.unit))
    if options.repair:
        body = dataclasses.replace(body, repair=True)
    design = dataclasses.replace(design, body=body)
    if options.body_turn_deg is not None:
        for name, value in zip(TURNS, _three(options.body_turn_deg), strict=True):
            design = design.replace(f"shape.{name}", value)
    if options.body_cut_mm is not None:
        design = design.replace("shape.cut_mm", options.body_cut_mm)
    return design


def _three(words: str) -> list[float]:
    try:
        values = [float(word) for word in words.split(",")]
    except ValueError:
        values = []
    if len(values) != len(TURNS) or not all(math.isfinite(value) for value in values):
        raise DesignError(
            f"--body-turn-deg is {words[:80]!r}, expected three angles in degrees",
            hint="for example --body-turn-deg 90,0,0",
            at="--body-turn-deg",
        )
    return values
