"""Measuring between two clicked points, on whatever is on show: whole, cut, pressed or parts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ui.scene.nodes import Meshes
from ui.scene.scene import Scene
from workbench.view.scene_shapes import first_hit
from workbench.view.section_cut import clip

COLOUR = (255, 45, 85)
BALL_MM = 0.35
"""Radius of the ball at an end."""
LIFT_MM = 1.0
"""How far the label stands above the middle of the line."""
ASK = "Click the first point."
ASK_NEXT = "Click the second point."


class Measure:
    """Two points, the line between them and its length."""

    def __init__(self, scene: Scene, click: Callable[[Any], None]) -> None:
        self.scene = scene
        self.click = click
        """What the scene's own meshes are clicked with."""
        self.on = False
        self.on_message: Callable[[str], None] = lambda text: None
        """Set by the panel: shows what was measured, or what to do."""
        self._ends: list[np.ndarray] = []
        self._nodes: list[Any] = []

    @property
    def _groups(self) -> tuple[Meshes, ...]:
        scene = self.scene
        return (*scene.body.groups, scene.parts.meshes, scene.section.caps)

    def switch(self, on: bool) -> None:
        """Begin with two new points, or end; the skin takes clicks in any case."""
        self.on = on
        self._clear()
        for meshes in self._groups[1:]:
            meshes.take_clicks(self.click if on else None)
        self.on_message(ASK if on else "")

    def takes(self, origin: np.ndarray, direction: np.ndarray) -> bool:
        """Take a click while measuring, whether or not it meets anything."""
        if not self.on:
            return False
        place = self.place(origin, direction)
        if place is not None:
            if len(self._ends) == 2:
                self._clear()
            self._ends.append(place)
            self._draw()
        return True

    def place(self, origin: np.ndarray, direction: np.ndarray) -> np.ndarray | None:
        """Where a ray first meets what is on show [mm]."""
        met = [
            hit[1]
            for points, faces in self._surfaces()
            if (hit := first_hit(points, faces, origin, direction, both_sides=True)) is not None
        ]
        return min(met, key=lambda place: float((place - origin) @ direction), default=None)

    def _surfaces(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Vertices [mm] and triangles of everything on show, as it is cut."""
        for meshes in self._groups:
            for node in meshes.nodes.values():
                if node.visible:
                    yield node.vertices + np.asarray(node.position), node.faces
        pressed, plane = self.scene.pressed.surface(), self.scene.section.plane
        if pressed is not None and not self.scene.hidden:
            if plane is not None:
                kept = clip(*pressed, plane)
                pressed = kept.points_mm, kept.faces
            yield pressed

    def _draw(self) -> None:
        api, end, number = self.scene.api, self._ends[-1], len(self._ends)
        self._nodes.append(
            api.add_icosphere(f"/measure/end_{number}", BALL_MM, color=COLOUR, position=end)
        )
        if number < 2:
            self.on_message(ASK_NEXT)
            return
        line = np.stack(self._ends).astype(np.float32)[None]
        middle = np.mean(self._ends, axis=0) + np.array([0.0, 0.0, LIFT_MM])
        text = measured(*self._ends)
        self._nodes += [
            api.add_line_segments("/measure/line", line, colors=COLOUR, line_width=3.0),
            api.add_label("/measure/text", text, position=middle, anchor="bottom-center"),
        ]
        self.on_message(f"**{text}**")

    def _clear(self) -> None:
        for node in self._nodes:
            node.remove()
        self._nodes.clear()
        self._ends.clear()


def measured(start_mm: np.ndarray, stop_mm: np.ndarray) -> str:
    """A distance and its three shares in words."""
    way = np.asarray(stop_mm) - np.asarray(start_mm)
    x, y, z = (f"{float(c) + 0.0:.2f}" for c in np.round(way, 2))
    return f"{float(np.linalg.norm(way)):.2f} mm (dx {x}, dy {y}, dz {z} mm)"
