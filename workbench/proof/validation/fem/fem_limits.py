"""Finite elements and the contact solver beside converged limits made apart from both.

The limits are those of an axisymmetric solver with elements, contact and code of its own
(`tests/reference/axisymmetric`), on meshes halved until the force moves by less than .1 %; the
record names their uncertainty. The null is the same press with all cells as coarse as the mesh
says, which was the truth before cells were halved under a contact.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from pathlib import Path

from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer
from workbench.core.press.fem import DRAFT_MM, QUALITY_MM, FemSettings
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField, from_contact
from workbench.pipeline.devices import open_device
from workbench.pipeline.stages.press import PressInputs, press
from workbench.proof.row import Row, bounded, compared
from workbench.proof.specimens import finger_points
from workbench.proof.validation.contact.presses import tip_target
from workbench.proof.validation.fem.fem_presses import finger
from workbench.system.record import Record

RECORD = Record(
    path=Path(__file__).with_name("axisymmetric_limits.json"),
    command="python -m tests.reference.axisymmetric",
    sources=("tests.reference.axisymmetric.cases",),
)
"""The runs; what they tend to is computed from them, which a test repeats."""
FRAMES = 10
KINDS = {"ball": IndenterKind("sphere"), "cone": IndenterKind("cone")}
FRICTIONS = (0.0, 0.3)
QUALITY_LIMITS = {0.2: 0.02, 0.3: 0.01, 0.5: 0.01, 1.0: 0.01}
CONE_LIMIT = 0.015
"""Cells are finest under its point; a millimetre deep its flank touches far beyond them."""
DRAFT_LIMITS = {0.3: 0.05, 0.5: 0.05, 1.0: 0.05}
OTHERS = {"ball": 0.0, "cone": CONE_LIMIT}
SLIPPING_LIMIT = 0.02
"""With friction, the path of the rim counts too."""
CONTACT_LIMITS = {
    "ball": {0.3: 0.02, 0.5: 0.02, 1.0: 0.02},
    "cone": {0.2: 0.08, 0.3: 0.05, 0.5: 0.05, 1.0: 0.05},
}
GRID_MM = 0.5


def rows() -> list[Row]:
    """Forces on the tip of the finger."""
    return [row for thing in KINDS for mu in FRICTIONS for row in _rows(thing, mu)]


def _rows(thing: str, mu: float) -> Iterator[Row]:
    for hex_mm, limits in ((QUALITY_MM, QUALITY_LIMITS), (DRAFT_MM, DRAFT_LIMITS)):
        for depth_mm, limit in limits.items():
            yield compared(
                "fem_limit",
                f"{_words(thing, mu, depth_mm)}: {hex_mm:g} mm hexahedra halved under the contact; "
                "null: nowhere halved",
                lambda depth_mm=depth_mm, hex_mm=hex_mm: _at(_solved(thing, mu, hex_mm), depth_mm),
                limit_N(thing, mu, depth_mm),
                unit="N",
                limit=max(limit, SLIPPING_LIMIT if mu > 0.0 else OTHERS[thing]),
                record=RECORD,
                null=lambda depth_mm=depth_mm, hex_mm=hex_mm: _at(
                    _solved(thing, mu, hex_mm, halvings=0), depth_mm
                ),
            )
    yield bounded(
        "fem_error_estimate",
        f"{thing}, friction {mu:g}, from 0.2 mm on: least of the estimated error over the true "
        "one; below 1 the estimate would promise too much",
        lambda: _least_estimate(thing, mu),
        unit="1",
        limit=1.0,
        sense="min",
        null=0.0,
        record=RECORD,
    )
    for depth_mm, limit in CONTACT_LIMITS[thing].items():
        yield compared(
            "mpm_limit",
            f"{_words(thing, mu, depth_mm)}: contact solver, grid {GRID_MM:g} mm; null: finite "
            f"elements of {DRAFT_MM:g} mm, nowhere halved",
            lambda depth_mm=depth_mm: _at(_touched(thing, mu), depth_mm),
            limit_N(thing, mu, depth_mm),
            unit="N",
            limit=limit,
            record=RECORD,
            null=lambda depth_mm=depth_mm: _at(_solved(thing, mu, DRAFT_MM, halvings=0), depth_mm),
        )


def _words(thing: str, mu: float, depth_mm: float) -> str:
    return f"{thing} on the tip of the finger, {depth_mm:g} mm deep, friction {mu:g}"


def limit_N(thing: str, mu: float, depth_mm: float, *, body: str = "tip") -> float:
    """The converged force [N] of an object on the tip, or on another body of the record."""
    friction = "0" if mu == 0.0 else f"{mu:g}"
    limits = RECORD.figures()["cases"][f"{body}_{thing}_mu_{friction}"]["limits"]
    return next(one["force_N"] for one in limits if one["depth_mm"] == depth_mm)


def solved_N(thing: str, mu: float, hex_mm: float, depth_mm: float) -> float:
    """The force [N] by finite elements, which each press is solved for once."""
    return _at(_solved(thing, mu, hex_mm, error=False), depth_mm)


def _at(found: ForceField, depth_mm: float) -> float:
    return float(found.normal_N[round(depth_mm * FRAMES) - 1])


def _least_estimate(thing: str, mu: float) -> float:
    found = _solved(thing, mu, QUALITY_MM)
    ratios = []
    for depth_mm in QUALITY_LIMITS:
        limit = limit_N(thing, mu, depth_mm)
        error = abs(_at(found, depth_mm) / limit - 1.0)
        ratios.append(abs(float(found.force_error[round(depth_mm * FRAMES) - 1])) / error)
    return min(ratios)


def _press() -> Press:
    return Press(target_mm=tip_target(0.0, 0.0), depth_mm=1.0, frames=FRAMES)


@functools.cache
def _solved(
    thing: str, mu: float, hex_mm: float, *, halvings: int | None = None, error: bool = True
) -> ForceField:
    from sim.fem.press import solve_press

    settings = FemSettings(hex_mm=hex_mm, error=error)
    if halvings is not None:
        settings = FemSettings(hex_mm=hex_mm, halvings=halvings, error=False)
    case = PressCase(indenter=Indenter(kind=KINDS[thing]), press=_press(), fem=settings)
    return solve_press(finger(hex_mm), Elastomer(friction=mu), case)


@functools.cache
def _touched(thing: str, mu: float) -> ForceField:
    open_device()
    found = press(
        PressInputs(
            mesh=finger(QUALITY_MM),
            points=finger_points(GRID_MM),
            material=Elastomer(friction=mu),
            indenter=Indenter(kind=KINDS[thing]),
            path=_press(),
            settings=ContactSettings(grid_mm=GRID_MM),
        ),
        monitor=silent,
    )
    return from_contact(found)
