"""Sequences of a sensor with driven parts, as presses: sense, close, open, lift.

    frames 1 .. K        the object is pressed to its depth, the lobes rest
    frames K+1 .. 2K     the lobes close on it, linearly
    frames 2K+1 .. 3K    they open again
    two frames           the object is lifted clear of the skin

with K frames to a phase. Which lobes there are, about which axes they turn and what they hold is
the family's to say (`designs.family.Actuated`). The result is a `PressCase` like any other: it is
solved, shot and played back frame by frame. Contact is quasi-static, so K sets only how finely the
motion is divided. Source of the grip: SimTac, Fig. 10.

Leaves out: an object that is free to move while it is held, and driving by force.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from designs.sequence import Sequence
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.design.design import SensorDesign
from workbench.core.press.actuation import Actuation
from workbench.core.press.indenter import Indenter
from workbench.core.press.motion import hold, release
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase

FRAMES = 5
"""Frames of each phase where none are named."""
LIFT_FRAMES = 2


def titles(design: SensorDesign) -> dict[str, str]:
    """The design's sequences: name, and what it is for people; empty where nothing is driven."""
    return {name: each.title for name, each in _declared(design).items()}


def sequence(
    design: SensorDesign,
    name: str,
    *,
    indenter: Indenter | None = None,
    depth_mm: float | None = None,
    frames: int | None = None,
    close_deg: float | None = None,
    settings: Mapping[str, Any] | None = None,
) -> PressCase:
    """A sequence of a design as a press.

    Args:
        design: The sensor.
        name: One of `titles`.
        indenter: The object; None takes the one that suits the lobes.
        depth_mm: How deep it is pressed before the lobes close [mm]; None as the family says.
        frames: Frames of each phase.
        close_deg: How far the lobes turn [degree]; None as the family says.
        settings: Fields of `ContactSettings`; the grid is one that suits the lobes.

    Raises:
        DesignError: If the design has no such sequence, or a value is refused.
    """
    from workbench.project.aim import default_target_mm

    known = _declared(design)
    if name not in known:
        hint = suggest(name, known) if known else "the trunk has one: grip"
        raise DesignError(
            f"the {design.family} has no sequence {shown(name)}", hint=hint, at="--sequence"
        )
    chosen = known[name]
    count = FRAMES if frames is None else frames
    press = Press(
        target_mm=default_target_mm(design),
        depth_mm=chosen.depth_mm if depth_mm is None else depth_mm,
        frames=count,
        strokes=(hold(2 * count), release(frames=LIFT_FRAMES)),
        actuations=tuple(
            Actuation(
                region=lobe.region,
                turn_deg=chosen.close_deg if close_deg is None else close_deg,
                axis=lobe.axis,
                about_mm=lobe.root_mm,
                facing=lobe.outward,
                keys=((float(count), 0.0), (2.0 * count, 1.0), (3.0 * count, 0.0)),
            )
            for lobe in chosen.lobes
        ),
    )
    return PressCase(
        indenter=indenter or Indenter(kind=chosen.kind, size_mm=chosen.size_mm),
        press=press,
        settings=ContactSettings(**{"grid_mm": chosen.grid_mm, **(settings or {})}),
    )


def _declared(design: SensorDesign) -> dict[str, Sequence]:
    from designs.family import resolve_shape, sequences

    return sequences(design.family, resolve_shape(design.family, design.shape), design.layers)
