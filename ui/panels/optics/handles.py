"""Handles of cameras and lights: each is switched on in its folder and follows what is edited.

A drag edits the whole camera, ring or lamp as one field, so that it is one step of undo.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ui.scene.gizmo import Arms, Gizmo
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import Lamp, LedRing

if TYPE_CHECKING:
    from ui.desk.desk import Desk

RING = "design.optics.ring"
STEP_MM = 0.05
"""Places are rounded to this."""
SMALL_MM = 6.0
"""Length of the arms: cameras and lights stand close together."""


class Handle:
    """A check box and the handle it shows.

    `path` names the camera, ring or lamp that is edited, "" while there is none.
    """

    def __init__(
        self,
        desk: Desk,
        label: str,
        *,
        path: Callable[[], str],
        turns: bool = False,
        axes: tuple[bool, bool, bool] = (True, True, True),
    ) -> None:
        self.desk = desk
        self.path = path
        hint = "Drag it in the 3D view, through the skin; one drag is one step of undo"
        self.box = desk.server.gui.add_checkbox(label, False, hint=hint)
        self.box.on_update(desk.guarded(lambda event: self.follow()))
        name = "/handles/" + label.split(maxsplit=1)[0].lower()
        self.gizmo = Gizmo(
            desk.scene.api,
            self._moved,
            edits=desk.editor.edits,
            arms=Arms(name=name, length_mm=SMALL_MM, turns=turns, axes=axes),
        )
        desk.gizmos.append(self.gizmo)

    def follow(self) -> None:
        """Stand at what is edited, if the box is ticked."""
        path = self.path()
        shown = bool(self.box.value) and bool(path)
        self.gizmo.show(shown)
        self.desk.scene.look_inside(self.gizmo.handle.name, shown)
        if path:
            self.gizmo.place(*_pose(self.desk.read(path)))

    def _moved(self, place_mm: np.ndarray, wxyz: np.ndarray) -> None:
        path = self.path()
        if not path or not self.box.value:
            return
        before = self.desk.read(path)
        after = _at(before, place_mm, wxyz)
        self.desk.session.hold(path if self.gizmo.held else "")
        if after != before:
            self.desk.edit(path, after)
            self.desk.fields.refresh()


def _pose(item: Camera | LedRing | Lamp) -> tuple[np.ndarray, np.ndarray | None]:
    """Place [mm] and quaternion of a thing; None where it has no turn of its own."""
    if isinstance(item, LedRing):
        return np.array([0.0, 0.0, item.height_mm]), None
    turned = np.array(item.wxyz) if isinstance(item, Camera) else None
    return np.array(item.position_mm), turned


def _at(item: Any, place_mm: np.ndarray, wxyz: np.ndarray) -> Any:
    """The same thing at another place."""
    x, y, z = (_rounded(value) for value in place_mm)
    if isinstance(item, LedRing):
        return dataclasses.replace(item, height_mm=z)
    if isinstance(item, Lamp):
        return dataclasses.replace(item, position_mm=(x, y, z))
    w, i, j, k = (round(float(part), 9) + 0.0 for part in wxyz / np.linalg.norm(wxyz))
    return dataclasses.replace(item, position_mm=(x, y, z), wxyz=(w, i, j, k))


def _rounded(value: float) -> float:
    return round(round(float(value) / STEP_MM) * STEP_MM, 6) + 0.0
