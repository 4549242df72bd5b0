"""A map of the skin in the 3D view: one coloured mesh in place of the skin, and a told value."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ui.page.imaging import coloured_glb
from ui.scene.pointing import listen
from workbench.core.result.results import Skin
from workbench.view.section_cut import Plane


class MapView:
    """Nodes of one map."""

    def __init__(self, api: Any, on_click: Callable[[Any], None]) -> None:
        self.api = api
        self.on_click = on_click
        self._node: Any = None
        self._label: Any = None
        self._series = 0
        self._drawn: tuple[Skin, np.ndarray] | None = None
        self.plane: Plane | None = None
        """What the skin is cut by."""

    @property
    def on(self) -> bool:
        """Whether a map is shown."""
        return self._node is not None

    def load(self, skin: Skin, colours: np.ndarray) -> None:
        """Show a map in place of the one before; colours of shape (V, 3), uint8."""
        self.forget_value()
        before, self._series = self._node, 1 - self._series
        self._drawn = skin, colours
        points = np.asarray(skin.points_mm, np.float32)
        glb = coloured_glb(points, np.asarray(skin.faces), colours, self.plane)
        self._node = self.api.add_glb(f"/map/{self._series}", glb)
        listen(self._node, self.on_click)
        if before is not None:
            before.remove()

    def cut(self, plane: Plane | None) -> None:
        """Cut the map by a plane, or make it whole."""
        self.plane = plane
        if self._node is not None and self._drawn is not None:
            self.load(*self._drawn)

    def tell(self, place_mm: np.ndarray, text: str) -> None:
        """Write a value at a place of the skin."""
        self.forget_value()
        x, y, z = (float(c) for c in place_mm)
        self._label = self.api.add_label(
            "/map_value", text, position=(x, y, z), anchor="bottom-center"
        )

    def forget_value(self) -> None:
        """Take the told value away."""
        if self._label is not None:
            self._label.remove()
            self._label = None

    def show(self, visible: bool) -> None:
        """Show or hide the map while other things are looked at."""
        for node in (self._node, self._label):
            if node is not None and node.visible != visible:
                node.visible = visible

    def clear(self) -> None:
        """Take the map away."""
        self.forget_value()
        if self._node is not None:
            self._node.remove()
            self._node = self._drawn = None
