"""Sizes drawn beside the body: a line with arrow ends and a label; one end is an arrow to drag.

The page tells of a drag 20 times a second; only the newest counts, and it is taken up when the
desk's pump turns, as with `gizmo`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.edit.dimensions import Dimension, dragged

LINE_COLOUR = (150, 160, 175)
HELD_COLOUR = (245, 166, 35)
"""Of the arrow that is dragged."""
LINE_PX, FOOT_PX = 2.0, 1.0
ARROW_SHARE = 0.038
"""Length of an arrow over the diagonal of the body's box."""
SLIM = 0.38
"""Radius of an arrow over its length."""
SIDES = 16


@dataclass(kw_only=True, slots=True)
class _Drawn:
    """Nodes of one line, and the line."""

    line: Dimension
    strokes: Any
    feet: Any
    fixed: Any
    held: Any
    label: Any

    @property
    def nodes(self) -> tuple[Any, ...]:
        return self.strokes, self.feet, self.fixed, self.held, self.label


@dataclass(frozen=True, kw_only=True, slots=True)
class _Grip:
    """A drag: what it began with."""

    tab: int
    line: Dimension
    began_mm: float
    """Where the mouse took hold, along the line."""


class DimensionLines:
    """All lines of one scene.

    `moved` gets the line as it was when the drag began, how far its end is to go from there [mm],
    and whether it is still held.
    """

    def __init__(
        self,
        api: Any,
        moved: Callable[[Dimension, float, bool], None],
        *,
        edits: Callable[[int], bool],
    ) -> None:
        self.api, self.moved, self.edits = api, moved, edits
        self._drawn: dict[str, _Drawn] = {}
        self._grip: _Grip | None = None
        self._newest: tuple[_Grip, float, bool] | None = None

    def show(self, lines: Sequence[tuple[Dimension, str]], size_mm: float) -> None:
        """Draw lines with their labels in place of those before; none hides all.

        Args:
            lines: Each with its label.
            size_mm: Diagonal of the body's box.
        """
        wanted = {line.field for line, _ in lines}
        for field in [field for field in self._drawn if field not in wanted]:
            for node in self._drawn.pop(field).nodes:
                node.remove()
        for line, text in lines:
            self._put(line, text, ARROW_SHARE * size_mm)

    def _put(self, line: Dimension, text: str, arrow_mm: float) -> None:
        start, stop, way = np.array(line.start_mm), np.array(line.stop_mm), line.direction
        # Arrows that would meet stand outside and point inward.
        inward = float(np.linalg.norm(stop - start)) < 2.5 * arrow_mm
        tips = (
            arrow(start, way if inward else -way, arrow_mm),
            arrow(stop, -way if inward else way, arrow_mm),
        )
        strokes = np.stack([start, stop])[None]
        feet = np.array(list(zip(line.feet_mm, (start, stop), strict=False)))
        # Of a short line the label stands beyond the arrows, above them where the line is upright.
        upper = stop + 2.0 * arrow_mm * way if way[2] > 0.5 else start - 2.0 * arrow_mm * way
        place = upper if inward else (start + stop) / 2
        if line.field not in self._drawn:
            self._drawn[line.field] = self._make(line, text)
        drawn = self._drawn[line.field]
        drawn.line = line
        drawn.strokes.points = strokes.astype(np.float32)
        if len(feet):
            drawn.feet.points = feet.astype(np.float32)
        for node, (points, _) in zip((drawn.fixed, drawn.held), tips, strict=True):
            node.vertices = points
        drawn.label.position = tuple(place.tolist())
        drawn.label.text = text

    def _make(self, line: Dimension, text: str) -> _Drawn:
        api, name = self.api, f"/dimensions/{line.field.replace('.', '_')}"
        nothing = np.zeros((1, 2, 3), dtype=np.float32)
        points, faces = arrow(np.zeros(3), np.array([0.0, 0.0, 1.0]), 1.0)

        def lines(part: str, width_px: float) -> Any:
            return api.add_line_segments(
                f"{name}/{part}",
                nothing,
                colors=LINE_COLOUR,
                thickness=width_px,
                thickness_units="screen",
            )

        def tip(part: str, colour: tuple[int, int, int]) -> Any:
            return api.add_mesh_simple(
                f"{name}/{part}", points, faces, color=colour, cast_shadow=False, side="double"
            )

        held = tip("held", HELD_COLOUR)
        field = line.field

        @held.on_drag
        async def _(event: Any) -> None:
            # On the event loop, so that the places come in order; nothing is computed here.
            self._dragged(field, event)

        return _Drawn(
            line=line,
            strokes=lines("line", LINE_PX),
            feet=lines("feet", FOOT_PX),
            fixed=tip("fixed", LINE_COLOUR),
            held=held,
            label=api.add_label(
                f"{name}/label", text, font_screen_scale=0.9, anchor="center-center"
            ),
        )

    def _dragged(self, field: str, event: Any) -> None:
        eye = np.asarray(event.client.camera.position, dtype=float)
        mouse = np.asarray(event.end_position, dtype=float)
        if event.phase == "start" and field in self._drawn:
            line = self._drawn[field].line
            grasped = np.asarray(event.start_position, dtype=float)
            self._grip = _Grip(tab=event.client_id, line=line, began_mm=dragged(line, eye, grasped))
        grip = self._grip
        if grip is None or grip.tab != event.client_id or grip.line.field != field:
            return
        gone_mm = dragged(grip.line, eye, mouse) - grip.began_mm
        held = event.phase != "end"
        self._newest = grip, gone_mm, held
        if not held:
            self._grip = None

    def turn(self) -> None:
        """Hand over the newest place, if one has come; let go where the holder has gone."""
        if self._grip is not None and not self.edits(self._grip.tab):
            self._grip = None
        newest, self._newest = self._newest, None
        if newest is not None:
            grip, gone_mm, held = newest
            self.moved(grip.line, gone_mm, held)


def arrow(
    tip_mm: np.ndarray, toward: np.ndarray, length_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """A cone: vertices [mm], shape (N, 3), and triangles, shape (M, 3).

    Args:
        tip_mm: Where it ends, shape (3,).
        toward: Unit direction that it points to, shape (3,).
        length_mm: From foot to tip.
    """
    aside = np.eye(3)[int(np.argmin(np.abs(toward)))]
    one = np.cross(toward, aside)
    one /= np.linalg.norm(one)
    two = np.cross(toward, one)
    turns = 2 * np.pi * np.arange(SIDES) / SIDES
    rim = np.outer(np.cos(turns), one) + np.outer(np.sin(turns), two)
    foot = tip_mm - length_mm * toward
    points = np.vstack([foot + SLIM * length_mm * rim, tip_mm, foot])
    low = np.arange(SIDES)
    high = (low + 1) % SIDES
    tip, middle = np.full(SIDES, SIDES), np.full(SIDES, SIDES + 1)
    faces = np.vstack([np.column_stack([low, high, tip]), np.column_stack([high, low, middle])])
    return points.astype(np.float32), faces.astype(np.uint32)
