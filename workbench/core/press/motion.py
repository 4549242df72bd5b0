"""What the object does after the approach: strokes, one after the other, and who moves.

A stroke is a straight move, or a turn at one speed, in the frame (U, V, n) of the target: U and V
span the tangent plane, n is the outward normal. Speed enters nowhere: contact is quasi-static, a
frame is a state of rest, and the number of frames only says how finely a stroke is divided.

A roll goes without slipping on the tangent plane: while the body turns by a small angle about an
axis a of that plane, its origin advances by (height of the origin above the contact plane) x angle
along a x n, so that the lowest point of a ball stands still. The height is that of first touch
less the depth; it is kept during a roll, also for bodies that are not round.
Left out: strokes that follow a curved skin (give a trajectory).
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError

AT = "press.strokes"


class Mover(enum.StrEnum):
    """Which of the two moves in the room; contact depends on their relative pose alone."""

    OBJECT = "object"
    SENSOR = "sensor"


class StrokeKind(enum.StrEnum):
    """Moves after the approach."""

    PRESS = "press"
    """Deeper along the inward normal."""
    SLIDE = "slide"
    """Along U and V."""
    TWIST = "twist"
    """About the outward normal through the body's origin."""
    ROLL = "roll"
    """About an axis in the tangent plane, without slipping."""
    LIFT = "lift"
    """Outward along the normal."""
    RELEASE = "release"
    """Outward until the object is clear of the undeformed skin."""
    HOLD = "hold"
    """Nothing: frames of rest, for instance while regions are driven."""
    MOVE = "move"
    """Along U, V and n at once."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Stroke:
    """One move; the functions below make them with only the numbers that they need."""

    kind: StrokeKind
    shift_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Way along U, V and the outward n [mm]: of press, slide, lift and move."""
    turn_deg: float = 0.0
    """Angle of twist or roll, right-handed [degree]."""
    axis_deg: float = 0.0
    """Axis of a roll: its angle from U toward V [degree]."""
    clearance_mm: float = 0.5
    """Gap to the undeformed skin after a release [mm]."""
    frames: int = 10
    """Frames that the stroke takes."""

    def __post_init__(self) -> None:
        for way_mm in self.shift_mm:
            within(way_mm, -100.0, 100.0, what=f"way of a {self.kind}", unit="mm", at=AT)
        within(self.turn_deg, -360.0, 360.0, what=f"turn of a {self.kind}", unit="degree", at=AT)
        within(self.axis_deg, -360.0, 360.0, what="axis of a roll", unit="degree", at=AT)
        within(self.clearance_mm, 0.0, 50.0, what="clearance of a release", unit="mm", at=AT)
        within(self.frames, 1, 500, what=f"frame count of a {self.kind}", unit="", at=AT)
        moves = self.kind in (
            StrokeKind.PRESS,
            StrokeKind.SLIDE,
            StrokeKind.LIFT,
            StrokeKind.MOVE,
        )
        turns = self.kind in (StrokeKind.TWIST, StrokeKind.ROLL)
        if (any(self.shift_mm) and not moves) or (self.turn_deg and not turns):
            raise DesignError(
                f"a {self.kind} has shift {self.shift_mm} mm and turn {self.turn_deg:g} degree",
                hint="shifts belong to press, slide, lift and move, turns to twist and roll",
                at=AT,
            )

    @property
    def text(self) -> str:
        """The stroke in words of the command line, without its frames."""
        u_mm, v_mm, out_mm = self.shift_mm
        amount = {
            StrokeKind.PRESS: f":{-out_mm:g}",
            StrokeKind.SLIDE: f":{u_mm:g},{v_mm:g}",
            StrokeKind.TWIST: f":{self.turn_deg:g}",
            StrokeKind.ROLL: f":{self.turn_deg:g},{self.axis_deg:g}",
            StrokeKind.LIFT: f":{out_mm:g}",
            StrokeKind.RELEASE: f":{self.clearance_mm:g}",
            StrokeKind.HOLD: "",
            StrokeKind.MOVE: f":{u_mm:g},{v_mm:g},{out_mm:g}",
        }
        return f"{self.kind.value}{amount[self.kind]}"


def press_stroke(deeper_mm: float, *, frames: int = 10) -> Stroke:
    """Go deeper by `deeper_mm`."""
    return Stroke(kind=StrokeKind.PRESS, shift_mm=(0.0, 0.0, -deeper_mm), frames=frames)


def slide(u_mm: float, v_mm: float, *, frames: int = 10) -> Stroke:
    """Slide by `u_mm` and `v_mm` along U and V in the tangent plane, in `frames` frames."""
    return Stroke(kind=StrokeKind.SLIDE, shift_mm=(u_mm, v_mm, 0.0), frames=frames)


def twist(turn_deg: float, *, frames: int = 10) -> Stroke:
    """Turn by `turn_deg` [degree] about the outward normal, in `frames` frames."""
    return Stroke(kind=StrokeKind.TWIST, turn_deg=turn_deg, frames=frames)


def roll(turn_deg: float, *, axis_deg: float = 0.0, frames: int = 10) -> Stroke:
    """Roll by `turn_deg` [degree] on the skin, in `frames` frames.

    The axis is cos(`axis_deg`) U + sin(`axis_deg`) V; about U the object advances along -V.
    """
    return Stroke(kind=StrokeKind.ROLL, turn_deg=turn_deg, axis_deg=axis_deg, frames=frames)


def lift(out_mm: float, *, frames: int = 10) -> Stroke:
    """Go outward by `out_mm`, in `frames` frames."""
    return Stroke(kind=StrokeKind.LIFT, shift_mm=(0.0, 0.0, out_mm), frames=frames)


def release(*, clearance_mm: float = 0.5, frames: int = 10) -> Stroke:
    """Go outward in `frames` frames until `clearance_mm` clear of the skin: no force is left."""
    return Stroke(kind=StrokeKind.RELEASE, clearance_mm=clearance_mm, frames=frames)


def hold(frames: int = 10) -> Stroke:
    """Stay."""
    return Stroke(kind=StrokeKind.HOLD, frames=frames)


def move(u_mm: float, v_mm: float, out_mm: float, *, frames: int = 10) -> Stroke:
    """Go along U, V and n at once."""
    return Stroke(kind=StrokeKind.MOVE, shift_mm=(u_mm, v_mm, out_mm), frames=frames)
