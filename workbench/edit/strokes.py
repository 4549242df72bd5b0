"""Strokes as words of the command line: KIND:AMOUNT[:FRAMES], amounts separated by commas.

`press:0.5` mm deeper, `slide:3,0` mm along U and V, `twist:30` degrees, `roll:30,90` degrees about
the axis at 90 degrees from U, `lift:0.2` mm, `release` or `release:1` mm clear of the skin,
`hold:5` frames, `move:1,0,-0.2` mm along U, V and outward. Without frames they take those of the
approach.
"""

from __future__ import annotations

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.press.motion import (
    Stroke,
    StrokeKind,
    hold,
    lift,
    move,
    press_stroke,
    release,
    roll,
    slide,
    twist,
)

AT = "press.strokes"
AMOUNTS = {
    StrokeKind.PRESS: (1, 1),
    StrokeKind.SLIDE: (2, 2),
    StrokeKind.TWIST: (1, 1),
    StrokeKind.ROLL: (1, 2),
    StrokeKind.LIFT: (1, 1),
    StrokeKind.RELEASE: (0, 1),
    StrokeKind.HOLD: (0, 1),
    StrokeKind.MOVE: (3, 3),
}
"""Least and largest count of numbers of each kind."""
EXAMPLES = {
    StrokeKind.PRESS: "press:0.5",
    StrokeKind.SLIDE: "slide:3,0:10",
    StrokeKind.TWIST: "twist:30",
    StrokeKind.ROLL: "roll:30,90",
    StrokeKind.LIFT: "lift:0.2",
    StrokeKind.RELEASE: "release",
    StrokeKind.HOLD: "hold:5",
    StrokeKind.MOVE: "move:1,0,-0.2",
}


def read_stroke(text: str, *, frames: int) -> Stroke:
    """A stroke from its words.

    Args:
        text: KIND:AMOUNT[:FRAMES].
        frames: Frames of a stroke that names none.

    Raises:
        DesignError: If the kind is unknown or the numbers do not fit it.
    """
    name, *parts = text.strip().split(":")
    kinds = [kind.value for kind in StrokeKind]
    if name not in kinds:
        raise DesignError(
            f"there is no stroke {shown(name)}",
            hint=f"{suggest(name, kinds)}; for example {EXAMPLES[StrokeKind.SLIDE]}",
            at=AT,
        )
    kind = StrokeKind(name)
    amounts = _numbers(text, kind, parts[0] if parts else "")
    fewest, most = AMOUNTS[kind]
    if not fewest <= len(amounts) <= most or len(parts) > 2:
        raise _unreadable(text, kind)
    if kind is StrokeKind.HOLD:
        # What others call frames is all that a hold has.
        parts = ["", parts[0]] if amounts else []
    if len(parts) == 2:
        counts = _numbers(text, kind, parts[1])
        if len(counts) != 1 or not counts[0].is_integer():
            raise _unreadable(text, kind)
        frames = int(counts[0])
    return _made(kind, amounts, frames)


def _made(kind: StrokeKind, amounts: tuple[float, ...], frames: int) -> Stroke:
    match kind, amounts:
        case StrokeKind.PRESS, (deeper_mm,):
            return press_stroke(deeper_mm, frames=frames)
        case StrokeKind.SLIDE, (u_mm, v_mm):
            return slide(u_mm, v_mm, frames=frames)
        case StrokeKind.TWIST, (turn_deg,):
            return twist(turn_deg, frames=frames)
        case StrokeKind.ROLL, (turn_deg, *axis_deg):
            return roll(turn_deg, axis_deg=sum(axis_deg), frames=frames)
        case StrokeKind.LIFT, (out_mm,):
            return lift(out_mm, frames=frames)
        case StrokeKind.RELEASE, (clearance_mm,):
            return release(clearance_mm=clearance_mm, frames=frames)
        case StrokeKind.RELEASE, ():
            return release(frames=frames)
        case StrokeKind.MOVE, (u_mm, v_mm, out_mm):
            return move(u_mm, v_mm, out_mm, frames=frames)
        case _:
            return hold(frames)


def _numbers(text: str, kind: StrokeKind, words: str) -> tuple[float, ...]:
    try:
        return tuple(float(word) for word in words.split(",") if words)
    except ValueError:
        raise _unreadable(text, kind) from None


def _unreadable(text: str, kind: StrokeKind) -> DesignError:
    return DesignError(
        f"the stroke {shown(text)} cannot be read",
        hint=f"KIND:AMOUNT[:FRAMES], for example {EXAMPLES[kind]}",
        at=AT,
    )
