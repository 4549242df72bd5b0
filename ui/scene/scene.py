"""The 3D view of one design: its body, light and camera, the press, the parts, and the eye."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ui.page.background_thread import BackgroundThread
from ui.scene.contact_shadow import ContactShadow
from ui.scene.map_view import MapView
from ui.scene.mesh_marks import MeshMarks
from ui.scene.object_view import ObjectView
from ui.scene.parts import PartsView
from ui.scene.pressed import PressedView
from ui.scene.rig import RigView
from ui.scene.section import Section
from ui.scene.sensor import SensorView
from ui.scene.views import AWAY, Views
from workbench.core.result.results import Skin, Solid
from workbench.core.result.sensing import Contact

GRID_FADE_MM = 220.0
"""Distance from the eye at which the floor is lost; most bodies are nearer than 150 mm."""
GRID_COLOUR = (128, 130, 138)
"""Of lines that are seen on a dark and on a light page, and on neither first."""
ROOM, ROOM_SHARE = "studio", 0.35
"""What surfaces reflect, and how bright it is."""
SUN, SUN_SHARE = (60.0, -30.0, 110.0), 1.3
"""Where the light comes from [mm], upper left of where bodies are usually seen from, and how bright
it is: viser's own light, from straight above and of 3, bleaches a white skin."""
SHADOW_BELOW_MM, GRID_BELOW_MM = 0.1, 0.2
"""How far shadow and floor grid lie below the foot: nearer, they flicker [mm]."""


class Scene:
    """The 3D view of one design. One node per kind; nodes are updated, not made anew."""

    def __init__(
        self,
        server: Any,
        *,
        fast: bool,
        on_click: Callable[[Any], None],
        background: BackgroundThread,
    ) -> None:
        self.server = server
        self.on_click = on_click
        self.api = server.scene
        self.body = SensorView(self.api, on_click)
        self.rig = RigView(server)
        self.parts = PartsView(server)
        self.views = Views(server)
        self.object = ObjectView(server, self.body)
        self.marks = MeshMarks(self.api, self.views)
        self.pressed = PressedView(self.api, on_click, background)
        self.pressed.on_painted = self._painted
        self.on_painted: Callable[[], None] = lambda: None
        """Set by the timeline: called once the colours of a press are there."""
        self.map = MapView(self.api, on_click)
        self.section = Section(self)
        self.parts.on_moved = self._parts_moved
        self.on_extent: Callable[[], None] = lambda: None
        """Set by the view's panel: called once what is on show reaches elsewhere."""
        self.hidden = False
        """Whether parts are looked at in place of the sensor."""
        self.inside: set[str] = set()
        """Names of the handles inside the skin that are on."""
        self.shown_frame = 0
        self.grid: Any = None
        self.shadow = ContactShadow(self.api)
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
        else:
            self.api.configure_environment_map(ROOM, environment_intensity=ROOM_SHARE)
            self.api.configure_default_lights(False)
            self.api.add_light_directional(
                "/sun", intensity=SUN_SHARE, cast_shadow=True, position=SUN
            )
        self.grid = self.api.add_grid(
            "/grid",
            width=160,
            height=160,
            cell_size=5,
            section_size=20,
            cell_color=GRID_COLOUR,
            section_color=GRID_COLOUR,
            cell_thickness=0.5,
            section_thickness=0.8,
            fade_distance=GRID_FADE_MM,
            shadow_opacity=0.2,
            position=(0, 0, -8.2),
        )

    def show_solid(self, solid: Solid) -> None:
        """Show a body; the press and the parts of another body disappear."""
        with self.server.atomic():
            self.clear_frames()
            self.marks.clear_cell()
            self.marks.show_edges(None)
            self.map.clear()
            self.parts.clear()
            self.section.take_mesh(None)
            self.body.show_solid(solid)
            self.section.follow()
            low, _ = self.body.bounds_mm
            self.grid.position = (0.0, 0.0, float(low[2]) - GRID_BELOW_MM)
            self.shadow.follow(solid.base.points_mm, float(low[2]) - SHADOW_BELOW_MM)
            self.follow_shadow()

    def follow_shadow(self) -> None:
        """Throw the shadow of a foot that is on show and whole."""
        self.shadow.show(not self.hidden and self.section.plane is None)

    def frame_body(self, target_mm: tuple[float, float, float]) -> None:
        """Look at the whole body from where a press at the target is seen beside its object."""
        self.views.frame(*self.body.bounds_mm, self.body.side_of(target_mm, AWAY))

    def fit_view(self) -> None:
        """Look at all that is on show."""
        self.views.fit(*self.bounds_mm)

    @property
    def bounds_mm(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of what is on show: the parts, else the body [mm]."""
        shown = self.hidden and self.parts.shown
        return self.parts.bounds_mm() if shown else self.body.bounds_mm

    def _parts_moved(self) -> None:
        self.section.follow()
        self.on_extent()

    def load_frames(self, skin: Skin, contact: Contact) -> None:
        """Take a press; its skin shows once its colours are there."""
        self.clear_frames()
        self.pressed.load(skin, contact)

    def _painted(self) -> None:
        """The colours of a press are there."""
        if self.hidden or self.inside:
            self.pressed.show(0)
        self._show_skin(not self.hidden and not self.pressed.drawn)
        self.on_painted()

    def _follow_marks(self) -> None:
        self.marks.follow(not self.hidden and self.shown_frame == 0)

    def show_live(self, skin: Skin, contact: Contact) -> None:
        """Show the one frame of a live press."""
        self.shown_frame = 1
        if self.hidden or self.inside:
            return
        with self.server.atomic():
            self.pressed.load_live(skin, contact)
            self.body.show_skin(False)
            self.object.press(contact, 0)
            self.section.follow()

    def clear_frames(self) -> None:
        """Forget the frames of a press."""
        self.pressed.clear()
        self.shown_frame = 0
        self._follow_marks()
        if not self.hidden:
            self._show_skin(True)
        self.section.follow()

    def _show_skin(self, wanted: bool) -> None:
        """Show the plain skin at rest, unless a map takes its place."""
        self.body.show_skin(wanted and (not self.map.on or bool(self.inside)))

    def show_map(self, skin: Skin, colours: np.ndarray) -> None:
        """Show the skin at rest in the colours of a map, shape (V, 3), uint8."""
        with self.server.atomic():
            self.map.load(skin, colours)
            self.map.show(not self.hidden and not self.inside)
            self._show_skin(bool(self.inside))
            self.show_frame(0)

    def clear_map(self) -> None:
        """Show the plain skin at rest again."""
        if self.map.on:
            self.map.clear()
            if not self.hidden:
                self._show_skin(not self.pressed.drawn)

    def show_frame(self, number: int) -> None:
        """Show frame `number` of the press, 0 for the untouched skin, which alone has maps."""
        contact = self.pressed.contact
        if contact is None:
            return
        number = 0 if self.map.on else min(number, self.pressed.count)
        self.shown_frame = number
        self._follow_marks()
        if self.hidden:
            return
        with self.server.atomic():
            self.pressed.show(0 if self.inside else number)
            self._show_skin(not self.pressed.drawn)
            self.object.press(contact, max(number, 1) - 1)
            self.section.follow()

    def look_inside(self, whose: str, wanted: bool) -> None:
        """Look through the skin at rest while a handle inside is on, which it would cover.

        viser gives the mouse to the nearest thing that takes clicks, whatever is drawn over it:
        the skin takes none meanwhile.
        """
        if wanted == (whose in self.inside):
            return
        (self.inside.add if wanted else self.inside.discard)(whose)
        glass = bool(self.inside)
        with self.server.atomic():
            for meshes in (self.body.skin, self.body.support):
                meshes.look_through(glass)
            self.rig.leds.show_letters(glass)
            self.body.skin.take_clicks(None if glass else self.on_click)
            self.map.show(self.map.on and not self.hidden and not glass)
            if self.pressed.contact is None:
                self._show_skin(not self.hidden)
            else:
                self.show_frame(self.shown_frame)

    def resting_nodes(self) -> list[str]:
        """Names of what a pressed frame takes the place of."""
        return [node.name for node in self.body.skin.nodes.values()]

    def show_sensor(self, visible: bool) -> None:
        """Show or hide everything but the parts."""
        self.hidden = not visible
        self._follow_marks()
        with self.server.atomic():
            self.body.show(visible)
            self.map.show(visible)
            self.rig.show(visible)
            # The core of an exploded mould hangs below the floor, whose lines would cross it.
            self.grid.visible = visible
            self.follow_shadow()
            self.object.attend(visible)
            self.pressed.show(0)
        if visible:
            self._show_skin(self.shown_frame == 0)
            self.show_frame(self.shown_frame)
        self.section.follow()
