"""The object that presses, in the 3D view: where it stands, its shape, and who hides it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ui.scene.nodes import replace
from ui.scene.sensor import SensorView
from workbench.core.base.poses import rotations
from workbench.core.press.press import Press
from workbench.core.result.sensing import Contact
from workbench.live.object_drawing import Drawing
from workbench.view.scene_shapes import corner_normals, first_hit, standing_pose
from workbench.view.soft_shape import deformed_mm, is_soft

OBJECT_COLOUR = (232, 124, 44)
TOUCHING_COLOUR = (255, 222, 70)
"""Of the side that touches."""
BEFORE_MM = 0.03
"""How far that side is drawn before the object's own surface: in it, the two would flicker [mm]."""
PRESSING = 0.5
"""Opacity of an object that presses: the contact shows through it from wherever one looks."""
SEEN_THROUGH = 0.35
"""Opacity of an object below which arrows end."""


class ObjectView:
    """One mesh, made once and then moved; it stands on a body."""

    def __init__(self, server: Any, body: SensorView) -> None:
        self.server = server
        self.body = body
        self.node: Any = None
        self.touching: Any = None
        """The side that touches, below the object in the scene tree: it moves with it."""
        self.allowed = True
        """Whether the designer wants to see the object at all."""
        self._present = True
        """Whether what it presses is looked at."""
        self._bare = False
        """Whether the object is hidden by itself."""
        self._seen_through = False
        self._opacity: float | None = None
        self._lowest_mm = 0.0
        self.standing = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        """Where the object stands: x, y, z [mm], qw, qx, qy, qz."""
        self._rest = np.zeros((0, 3)), np.zeros((0, 3), np.uint32)
        """Undeformed vertices [mm] and triangles."""
        self._side = self._rest
        """Those of the side that touches."""
        self._bent = False
        """Whether the object is drawn deformed."""
        self._stale = False
        """Whether the shape at rest waits for a body to stand on."""
        self._pressed: tuple[Contact, int] | None = None
        """The frame that has the object, counted from 0; None while it stands on the skin."""

    def show(self, drawing: Drawing, path: Press) -> None:
        """Show an object where the frame on show has it, else on the skin at the target."""
        self._rest = drawing.points_mm, drawing.faces
        self._side = drawing.touching
        self._bent = False
        self._lowest_mm = drawing.lowest_mm
        if self._pressed is None:
            self._stale = True
            self.place(path)
        else:
            self._draw()
            self.press(*self._pressed)

    def _draw(self) -> None:
        points, triangles = self._rest
        vertices, self._stale = points.astype(np.float32), False
        if self.node is None:
            self.node = self.server.scene.add_mesh_simple(
                "/indenter", vertices, triangles, color=OBJECT_COLOUR, flat_shading=False
            )
            self._fade()
            self.follow()
        else:
            with self.server.atomic():
                replace(self.node, vertices, triangles)
        self._draw_side()

    def _draw_side(self) -> None:
        """Draw the side that touches a little before the object's own surface."""
        points, triangles = self._side
        outward = corner_normals(points, triangles)
        vertices = (points + BEFORE_MM * outward).astype(np.float32)
        if self.touching is None and len(triangles):
            self.touching = self.server.scene.add_mesh_simple(
                "/indenter/touching", vertices, triangles, color=TOUCHING_COLOUR, side="double"
            )
            self._fade()
        elif self.touching is not None:
            with self.server.atomic():
                replace(self.touching, vertices, triangles)

    def place(self, path: Press) -> None:
        """Stand the object on the skin near the target of a press."""
        self._pressed = None
        self._fade()
        place = self.body.place_near(path.target_mm)
        if place is not None:
            if self._stale:
                self._draw()
            self._pose(standing_pose(place, self._lowest_mm))

    def press(self, contact: Contact, frame: int) -> None:
        """Put it where a frame, counted from 0, has it, in the shape that it has there."""
        self._pressed = contact, frame
        self._fade()
        self._pose(contact.indenter_pose[frame])
        if self.node is None:
            return
        if is_soft(contact) or self._bent:
            points, triangles = self._rest
            self._bent = is_soft(contact)
            shape = deformed_mm(contact, frame, points) if self._bent else points
            replace(self.node, shape.astype(np.float32), triangles)
            if self.touching is not None:
                # It is drawn as at rest, which a bent object is not.
                self.touching.visible = not self._bent

    def _pose(self, pose: np.ndarray) -> None:
        self.standing = np.asarray(pose)
        if self.node is None:
            return
        with self.server.atomic():
            self.node.position = tuple(pose[:3])
            self.node.wxyz = tuple(pose[3:])

    def await_click(self, clicked: Callable[[np.ndarray], None] | None) -> None:
        """Hand the outward normal of the face that is clicked next to somebody; None: to nobody.

        Only while somebody waits the object takes clicks: else the skin behind it does.
        """
        nodes = [node for node in (self.node, self.touching) if node is not None]
        for node in nodes:
            node.remove_click_callback("all")
            if clicked is not None:
                node.on_click(lambda event, then=clicked: self._clicked(event, then))

    def _clicked(self, event: Any, then: Callable[[np.ndarray], None]) -> None:
        points, triangles = self._rest
        turn = rotations(self.standing[3:])
        origin = (np.asarray(event.ray_origin) - self.standing[:3]) @ turn
        found = first_hit(points, triangles, origin, np.asarray(event.ray_direction) @ turn)
        if found is not None:
            a, b, c = points[triangles[found[0]].astype(int)]
            then(np.cross(b - a, c - a))

    def hide(self, wanted: bool) -> None:
        """Hide the object by itself, or show it again."""
        self._bare = wanted
        self.follow()

    def allow(self, wanted: bool) -> None:
        """Let it be seen, or hide it whatever else is shown."""
        self.allowed = wanted
        self.follow()

    def attend(self, present: bool) -> None:
        """Show it beside the sensor; where parts are looked at instead, it goes with the sensor."""
        self._present = present
        self.follow()

    def follow(self) -> None:
        """Show the object where nothing hides it."""
        if self.node is not None:
            self.node.visible = self.allowed and self._present and not self._bare

    def see_through(self, wanted: bool) -> None:
        """Let more be seen through the object: arrows end below it."""
        self._seen_through = wanted
        self._fade()

    def fade(self, opacity: float) -> None:
        """Draw the object with an opacity in [0, 1], whether it presses or not."""
        self._opacity = opacity
        self._fade()

    def _fade(self) -> None:
        own = self._opacity
        if own is None and self._pressed is not None:
            own = PRESSING
        wanted = SEEN_THROUGH if self._seen_through else own
        for node in (self.node, self.touching):
            if node is not None and node.opacity != wanted:
                node.opacity = wanted
