"""Contact: the same press in 1, 5 and 10 frames, and while it is dragged, has the same force.

What holds on to what depends on the path, so a press that is gone in fewer pieces reads less: a
ball 1 mm deep, shown live in one piece, 2.8 % less than in ten frames.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.press.soft_body import SoftBody
from workbench.core.result.sensing import Contact
from workbench.proof.row import Row, bounded
from workbench.proof.specimens import finger_mesh, finger_points
from workbench.proof.validation.contact.presses import GRID_MM, on_device, tip_target

LIMIT = 5e-3
FRAMES = (1, 5)
"""Beside ten."""
DEPTH_MM = 1.0
DRAGGED_MM = (0.5, 0.7, 0.8, DEPTH_MM)
"""Depths that a live press is dragged through."""


@dataclass(frozen=True, kw_only=True, slots=True)
class _Case:
    """A press 1 mm deep into the default finger."""

    words: str
    indenter: Indenter
    polar_deg: float = 45.0
    shear_mm: tuple[float, float] = (0.0, 0.0)

    def press(self, depth_mm: float, frames: int) -> PressCase:
        """The same in so many frames."""
        path = Press(
            target_mm=tip_target(self.polar_deg, 0.0),
            depth_mm=depth_mm,
            shear_mm=self.shear_mm,
            frames=frames,
        )
        settings = ContactSettings(grid_mm=GRID_MM)
        return PressCase(indenter=self.indenter, press=path, settings=settings)


SHEARED_MM = (0.0, 0.5)
CASES = (
    _Case(words="ball on the tip", indenter=Indenter(), polar_deg=0.0),
    _Case(words="ball at 45 degrees", indenter=Indenter()),
    _Case(words="ball at 45 degrees, then .5 mm aside", indenter=Indenter(), shear_mm=SHEARED_MM),
    _Case(words="cube at 45 degrees", indenter=Indenter(kind=IndenterKind("cube"))),
    _Case(words="soft ball at 45 degrees", indenter=Indenter(soft=SoftBody())),
)


def rows() -> Iterator[Row]:
    """A row for each press."""
    counts = ", ".join(map(str, FRAMES))
    for case in CASES:
        yield bounded(
            "one_number",
            f"{case.words}, {DEPTH_MM:g} mm deep, friction {Elastomer().friction:g}: largest "
            f"difference of the force in {counts} frames, live at once and live by steps from that "
            "in 10 frames, over it",
            on_device(lambda case=case: _difference(case)),
            unit="1",
            limit=LIMIT,
        )


def _difference(case: _Case) -> float:
    ten_N = _pressed(case, 10).reaction_N[-1]
    others = [_pressed(case, frames).reaction_N[-1] for frames in FRAMES]
    others += [_live(case, depths_mm).reaction_N[-1] for depths_mm in ((DEPTH_MM,), DRAGGED_MM)]
    return float(np.linalg.norm(others - ten_N, axis=1).max() / np.linalg.norm(ten_N))


def _pressed(case: _Case, frames: int) -> Contact:
    from sim.contact.press import press_membrane

    mesh, points = finger_mesh(), finger_points(GRID_MM)
    return press_membrane(mesh, points, Elastomer(), case.press(DEPTH_MM, frames))


def _live(case: _Case, depths_mm: tuple[float, ...]) -> Contact:
    """The last of live presses at these depths, one after the other."""
    from sim.contact.live_contact import LiveContact

    mesh, points, live = finger_mesh(), finger_points(GRID_MM), LiveContact()
    for depth_mm in depths_mm:
        found = live.press(mesh, points, Elastomer(), case.press(depth_mm, 1), key=case.words)
    return found
