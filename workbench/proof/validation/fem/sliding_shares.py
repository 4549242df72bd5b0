"""How much of a contact slides and when all of it does, beside converged finite elements.

The finite elements are recorded (`slip_record`); both solvers count by `sim.forces.slip`. Under a
ball there is a closed form besides, the partial slip of Cattaneo and Mindlin. The null
of a share is what the forces alone would say: tangential over mu times the normal one.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator

import numpy as np

from sim.forces.slip import mindlin_share
from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings
from workbench.core.result.force_field import ForceField
from workbench.core.result.sensing import Contact
from workbench.pipeline.stages.press import PressInputs, press
from workbench.proof.row import Row, bounded, compared
from workbench.proof.specimens import finger_points
from workbench.proof.validation.contact.presses import on_device
from workbench.proof.validation.fem import slip_record
from workbench.proof.validation.fem.slip_record import (
    BALL,
    CASES,
    DEPTH_MM,
    FRAME_MM,
    PRESSED,
    RECORD,
    SlipCase,
    figures,
    recorded,
)

GRID_MM = 0.5
SHARE_LIMIT = 0.1
ONSET_LIMIT_MM = 0.1
RATIO_LIMIT = 0.02
MINDLIN_FEM_LIMIT = 0.05
"""Of a half-space; the wall is 2 mm thick, and the contact 1.3 mm in radius."""
DRAFT_MM = 0.9


def rows() -> list[Row]:
    """All rows of what slides."""
    found = [row for case in CASES for row in _case_rows(case)]
    return [*_partial_slip(), *found, _ratio(), _draft()]


def _partial_slip() -> Iterator[Row]:
    case = next(case for case in CASES if case.name == "sphere_tip")
    solvers = {
        "finite elements": (MINDLIN_FEM_LIMIT, lambda: recorded(case.name), RECORD),
        f"contact solver, grid {GRID_MM:g} mm": (
            SHARE_LIMIT,
            lambda: figures(pressed(case)),
            None,
        ),
    }
    for solver, (limit, found, record) in solvers.items():
        yield bounded(
            "partial_slip",
            f"ball on the finger's tip, dragged, {solver}: share of the contact that slides, most "
            "that a frame is off Mindlin's annulus at the force of its middle; null: all sticks",
            on_device(lambda found=found: _off_mindlin(found())),
            unit="1",
            limit=limit,
            null=on_device(lambda found=found: _off_mindlin(found(), scale=0.0)),
            record=record,
        )


def _off_mindlin(found: dict, *, scale: float = 1.0) -> float:
    """Largest difference to the closed form in a frame in which a part sticks."""
    share = scale * np.array(found["sliding_share"])
    ratio = np.array(found["tangential_N"]) / np.array(found["normal_N"])
    middle = 0.5 * (ratio[1:] + ratio[:-1])[PRESSED - 1 :] / Elastomer().friction
    # A ball ploughs: from mu on all slides, also where the round tip then lowers the ratio.
    partial = np.logical_and.accumulate(middle < 1.0)
    exact = np.array([mindlin_share(one) for one in middle[partial]])
    return float(np.abs(share[PRESSED:][partial] - exact).max())


def _case_rows(case: SlipCase) -> Iterator[Row]:
    words = f"{case.kind.value} on the finger's {case.place}, mu {Elastomer().friction:g}"
    stages = {
        f"{DEPTH_MM:g} mm straight in": slice(0, PRESSED),
        f"then {case.slid * FRAME_MM:g} mm along": slice(PRESSED, None),
    }
    for stage, frames in stages.items():
        yield compared(
            "slip_share",
            f"{words}, {stage}: share of the contact's area that slides, the frame farthest from "
            "converged finite elements; null: tangential over mu times normal force",
            on_device(functools.partial(_farthest, case, frames, "value")),
            on_device(functools.partial(_farthest, case, frames, "reference")),
            unit="1",
            limit=SHARE_LIMIT,
            relative=False,
            null=on_device(functools.partial(_farthest, case, frames, "null")),
            record=RECORD,
        )
    yield compared(
        "gross_slip",
        f"{words}: way along the skin at which all of the contact begins to slide, against "
        "converged finite elements; null: at once",
        on_device(lambda: _onset_mm(figures(pressed(case)))),
        lambda: _onset_mm(recorded(case.name)),
        unit="mm",
        limit=ONSET_LIMIT_MM,
        relative=False,
        null=0.0,
        record=RECORD,
    )


@functools.cache
def pressed(case: SlipCase) -> Contact:
    """A case by the contact solver, on the skin of the recorded hexahedra."""
    return press(
        PressInputs(
            mesh=slip_record.finger(slip_record.QUALITY_MM),
            points=finger_points(GRID_MM),
            material=Elastomer(),
            indenter=Indenter(kind=case.kind),
            path=case.press,
            settings=ContactSettings(grid_mm=GRID_MM),
        ),
        monitor=silent,
    )


def _farthest(case: SlipCase, frames: slice, which: str) -> float:
    """Share of the frame that is farthest from the recorded one, or what stands beside it."""
    here, there = figures(pressed(case)), recorded(case.name)
    value, reference = (np.array(one["sliding_share"])[frames] for one in (here, there))
    aside, down = (np.array(here[name])[frames] for name in ("tangential_N", "normal_N"))
    null = np.minimum(aside / (Elastomer().friction * down), 1.0)
    frame = int(np.argmax(np.abs(value - reference)))
    return float({"value": value, "reference": reference, "null": null}[which][frame])


def _onset_mm(found: dict) -> float:
    """The recorded way; infinite where not all of the contact slid."""
    way_mm = found["gross_slip_mm"]
    return np.inf if way_mm is None else float(way_mm)


def _ratio() -> Row:
    from sim.contact.studies import sliding

    def theirs() -> float:
        found = recorded(BALL)
        return found["tangential_N"][-1] / found["normal_N"][-1]

    return compared(
        "slip_ratio_global",
        f"ball R {sliding.BALL_MM / 2:g} mm, {sliding.DEPTH_MM:g} mm deep in a flat layer of "
        f"{sliding.HEIGHT_MM:g} mm, mu {sliding.FRICTION:g}, {sliding.SLIDE_MM:g} mm of sliding: "
        "tangential over normal reaction at the end, against converged finite elements; the ball "
        "ploughs; null: mu, as if it did not",
        on_device(lambda: sliding.global_ratio(sliding.slid(0.1))),
        theirs,
        unit="1",
        limit=RATIO_LIMIT,
        null=sliding.FRICTION,
        record=RECORD,
    )


def _draft() -> Row:
    case = next(case for case in CASES if case.name == "sphere_tip")

    def share(which: int) -> float:
        here = np.array(figures(_drafted(case))["sliding_share"])
        there = np.array(recorded(case.name)["sliding_share"])
        return float((here, there)[which][np.argmax(np.abs(here - there))])

    return compared(
        "slip_share_mesh",
        f"{case.kind.value} on the finger's tip by finite elements of {DRAFT_MM:g} mm against "
        f"{slip_record.QUALITY_MM:g} mm: share that slides, in the frame where they differ most",
        on_device(lambda: share(0)),
        on_device(lambda: share(1)),
        unit="1",
        limit=SHARE_LIMIT,
        relative=False,
        record=RECORD,
    )


@functools.cache
def _drafted(case: SlipCase) -> ForceField:
    return slip_record.solved(case, hex_mm=DRAFT_MM)
