"""Lamps in the 3D view: balls, lines and rectangles in their colour, with the way they shine."""

from __future__ import annotations

from typing import Any

import numpy as np

from workbench.core.design.lighting import Lamp, LampKind
from workbench.edit.led_colours import shown_colour
from workbench.edit.light_edit import lamp_corners_mm, lamp_frame

BALL_MM = 0.7
LINE_PX = 5.0
AXIS_MM = 2.5
"""Length of the line that shows where a lamp shines."""
QUAD = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)


class LampsView:
    """Nodes of the lamps of one design; made anew when one of them changes."""

    def __init__(self, api: Any) -> None:
        self.api = api
        self.nodes: list[Any] = []
        self._shown: tuple[Lamp, ...] = ()

    def show_lamps(self, lamps: tuple[Lamp, ...]) -> None:
        """Show these lamps in place of those before."""
        if lamps == self._shown:
            return
        self._shown = lamps
        for node in self.nodes:
            node.remove()
        self.nodes = [
            node for number, lamp in enumerate(lamps, 1) for node in self._drawn(number, lamp)
        ]

    def _drawn(self, number: int, lamp: Lamp) -> list[Any]:
        colour, name = shown_colour(lamp.colour), f"/lamps/{number}"
        centre = np.asarray(lamp.position_mm, dtype=np.float32)
        toward = centre + AXIS_MM * lamp_frame(lamp)[0].astype(np.float32)
        axis = self._line(f"/lamp_axes/{number}", np.stack([centre, toward]), colour, width_px=1.5)
        if lamp.kind is LampKind.POINT:
            body = self.api.add_icosphere(
                name, radius=BALL_MM, color=colour, position=lamp.position_mm, subdivisions=2
            )
            return [axis, body]
        corners = lamp_corners_mm(lamp).astype(np.float32)
        if lamp.kind is LampKind.LINE:
            return [axis, self._line(name, corners, colour, width_px=LINE_PX)]
        body = self.api.add_mesh_simple(
            name, corners, QUAD, color=colour, side="double", cast_shadow=False
        )
        return [axis, body]

    def _line(
        self, name: str, ends: np.ndarray, colour: tuple[int, int, int], *, width_px: float
    ) -> Any:
        return self.api.add_line_segments(
            name, ends[None], colors=colour, thickness=width_px, thickness_units="screen"
        )

    def show(self, visible: bool) -> None:
        """Show or hide all of them."""
        for node in self.nodes:
            node.visible = visible
