"""From a pixel of the tactile image to the skin it sees, and from a click on the skin to its pixel.

A pixel is chosen by a click on the image (`ui.patches.image_click`) or by its column and row, and
shown by a cross.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ui.desk.desk import Desk
from ui.patches.image_click import COLUMN, ROW, image_clicks
from workbench.core.result.results import MembraneMesh
from workbench.view.frame_words import number as written
from workbench.view.pixel_link import PixelLink, SkinPoint, frame_link
from workbench.view.scene_shapes import first_hit

COLOUR = (255, 45, 85)
BALL_MM = 0.6
"""Radius of the ball at the place."""
KILO = 1000.0


class Probe:
    """Widgets that join pixels and places, below the image."""

    def __init__(self, desk: Desk, clicks: Any) -> None:
        self.desk = desk
        self.clicks = clicks
        """The HTML before the images, which catches clicks on them while probing."""
        self.camera = 0
        """Number of the camera on show, from 0."""
        self.frame = 0
        """Frame on show."""
        self.uv_px: np.ndarray | None = None
        """The chosen pixel, as (column, row) of the camera [px]; None without one."""
        self.on_moved: Callable[[], None] = lambda: None
        """Set by the image's tab: draws the cross anew."""
        self._mesh: MembraneMesh | None = None
        self._plain: tuple[Any, ...] = ()
        self._big: tuple[Any, Any] = (None, None)
        """What was last looked through: camera and frame; press and mesh."""
        self._nodes: list[Any] = []
        desk.click_handlers.append(self.takes)
        desk.rested.connect(self._follow_mouse)
        gui, guarded = desk.server.gui, desk.guarded
        self.folder = gui.add_folder("Pixel and skin", expand_by_default=False, visible=False)
        with self.folder:
            hint = "A click on the image shows the place on the skin that the pixel sees; "
            hint += "a click on the skin shows its pixel, instead of aiming the press there"
            self.on = gui.add_checkbox("Probe on click", False, hint=hint)
            hint = (
                "The place on the skin follows the mouse over the image, and the pixel the mouse "
            )
            hint += "over the skin"
            self.under = gui.add_checkbox("Probe under the mouse", False, hint=hint)
            for handle in (self.on, self.under):
                handle.on_update(guarded(lambda event: self._switch()))
            hint = "Shows where on the skin this pixel looks, from the left"
            self.column = gui.add_slider(COLUMN, 0, 1, 1, 0, hint=hint)
            hint = "Shows where on the skin this pixel looks, from the top"
            self.row = gui.add_slider(ROW, 0, 1, 1, 0, hint=hint)
            clear = gui.add_button("Clear probe", hint="Take the cross and the mark away")
            self.said = gui.add_markdown("")
        for slider in (self.column, self.row):
            slider.on_update(guarded(self._chosen))
        clear.on_click(guarded(lambda event: self.clear()))

    def take_mesh(self, mesh: MembraneMesh | None) -> None:
        """The mesh that is on show; None when it is another body's."""
        self._mesh = mesh
        self.folder.visible = mesh is not None
        if mesh is None:
            self.clear()

    def _switch(self) -> None:
        self.clicks.content = image_clicks(bool(self.on.value), hover=bool(self.under.value))

    def follow(self, camera: int, frame: int) -> None:
        """Look through another camera, or at another frame, by the same pixel."""
        cameras = self.desk.session.design.optics.all_cameras
        eye = cameras[camera] if camera < len(cameras) else None
        index = self.desk.session.design.optics.refractive_index
        # Of presses and meshes, which are large, it counts whether they are the same ones.
        big = (self.desk.scene.pressed.contact, self._mesh)
        plain = (camera, frame, eye, index)
        if plain == self._plain and all(a is b for a, b in zip(big, self._big, strict=True)):
            return
        self._plain, self._big = plain, big
        self.camera, self.frame = camera, frame
        if camera < len(cameras):
            size = cameras[camera].width_px - 1, cameras[camera].height_px - 1
            for slider, most in zip((self.column, self.row), size, strict=True):
                if slider.max != most:
                    slider.value = min(int(slider.value), most)
                    slider.max = most
        if self.uv_px is not None:
            self._look()

    def _link(self) -> PixelLink | None:
        optics = self.desk.session.design.optics
        if self._mesh is None or self.camera >= len(optics.all_cameras):
            return None
        contact = self.desk.scene.pressed.contact
        return frame_link(self._mesh, optics, self.camera, contact, self.frame)

    def _chosen(self, event: Any) -> None:
        if event.client is not None:
            # A pixel's centre is half a pixel from its corner.
            self.uv_px = np.array([self.column.value, self.row.value], dtype=float) + 0.5
            self._look()
            self.on_moved()

    def _look(self) -> None:
        """Show where the chosen pixel looks in the frame on show."""
        link = self._link()
        if link is None or self.uv_px is None:
            return
        point = link.skin_at(self.uv_px)
        if point is None:
            self._unmark()
            self.said.content = "This pixel sees no skin."
        else:
            self._tell(link, point)

    def takes(self, origin: np.ndarray, direction: np.ndarray) -> bool:
        """Take a click while probing."""
        return bool(self.on.value) and self._shows_at(origin, direction)

    def _follow_mouse(self, origin: np.ndarray, direction: np.ndarray) -> None:
        if self.under.value:
            self._shows_at(origin, direction)

    def _shows_at(self, origin: np.ndarray, direction: np.ndarray) -> bool:
        """Show the pixel of the place where a ray meets the skin; whether there is a skin to ask.

        Args:
            origin: Start of the ray [mm], shape (3,).
            direction: Unit direction, shape (3,).
        """
        scene, link = self.desk.scene, self._link()
        if link is None or scene.hidden:
            return False
        surface = scene.pressed.surface()
        if surface is not None:
            hit = first_hit(*surface, origin, direction)
        else:
            hit = scene.body.hit(origin, direction)
        if hit is not None:
            self._show_pixel(link, hit[1])
        return True

    def _show_pixel(self, link: PixelLink, place_mm: np.ndarray) -> None:
        point = link.nearest(place_mm)
        found = link.pixel_of(point.place_mm)
        if found.why:
            self.uv_px = None
            self._mark(point.place_mm)
            self.said.content = f"{_place(point.place_mm)}: not in the image, {found.why}."
        else:
            self.uv_px = found.uv_px
            column, row = (int(c) for c in np.floor(found.uv_px))
            self.column.value = min(column, int(self.column.max))
            self.row.value = min(row, int(self.row.max))
            self._tell(link, point)
        self.on_moved()

    def _tell(self, link: PixelLink, point: SkinPoint) -> None:
        """Mark a place that a pixel sees, and tell of both."""
        assert self.uv_px is not None
        self._mark(point.place_mm)
        column, row = np.floor(self.uv_px).astype(int)
        along, across = link.mm_per_px(self.uv_px)
        rest = np.asarray(link.skin.points_mm)
        moved_mm = float(np.linalg.norm(point.value(link.skin, link.points_mm - rest)))
        lines = (
            f"**pixel {column}, {row}** sees {_place(point.place_mm)}",
            f"{written(along)} × {written(across)} mm per pixel there",
            f"displaced {written(moved_mm)} mm, pressure {self._pressure(link, point)}",
        )
        self.said.content = "  \n".join(lines)

    def _pressure(self, link: PixelLink, point: SkinPoint) -> str:
        contact = self.desk.scene.pressed.contact
        if contact is None or not 0 < self.frame <= len(contact.pressure_MPa):
            return "none" if not self.frame else written(float("nan"))
        values = contact.pressure_MPa[self.frame - 1]
        if len(values) != len(link.skin.points_mm):
            # The camera sees the inner skin, and pressure is that of the outer one.
            return written(float("nan"))
        return f"{written(KILO * float(point.value(link.skin, values)))} kPa"

    def _mark(self, place_mm: np.ndarray) -> None:
        self._unmark()
        api = self.desk.server.scene
        self._nodes = [
            api.add_icosphere("/probe/point", BALL_MM, color=COLOUR, position=place_mm),
            api.add_label("/probe/text", "pixel", position=place_mm, anchor="bottom-left"),
        ]

    def _unmark(self) -> None:
        for node in self._nodes:
            node.remove()
        self._nodes.clear()

    def clear(self) -> None:
        """Take cross and mark away."""
        self.uv_px = None
        # Else a click on the same pixel would change nothing, and show nothing.
        self.column.value = self.row.value = 0
        self._unmark()
        self.said.content = ""
        self.on_moved()


def _place(place_mm: np.ndarray) -> str:
    x, y, z = (f"{float(c):.2f}" for c in place_mm)
    return f"{x}, {y}, {z} mm"
