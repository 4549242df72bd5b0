"""The motions that open a mould, in words and as rows that a program can replay."""

from __future__ import annotations

import json
from collections.abc import Sequence

from workbench.core.result.fabrication import PartMotion

AXES = "XYZ"
ALONG = 0.9999
"""A direction with this cosine to an axis is along it."""


def recipe_json(motions: Sequence[PartMotion]) -> bytes:
    """The motions in order: step, part (the stem of its STL file), direction, distance [mm]."""
    rows = [
        {
            "step": motion.step,
            "part": motion.part,
            "direction": list(motion.direction),
            "distance_mm": motion.distance_mm,
        }
        for motion in motions
    ]
    return (json.dumps(rows, indent=1) + "\n").encode()


def direction_words(direction: tuple[float, float, float]) -> str:
    """A unit direction as a person says it: an axis, or three numbers."""
    for axis, share in zip(AXES, direction, strict=True):
        if abs(share) > ALONG:
            return f"{'+' if share > 0.0 else '-'}{axis}"
    # Adding 0 turns a rounded -0.0 into 0.0.
    return "(" + ", ".join(f"{round(share, 2) + 0.0:.2f}" for share in direction) + ")"


def closing_steps(motions: Sequence[PartMotion], screws: int) -> list[str]:
    """How the parts come together: the motions run backward, in reverse order."""
    if not motions:
        return []
    outer = " and ".join(motion.part for motion in motions if motion.part != "core")
    bolts = f"with {screws} M3 bolts, a washer under each head and nut"
    if motions[-1].part == "core":
        return [
            f"Stand the core on its flange and bring {outer} to it, along the arrows backward, "
            f"until the lugs sit in their sockets; bolt them together {bolts}, and turn the mould "
            "flange up."
        ]
    return [
        f"Bolt {outer} together {bolts}, and turn them tip down.",
        f"Close the mould with the core, flange up, along {_backward(motions[0])}.",
    ]


def opening_steps(motions: Sequence[PartMotion], *, hollow: bool) -> list[str]:
    """How the mould is opened, a step for each motion.

    Args:
        hollow: Whether the core stands in the skin, and is no flat lid.
    """
    steps = []
    for motion in motions:
        way = f"{motion.distance_mm:.0f} mm along {direction_words(motion.direction)}"
        if motion.part != "core":
            steps.append(f"Pull {motion.part} {way}.")
        elif motion is motions[-1] and hollow:
            steps.append(f"Roll the skin off the core, drawing the core {way}.")
        elif hollow:
            steps.append(f"Draw the core out of the skin, {way}.")
        else:
            steps.append(f"Lift the core, a flat lid, {way}.")
    return ["Open the bolts.", *steps, "Cut gate and vents flush."]


def _backward(motion: PartMotion) -> str:
    x, y, z = (-share for share in motion.direction)
    return direction_words((x, y, z))
