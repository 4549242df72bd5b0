"""What a photograph says: figures, pictures, colours on the skin, and a profile along a line."""

from __future__ import annotations

from typing import Any

import numpy as np
from viser import uplot

from ui.desk.desk import Desk
from ui.page.colours import BLUE
from ui.page.imaging import placeholder, scale_bar, swatch
from ui.patches.image_line import image_lines
from workbench.photographs.pictures import sized
from workbench.reading.shown_reading import Look, ShownReading
from workbench.view.colour_scale import NOTHING_GREY, YES
from workbench.view.frame_words import number

START = ("From column px", "From row px")
STOP = ("To column px", "To row px")
LINE = (255, 220, 0)
WAY = "reading"
"""What covers the press in the 3D view."""


class ReadOutcome:
    """Widgets of the folder."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.found: ShownReading | None = None
        gui, guarded = desk.server.gui, desk.guarded
        self.folder = gui.add_folder("What it says", visible=False)
        with self.folder:
            self.said = gui.add_markdown("")
            hint = "In the picture below and on the skin, where the photo itself stands for depth"
            self.look = gui.add_dropdown(
                "Look at reading", tuple(Look), initial_value=Look.DEPTH, hint=hint
            )
            hint = "The skin moved as read, in the colours of the picture; the press gives way"
            self.wanted = gui.add_checkbox("Show reading on the skin", True, hint=hint)
            for handle in (self.look, self.wanted):
                handle.on_update(guarded(lambda event: self.draw()))
            gui.add_html(image_lines(start=START, stop=STOP))
            self.image = gui.add_image(placeholder(), format="jpeg")
            self.legend = gui.add_html("")
            self.profile = gui.add_uplot(
                (np.zeros(2), np.zeros(2)),
                (uplot.Series(label="way mm"), uplot.Series(label="depth mm", stroke=BLUE)),
                scales={"x": uplot.Scale(time=False)},
                title="Depth [mm] along the line [mm]",
                aspect=1.8,
            )
            hint = "An end of the line of the profile: draw it on the picture by the mouse"
            self.ends = tuple(
                gui.add_slider(label, 0, 1, 1, 0, hint=hint) for label in (*START, *STOP)
            )
        for slider in self.ends:
            slider.on_update(guarded(self._drawn))

    def take(self, found: ShownReading) -> None:
        """Show a reading."""
        rows, columns = found.image.shape[:2]
        if self.found is None or self.found.image.shape != found.image.shape:
            self._lay_line(rows, columns)
        self.found = found
        self.folder.visible = True
        self.said.content = words(found)
        self.draw()

    def _lay_line(self, rows: int, columns: int) -> None:
        """A line across the middle of the image."""
        places = (0, rows // 2, columns - 1, rows // 2)
        for slider, most, place in zip(self.ends, (columns - 1, rows - 1) * 2, places, strict=True):
            slider.value = 0
            slider.max = most
            slider.value = place

    def _drawn(self, event: Any) -> None:
        if event.client is not None:
            self._draw_picture()

    def draw(self) -> None:
        """Show what is chosen, in the picture and on the skin."""
        if self.found is None:
            return
        self._draw_picture()
        shown = bool(self.wanted.value)
        if shown:
            self.desk.tell("mapped", WAY)
            self.desk.scene.show_map(
                self.found.skin, self.found.skin_colours(Look(self.look.value))
            )
        else:
            self.desk.scene.clear_map()
        self.desk.cover(WAY, shown)

    def _draw_picture(self) -> None:
        if self.found is None:
            return
        look = Look(self.look.value)
        values = [int(slider.value) for slider in self.ends]
        start, stop = (values[0], values[1]), (values[2], values[3])
        picture, scale = sized(self.found.picture(look))
        way, depth = self.found.profile(start, stop)
        with self.desk.server.atomic():
            self.image.image = _lined(picture, scale, start, stop)
            self.legend.content = legend_of(self.found, look)
            if len(way) > 1:
                self.profile.data = (way.astype(np.float64), depth.astype(np.float64))

    def hide(self) -> None:
        """Give the 3D view back."""
        if self.wanted.value and self.found is not None:
            self.wanted.value = False
            self.desk.cover(WAY, False)


def _lined(
    picture: np.ndarray, scale: float, start: tuple[int, int], stop: tuple[int, int]
) -> np.ndarray:
    """A picture with the line of the profile."""
    import cv2

    ends = [tuple(round((v + 0.5) * scale - 0.5) for v in end) for end in (start, stop)]
    for colour, width in (((0, 0, 0), 3), (LINE, 1)):
        cv2.line(picture, ends[0], ends[1], colour, width, cv2.LINE_AA)
    return picture


def legend_of(found: ShownReading, look: Look) -> str:
    """What the colours mean, as HTML."""
    if look is Look.CONTACT:
        return swatch(YES, "surely pressed in") + swatch(NOTHING_GREY, "not")
    scale = found.scale(look)
    if scale is None:
        return ""
    unknown = swatch(NOTHING_GREY, "no skin, or moved skin out of sight")
    return scale_bar(0.0, scale.high, scale.unit) + unknown


def words(found: ShownReading) -> str:
    """The figures of a reading, for people."""
    figures = found.figures
    size_N = float(np.linalg.norm([np.nan if v is None else v for v in figures["force_N"]]))
    lines = [
        f"**{number(figures['peak_depth_mm'], '.2f')} mm** deep",
        f"contact {number(figures['contact_area_mm2'], '.1f')} mm²",
    ]
    if np.isfinite(size_N):
        told_N = number(figures["force_sigma_N"], ".2f")
        lines.append(f"force **{number(size_N, '.2f')} ± {told_N} N**")
    else:
        lines.append("no force is told of a wall on gel or air, or with pins")
    radius_mm = figures["ball_radius_mm"]
    if radius_mm is not None:
        lines.append(f"ball of radius {number(radius_mm, '.2f')} mm")
    fit = f"what the light leaves unexplained is {number(figures['misfit'], '.1f')} × the noise"
    lines.append(fit)
    return f"{found.name}: " + ", ".join(lines) + "."
