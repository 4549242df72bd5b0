"""Handles by which things are dragged in the 3D view: the object, a camera, the LED ring, a lamp.

The page sends a pose many times a second; only the newest counts, and it is taken up when the
desk's pump turns. While the designer holds the handle it stays under the mouse; once let go it
stands at its thing again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

SCALE_MM = 9.0
"""Length of the arms."""
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class Arms:
    """What a handle is held by."""

    name: str = "/drag"
    """Of its node in the scene."""
    length_mm: float = SCALE_MM
    turns: bool = False
    """Whether it can be turned too."""
    axes: tuple[bool, bool, bool] = (True, True, True)
    """Along which of X, Y and Z it can be dragged."""


ARMS = Arms()


class Gizmo:
    """One handle; `moved` is told where it was dragged and how it was turned.

    `moved` gets the position [mm], shape (3,), and the unit quaternion w, x, y, z, shape (4,).
    """

    def __init__(
        self,
        api: Any,
        moved: Callable[[np.ndarray, np.ndarray], None],
        *,
        edits: Callable[[int], bool],
        arms: Arms = ARMS,
    ) -> None:
        self.moved = moved
        self.edits = edits
        """Whether what a tab sends is taken; the end of a drag may never come of one that left."""
        self._newest: tuple[np.ndarray, np.ndarray] | None = None
        self._holder: int | None = None
        """Number of the tab that drags."""
        self.handle = api.add_transform_controls(
            arms.name,
            scale=arms.length_mm,
            line_width=4.0,
            active_axes=arms.axes,
            disable_sliders=not all(arms.axes),
            disable_rotations=not arms.turns,
            depth_test=False,
            visible=False,
        )

        @self.handle.on_update
        async def _(event: Any) -> None:
            # On the event loop, so that the poses come in order; nothing is computed here.
            self._holder = None if event.phase == "end" else event.client_id
            self._newest = (
                np.array(self.handle.position, dtype=float),
                np.array(self.handle.wxyz, dtype=float),
            )

    def turn(self) -> None:
        """Hand over the newest pose, if one has come; let go where the holder has gone."""
        if not self.held:
            self._holder = None
        newest, self._newest = self._newest, None
        if newest is not None:
            self.moved(*newest)

    @property
    def held(self) -> bool:
        """Whether a tab that edits drags it."""
        holder = self._holder
        return holder is not None and self.edits(holder)

    def place(self, position: np.ndarray, wxyz: np.ndarray | None = None) -> None:
        """Stand at a place, unless the designer holds it."""
        if self.held:
            return
        if not np.allclose(self.handle.position, position, atol=1e-4):
            self.handle.position = tuple(float(x) for x in position)
        turned = UPRIGHT if wxyz is None else tuple(float(x) for x in wxyz)
        if not np.allclose(self.handle.wxyz, turned, atol=1e-6):
            self.handle.wxyz = turned

    def show(self, visible: bool) -> None:
        """Show or hide it; a hidden one is held by nobody."""
        if not visible:
            self._holder = self._newest = None
        if self.handle.visible != visible:
            self.handle.visible = visible
