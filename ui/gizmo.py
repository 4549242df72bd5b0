"""The handle by which the object is dragged over the skin.

The page sends a place many times a second; only the newest counts, and it is taken up when the
desk's pump turns. While the designer holds the handle it stays under the mouse; once let go it
stands at the object again.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

SCALE_MM = 9.0
"""Length of the arms."""


class Gizmo:
    """One handle; `moved` is told where it was dragged to."""

    def __init__(self, api: Any, moved: Callable[[np.ndarray], None]) -> None:
        self.moved = moved
        self._newest: np.ndarray | None = None
        self._held = False
        self.handle = api.add_transform_controls(
            "/drag",
            scale=SCALE_MM,
            line_width=4.0,
            disable_rotations=True,
            depth_test=False,
            visible=False,
        )

        @self.handle.on_update
        async def _(event: Any) -> None:
            # On the event loop, so that the places come in order; nothing is computed here.
            self._held = event.phase != "end"
            self._newest = np.array(self.handle.position, dtype=float)

    def turn(self) -> None:
        """Hand over the newest place, if one has come."""
        newest, self._newest = self._newest, None
        if newest is not None:
            self.moved(newest)

    def place(self, position: np.ndarray) -> None:
        """Stand at the object, unless the designer holds it."""
        if not self._held and not np.allclose(self.handle.position, position, atol=1e-4):
            self.handle.position = tuple(float(x) for x in position)

    def show(self, visible: bool) -> None:
        """Show or hide it."""
        if self.handle.visible != visible:
            self.handle.visible = visible
