"""A ball that slides on a flat layer, and one that is lifted off it.

On a flat skin the depth stays while the ball slides, so the friction cone can be read point by
point; the global ratio T / N exceeds mu a little because the ball ploughs.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from sim.contact.press import press_membrane
from sim.contact.studies import specimens
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.motion import Stroke, release, slide
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.sensing import Contact

FRICTION = 0.3
BALL_MM = 6.0
"""Diameter of the ball [mm]."""
DEPTH_MM = 0.6
HEIGHT_MM = 2.0
LENGTH_MM = 16.0
"""Of the block, along the slide [mm]."""
WIDTH_MM = 11.0
GRID_MM = 0.5
SLIDE_MM = 3.0
STICKING_MM = 1.0
"""Way within which parts of the contact may still stick [mm]."""


@functools.cache
def press_and(strokes: tuple[Stroke, ...]) -> Contact:
    """Press the ball in one frame, then follow the strokes; U is +X here."""
    mesh, points = specimens.flat_block(
        width_mm=LENGTH_MM, length_mm=WIDTH_MM, height_mm=HEIGHT_MM, grid_mm=GRID_MM
    )
    return press_membrane(
        mesh,
        points,
        Elastomer(friction=FRICTION),
        PressCase(
            indenter=Indenter(size_mm=BALL_MM),
            press=path(strokes),
            settings=ContactSettings(grid_mm=GRID_MM, active_radius_mm=LENGTH_MM),
        ),
    )


def path(strokes: tuple[Stroke, ...]) -> Press:
    """The ball pressed in one frame, at one end of its slide, and what follows."""
    start_mm = -0.5 * SLIDE_MM
    return Press(target_mm=(start_mm, 0.0, HEIGHT_MM), depth_mm=DEPTH_MM, frames=1, strokes=strokes)


def slid(frame_mm: float) -> Contact:
    """The ball slides 3 mm in frames of a given way."""
    return press_and((slide(SLIDE_MM, 0.0, frames=round(SLIDE_MM / frame_mm)),))


def cone_ratios(contact: Contact) -> np.ndarray:
    """Sum of the points' tangential over that of their normal forces after the first mm, (K,)."""
    ratio = contact.tangential_N / contact.pressing_N
    way_mm = np.linalg.norm(contact.indenter_pose[:, :2] - contact.indenter_pose[0, :2], axis=1)
    return ratio[way_mm >= STICKING_MM - 1e-9]


def global_ratio(contact: Contact) -> float:
    """|tangential| over normal reaction of the last frame."""
    normal_N = float(contact.normal_N[-1])
    aside_N = contact.reaction_N[-1] - normal_N * contact.normal
    return float(np.linalg.norm(aside_N)) / normal_N


@dataclass(frozen=True, kw_only=True, slots=True)
class Release:
    """What a release cost and left."""

    substeps: int
    residue: float
    """Reaction that is left over the peak reaction [1]."""


@functools.cache
def released(frames: int = 1) -> Release:
    """Lift the ball clear: substeps of these frames alone, by difference with a press without."""
    pressed, free = press_and(()), press_and((release(frames=frames),))
    peak_N = float(np.linalg.norm(free.reaction_N, axis=1).max())
    return Release(
        substeps=free.substeps - pressed.substeps,
        residue=float(np.linalg.norm(free.reaction_N[-1])) / peak_N,
    )
