"""Where the press aims: a click on the skin, a target that a new shape left in the air, the object.

A body that has just come from a file also gets its LED ring brought inside it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ui.desk.desk import Desk
from workbench.core.design.imported import IMPORTED
from workbench.core.result.results import Solid
from workbench.planning.fitting import fitted
from workbench.project.aim import default_target_mm

AIM_LIMIT_MM = 4.0
"""Distance from target to skin at which the target follows; the solver refuses beyond 5 mm."""


class Aiming:
    """Where one desk's press aims, on the body that is on show."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self._framed: tuple[str, str] | None = None
        """The kind of sensor that the eye was last set for."""

    def aim_at(self, event: Any) -> None:
        """A click goes to who asked for it; else it labels a face, or moves the target there."""
        desk = self.desk
        origin, direction = np.asarray(event.ray_origin), np.asarray(event.ray_direction)
        taken = any(takes(origin, direction) for takes in desk.click_handlers)
        if taken or desk.probe(origin, direction):
            return
        hit = desk.scene.body.hit(origin, direction)
        if hit is None or desk.pick(hit[0]):
            return
        x, y, z = (round(float(c), 2) for c in hit[1])
        desk.edit("case.press.target_mm", (x, y, z))
        desk.fields.refresh()
        place = f"{x:.1f}, {y:.1f}, {z:.1f} mm"
        desk.log(f"target {place}")
        # A click may have been meant for something else; on most tabs nothing else would tell.
        told = f"target {place}; Ctrl+Z takes it back"
        if not desk.live:
            told += ". L drags the press over the skin, with force and image at once"
        desk.reports.notify("The press aims elsewhere", told)

    def show_body(self, solid: Solid) -> None:
        """Show another body, with its aim on the skin and the object on it."""
        desk, origin = self.desk, self.desk.session.origin()
        desk.scene.show_solid(solid)
        if origin != self._framed:
            self._fit_ring(solid)
        self.keep_aim()
        if origin != self._framed:
            # Another kind of body; within a family the designer's own view is kept.
            self._framed = origin
            desk.scene.frame_body(desk.session.case.press.target_mm)
        desk.scene.object.place(desk.session.case.press)

    def _fit_ring(self, solid: Solid) -> None:
        """Bring the LEDs of a body that has just come from a file inside it, and say so."""
        desk = self.desk
        if desk.session.design.family != IMPORTED:
            return
        design, changed = fitted(desk.session.design, solid)
        if changed:
            desk.session.amend("design.optics", design.optics)
            desk.scene.rig.show_optics(design.optics)
            self.desk.amended(changed)

    def keep_aim(self) -> None:
        """Bring a target that a change of shape left in the air back to the skin, and say so."""
        desk = self.desk
        place = desk.scene.body.place_near(desk.session.case.press.target_mm)
        if place is not None and place.distance_mm > AIM_LIMIT_MM:
            point, distance_mm = place.point_mm, place.distance_mm
            design, solid = desk.session.design, desk.scene.body.solid
            if design.family == IMPORTED and solid is not None:
                point = default_target_mm(design, solid)
            x, y, z = (round(float(c), 2) for c in point)
            desk.session.amend("case.press.target_mm", (x, y, z))
            self.desk.amended(
                f"the target was {distance_mm:.1f} mm off the skin: it is now {x}, {y}, {z}"
            )
