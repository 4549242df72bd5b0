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


def find_sequence(design: SensorDesign, name: str) -> Sequence:
    """A sequence of a design as its family declares it.

    Raises:
        DesignError: If the design has none of that name.
    """
    known = _declared(design)
    if name not in known:
        hint = suggest(name, known) if known else "the trunk has one: grip"
        raise DesignError(
            f"the {design.family} has no sequence {shown(name)}", hint=hint, at="--sequence"
        )
    return known[name]


def sequence(
    design: SensorDesign,
    chosen: Sequence,
    *,
    indenter: Indenter | None = None,
    frames: int = FRAMES,
    settings: Mapping[str, Any] | None = None,
) -> PressCase:
    """A sequence of a design as a press.

    Args:
        design: The sensor.
        chosen: What is done: of `find_sequence`, perhaps with another depth or turn.
        indenter: The object; None takes the one that suits the lobes.
        frames: Frames of each phase.
        settings: Fields of `ContactSettings`; the grid is one that suits the lobes.

    Raises:
        DesignError: If a value is refused.
    """
    from workbench.project.aim import default_target_mm

    press = Press(
        target_mm=default_target_mm(design),
        depth_mm=chosen.depth_mm,
        frames=frames,
        strokes=(hold(2 * frames), release(frames=LIFT_FRAMES)),
        actuations=tuple(
            Actuation(
                region=lobe.region,
                turn_deg=chosen.close_deg,
                axis=lobe.axis,
                about_mm=lobe.root_mm,
                facing=lobe.outward,
                keys=((float(frames), 0.0), (2.0 * frames, 1.0), (3.0 * frames, 0.0)),
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
