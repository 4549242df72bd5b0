"""Where the press aims: a click on the skin, a target that a new shape left in the air, the object.

A body that has just come from a file also gets its LED ring brought inside it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ui.desk.front import Front
from workbench.core.design.imported import IMPORTED
from workbench.core.result.results import Solid
from workbench.planning.fitting import fitted
from workbench.project.aim import default_target_mm

AIM_LIMIT_MM = 4.0
"""Distance from target to skin at which the target follows; the solver refuses beyond 5 mm."""


class Aiming:
    """Where one front's press aims, on the body that is on show."""

    def __init__(self, front: Front) -> None:
        self.front = front
        self._framed: tuple[str, str] | None = None
        """The kind of sensor that the eye was last set for."""

    def aim_at(self, event: Any) -> None:
        """A click goes to who asked for it; else it labels a face, or moves the target there."""
        front = self.front
        origin, direction = np.asarray(event.ray_origin), np.asarray(event.ray_direction)
        taken = any(takes(origin, direction) for takes in front.click_handlers)
        if taken or front.probe(origin, direction):
            return
        hit = front.scene.body.hit(origin, direction)
        if hit is None or front.pick(hit[0]):
            return
        x, y, z = (round(float(c), 2) for c in hit[1])
        front.edit("case.press.target_mm", (x, y, z))
        front.fields.refresh()
        place = f"{x:.1f}, {y:.1f}, {z:.1f} mm"
        front.log(f"target {place}")
        # A click may have been meant for something else; on most tabs nothing else would tell.
        front.reports.notify("The press aims elsewhere", f"target {place}; Ctrl+Z takes it back")

    def show_body(self, solid: Solid) -> None:
        """Show another body, with its aim on the skin and the object on it."""
        front, origin = self.front, self.front.session.origin()
        front.scene.show_solid(solid)
        if origin != self._framed:
            # Another kind of body; within a family the designer's own view is kept.
            self._framed = origin
            front.scene.frame_body()
            self._fit_ring(solid)
        self.keep_aim()
        front.scene.object.place(front.session.case.press)

    def _fit_ring(self, solid: Solid) -> None:
        """Bring the LEDs of a body that has just come from a file inside it, and say so."""
        front = self.front
        if front.session.design.family != IMPORTED:
            return
        design, changed = fitted(front.session.design, solid)
        if changed:
            front.session.amend("design.optics", design.optics)
            front.scene.rig.show_optics(design.optics)
            self.front.amended(changed)

    def keep_aim(self) -> None:
        """Bring a target that a change of shape left in the air back to the skin, and say so."""
        front = self.front
        place = front.scene.body.place_near(front.session.case.press.target_mm)
        if place is not None and place.distance_mm > AIM_LIMIT_MM:
            point, distance_mm = place.point_mm, place.distance_mm
            design, solid = front.session.design, front.scene.body.solid
            if design.family == IMPORTED and solid is not None:
                point = default_target_mm(design, solid)
            x, y, z = (round(float(c), 2) for c in point)
            front.session.amend("case.press.target_mm", (x, y, z))
            self.front.amended(
                f"the target was {distance_mm:.1f} mm off the skin: it is now {x}, {y}, {z}"
            )
