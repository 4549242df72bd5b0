"""The 3D view of one design: its body, light and camera, the press, the parts, and the eye."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ui.map_view import MapView
from ui.nodes import replace
from ui.parts import PartsView
from ui.pressed import PressedView
from ui.rig import RigView
from ui.section import Section
from ui.sensor import SensorView
from ui.views import Views
from workbench.core.indenter import Indenter
from workbench.core.press import Press
from workbench.core.results import Skin, Solid
from workbench.core.sensing import Contact
from workbench.previews import cell_edges, indenter_shape, standing_pose
from workbench.soft_shape import deformed_mm, is_soft

INDENTER_COLOUR = (232, 124, 44)
SEEN_THROUGH = 0.35
"""Opacity of an object that is seen through."""
CELL_COLOUR = (255, 45, 85)
EDGE_COLOUR = (20, 60, 120)
GRID_FADE_MM = 220.0
"""Distance from the eye at which the floor is lost; most bodies are nearer than 150 mm."""
GRID_BELOW_MM = 0.1
"""How far the floor grid lies below the foot: nearer, the two flicker [mm]."""


class Scene:
    """The 3D view of one design. One node per kind; nodes are updated, not made anew."""

    def __init__(self, server: Any, *, fast: bool, on_click: Callable[[Any], None]) -> None:
        self.server = server
        self.on_click = on_click
        self.api = server.scene
        self.body = SensorView(self.api, on_click)
        self.rig = RigView(server)
        self.parts = PartsView(server)
        self.views = Views(server)
        self.pressed = PressedView(self.api, on_click)
        self.map = MapView(self.api, on_click)
        self.section = Section(self)
        self.parts.on_moved = self.section.follow
        self.hidden = False
        """Whether parts are looked at in place of the sensor."""
        self._bare = False
        """Whether the object is hidden by itself."""
        self._seen_through = False
        self._object_opacity: float | None = None
        self.object_allowed = True
        """Whether the designer wants to see the object at all."""
        self.shown_frame = 0
        self._lowest_mm = 0.0
        self.standing = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        """Where the object stands: x, y, z [mm], qw, qx, qy, qz."""
        self._cell: Any = None
        self._edges: Any = None
        self.indenter: Any = None
        self._object = np.zeros((0, 3)), np.zeros((0, 3), np.uint32)
        """Undeformed vertices [mm] and triangles of the object."""
        self._bent = False
        """Whether the object is drawn deformed."""
        self.grid: Any = None
        self._prepare(fast)

    def _prepare(self, fast: bool) -> None:
        self.views.frame(np.array([-18.0, -18.0, -8.0]), np.array([18.0, 18.0, 42.0]))
        if fast:
            # Without the environment map only direct light is left: fill the shadows.
            self.api.configure_environment_map(None)
            self.api.configure_default_lights(True, cast_shadow=False)
            self.api.add_light_hemisphere(
                "/fill", sky_color=(255, 255, 255), ground_color=(120, 120, 130), intensity=2.0
            )
        self.grid = self.api.add_grid(
            "/grid",
            width=160,
            height=160,
            cell_size=5,
            section_size=20,
            fade_distance=GRID_FADE_MM,
            position=(0, 0, -8.1),
        )

    def show_solid(self, solid: Solid) -> None:
        """Show a body; the press and the parts of another body disappear."""
        with self.server.atomic():
            self.clear_frames()
            self.clear_cell()
            self.show_edges(None)
            self.map.clear()
            self.parts.clear()
            self.section.take_mesh(None)
            self.body.show_solid(solid)
            self.section.follow()
            low, _ = self.body.bounds_mm
            self.grid.position = (0.0, 0.0, float(low[2]) - GRID_BELOW_MM)

    def frame_body(self) -> None:
        """Look at the whole body."""
        self.views.frame(*self.body.bounds_mm)

    def fit_view(self) -> None:
        """Look at all that is on show."""
        self.views.fit(*self.bounds_mm)

    @property
    def bounds_mm(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of what is on show: the parts, else the body [mm]."""
        shown = self.hidden and self.parts.shown
        return self.parts.bounds_mm() if shown else self.body.bounds_mm

    def show_edges(self, ends_mm: np.ndarray | None) -> None:
        """Draw the edges of a mesh, shape (E, 2, 3), on the body at rest; None takes them away."""
        if self._edges is not None:
            self._edges.remove()
            self._edges = None
        if ends_mm is not None:
            self._edges = self.api.add_line_segments(
                "/edges",
                np.asarray(ends_mm, dtype=np.float32),
                colors=EDGE_COLOUR,
                thickness=1.0,
                thickness_units="screen",
            )
            self._follow_edges()

    def _follow_edges(self) -> None:
        """The mesh is that of the body at rest."""
        if self._edges is not None:
            self._edges.visible = not self.hidden and self.shown_frame == 0

    def show_indenter(self, indenter: Indenter, path: Press) -> None:
        """Show the indenter standing on the skin at the target."""
        points, faces = indenter_shape(indenter)
        self._object = points, faces.astype(np.uint32)
        self._bent = False
        self._lowest_mm = -float(points[:, 2].min())
        vertices, triangles = points.astype(np.float32), faces.astype(np.uint32)
        if self.indenter is None:
            self.indenter = self.api.add_mesh_simple(
                "/indenter", vertices, triangles, color=INDENTER_COLOUR, flat_shading=False
            )
            self.see_through(self._seen_through)
            self.follow_object()
        else:
            with self.server.atomic():
                replace(self.indenter, vertices, triangles)
        self.place_indenter(path)

    def place_indenter(self, path: Press) -> None:
        """Stand the indenter on the skin near the target of a press."""
        body = self.body
        if self.indenter is not None and len(body.points):
            self._pose(standing_pose(body.points, body.normals, path.target_mm, self._lowest_mm))

    def hide_indenter(self, wanted: bool) -> None:
        """Hide the object, or show it again."""
        self._bare = wanted
        self.follow_object()

    def follow_object(self) -> None:
        """Show the object where nothing hides it."""
        if self.indenter is not None:
            self.indenter.visible = self.object_allowed and not (self._bare or self.hidden)

    def see_through(self, wanted: bool) -> None:
        """Let the object be seen through, so that what happens below it shows."""
        self._seen_through = wanted
        if self.indenter is not None:
            self.indenter.opacity = SEEN_THROUGH if wanted else self._object_opacity

    def fade_object(self, opacity: float) -> None:
        """Draw the object with an opacity in [0, 1]."""
        self._object_opacity = opacity
        self.see_through(self._seen_through)

    def _pose_object(self, contact: Contact, frame: int) -> None:
        """Put the object where a frame of a press has it, in the shape that it has there."""
        self._pose(contact.indenter_pose[frame])
        if is_soft(contact) or self._bent:
            points, triangles = self._object
            self._bent = is_soft(contact)
            shape = deformed_mm(contact, frame, points) if self._bent else points
            replace(self.indenter, shape.astype(np.float32), triangles)

    def _pose(self, pose: np.ndarray) -> None:
        self.standing = np.asarray(pose)
        with self.server.atomic():
            self.indenter.position = tuple(pose[:3])
            self.indenter.wxyz = tuple(pose[3:])

    def load_frames(self, skin: Skin, contact: Contact) -> None:
        """Prepare the coloured skin of every frame."""
        self.clear_frames()
        self.pressed.load(skin, contact)

    def show_live(self, skin: Skin, contact: Contact) -> None:
        """Show the one frame of a live press."""
        self.shown_frame = 1
        if self.hidden:
            return
        with self.server.atomic():
            self.pressed.load_live(skin, contact)
            self.body.show_skin(False)
            self._pose_object(contact, 0)
            self.section.follow()

    def clear_frames(self) -> None:
        """Forget the frames of a press."""
        self.pressed.clear()
        self.shown_frame = 0
        self._follow_edges()
        if not self.hidden:
            self._show_skin(True)
        self.section.follow()

    def _show_skin(self, wanted: bool) -> None:
        """Show the plain skin at rest, unless a map takes its place."""
        self.body.show_skin(wanted and not self.map.on)

    def show_map(self, skin: Skin, colours: np.ndarray) -> None:
        """Show the skin at rest in the colours of a map, shape (V, 3), uint8."""
        with self.server.atomic():
            self.map.load(skin, colours)
            self.map.show(not self.hidden)
            self._show_skin(False)
            self.show_frame(0)

    def clear_map(self) -> None:
        """Show the plain skin at rest again."""
        if self.map.on:
            self.map.clear()
            if not self.hidden:
                self._show_skin(self.shown_frame == 0)

    def show_frame(self, number: int) -> None:
        """Show frame `number` of the press, 0 for the untouched skin, which alone has maps."""
        contact = self.pressed.contact
        if contact is None:
            return
        number = 0 if self.map.on else min(number, self.pressed.count)
        self.shown_frame = number
        self._follow_edges()
        if self.hidden:
            return
        with self.server.atomic():
            self.pressed.show(number)
            self._show_skin(number == 0)
            if self.indenter is not None:
                self._pose_object(contact, max(number, 1) - 1)
            self.section.follow()

    def resting_nodes(self) -> list[str]:
        """Names of what a pressed frame takes the place of."""
        return [node.name for node in self.body.skin.nodes.values()]

    def show_cell(self, corners_mm: np.ndarray) -> None:
        """Draw the edges of one cell of a mesh: triangle, tetrahedron or hexahedron."""
        self.clear_cell()
        self._cell = self.api.add_line_segments(
            "/cell",
            cell_edges(corners_mm).astype(np.float32),
            colors=CELL_COLOUR,
            line_width=3.0,
        )

    @property
    def marked(self) -> bool:
        """Whether a cell is drawn."""
        return self._cell is not None

    def clear_cell(self) -> None:
        """Take the cell and its mark away."""
        self.views.unmark()
        if self._cell is not None:
            self._cell.remove()
            self._cell = None

    def show_sensor(self, visible: bool) -> None:
        """Show or hide everything but the parts."""
        self.hidden = not visible
        self._follow_edges()
        with self.server.atomic():
            self.body.show(visible)
            self.map.show(visible)
            self.rig.show(visible)
            # The core of an exploded mould hangs below the floor, whose lines would cross it.
            self.grid.visible = visible
            self.follow_object()
            self.pressed.show(0)
        if visible:
            self._show_skin(self.shown_frame == 0)
            self.show_frame(self.shown_frame)
        self.section.follow()
