"""Other designs in the 3D view: translucent, in colours of their own, beside the sensor or over it.

What is drawn is made by a thread of its own from stored results, so that a large body holds up
nobody; a newer wish makes an older one void. Body or pressed skin, lights and cameras are drawn,
not the parts.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ui.scene.ghost_rig import ghost_rig
from workbench.core.base.errors import StoreError
from workbench.pipeline.store import Store
from workbench.variants.comparison_side import Side
from workbench.view.scene_shapes import outer_faces

COLOURS = ((64, 160, 255), (255, 140, 50))
"""Of A and B: seen apart by colour-blind people too."""
OPACITY = 0.45
GAP_SHARE = 0.25
"""Between two sensors, over the width of the wider."""
OUTWARD = 0.004
"""A ghost over another body is so much larger, or equal skins would flicker."""
ABOVE_MM = 3.0
"""Height of a label over what it names [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Ghost:
    """A design to be drawn."""

    label: str
    side: Side
    colour: tuple[int, int, int]
    place: int
    """-1 left of the sensor, 1 right of it, 0 over it."""
    pressed: bool
    """Whether the last frame of its press is shown, where it is stored."""


class GhostView:
    """Nodes of the ghosts and the label of the sensor that they stand beside."""

    def __init__(self, server: Any, store: Store, *, on_error: Callable[[Exception], None]) -> None:
        self.server = server
        self.store = store
        self.on_error = on_error
        """Told by the thread what went wrong in it."""
        self._nodes: list[Any] = []
        self._wish = 0
        self._guard = threading.Lock()
        self.bounds_mm: tuple[np.ndarray, np.ndarray] | None = None
        """Lowest and highest corner of all that stands here [mm]."""

    @property
    def on(self) -> bool:
        """Whether anything is drawn."""
        return bool(self._nodes)

    def show(
        self,
        ghosts: Sequence[Ghost],
        *,
        own: str,
        bounds_mm: tuple[np.ndarray, np.ndarray],
        then: Callable[[str], None],
    ) -> None:
        """Draw these in place of those before.

        Args:
            ghosts: What to draw.
            own: Label of the sensor in the view.
            bounds_mm: Its lowest and highest corner [mm].
            then: Called by the thread at the end, with what could not be drawn.
        """
        with self._guard:
            self._wish += 1
            wish = self._wish
        work = (wish, tuple(ghosts), own, bounds_mm, then)
        threading.Thread(target=self._try, args=work, name="ghosts", daemon=True).start()

    def clear(self) -> None:
        """Take all away, and what is still being made."""
        with self._guard:
            self._wish += 1
            self._remove()

    def _remove(self) -> None:
        for node in self._nodes:
            node.remove()
        self._nodes.clear()
        self.bounds_mm = None

    def _try(self, *work: Any) -> None:
        try:
            self._make(*work)
        except Exception as error:
            # A thread that ends in silence would leave the old ghosts without a word.
            self.on_error(error)

    def _make(
        self,
        wish: int,
        ghosts: Sequence[Ghost],
        own: str,
        bounds_mm: tuple[np.ndarray, np.ndarray],
        then: Callable[[str], None],
    ) -> None:
        low, high = bounds_mm
        made, missing = [], []
        for ghost in ghosts:
            try:
                mesh = ghost_mesh(self.store, ghost)
            except StoreError:
                # Damaged is as good as not stored.
                mesh = None
            if mesh is None:
                missing.append(ghost.label)
            else:
                made.append((ghost, *mesh))
        with self._guard:
            if wish != self._wish:
                return
            self._remove()
            with self.server.atomic():
                for number, (ghost, points, faces) in enumerate(made):
                    offset = offset_mm((low, high), points, ghost.place)
                    placed = points + offset
                    if ghost.place == 0:
                        middle = placed.mean(axis=0)
                        placed = middle + (1.0 + OUTWARD * (number + 1)) * (placed - middle)
                    self._put(number, ghost, placed, faces)
                    optics, name = ghost.side.state.design.optics, f"/ghosts/{number}_rig"
                    api = self.server.scene
                    self._nodes += ghost_rig(api, name, optics, offset, ghost.colour)
                    low = np.minimum(low, placed.min(axis=0))
                    high = np.maximum(high, placed.max(axis=0))
                if made:
                    self._label("own", own, *bounds_mm)
            self.bounds_mm = (low, high)
        text = f"no body is stored of {' and '.join(missing)}: load it once" if missing else ""
        then(text)

    def _put(self, number: int, ghost: Ghost, points: np.ndarray, faces: np.ndarray) -> None:
        node = self.server.scene.add_mesh_simple(
            f"/ghosts/{number}",
            points.astype(np.float32),
            faces.astype(np.uint32),
            color=ghost.colour,
            opacity=OPACITY,
            side="double",
            flat_shading=False,
            cast_shadow=False,
        )
        self._nodes.append(node)
        lift = 2.0 * ABOVE_MM * (number + 1) if ghost.place == 0 else 0.0
        top = points.max(axis=0) + np.array([0.0, 0.0, lift])
        self._label(str(number), ghost.label, points.min(axis=0), top)

    def _label(self, name: str, text: str, low: np.ndarray, high: np.ndarray) -> None:
        middle = (low + high) / 2.0
        place = (float(middle[0]), float(middle[1]), float(high[2]) + ABOVE_MM)
        label = self.server.scene.add_label(
            f"/ghosts/label_{name}", text, position=place, anchor="bottom-center"
        )
        self._nodes.append(label)


def ghost_mesh(store: Store, ghost: Ghost) -> tuple[np.ndarray, np.ndarray] | None:
    """Vertices [mm] (N, 3) and triangles (M, 3) of a design's sensing side, or None.

    Of a pressed one the skin in its last frame, where press and mesh are stored.
    """
    side = ghost.side
    mesh, contact = side.load(store, "mesh"), side.load(store, "press")
    if ghost.pressed and mesh is not None and contact is not None:
        moved_mm = np.asarray(contact.displacement_mm[-1], dtype=np.float64)
        return np.asarray(mesh.outer.points_mm) + moved_mm, np.asarray(mesh.outer.faces)
    solid = side.load(store, "build")
    return None if solid is None else outer_faces(solid.membrane)


def offset_mm(
    bounds_mm: tuple[np.ndarray, np.ndarray], points_mm: np.ndarray, place: int
) -> np.ndarray:
    """How far along X a ghost is moved to stand beside the box of the others [mm], shape (3,)."""
    if place == 0:
        return np.zeros(3)
    low, high = bounds_mm
    left, right = float(points_mm[:, 0].min()), float(points_mm[:, 0].max())
    gap = GAP_SHARE * max(float(high[0] - low[0]), right - left)
    way = float(high[0]) + gap - left if place > 0 else float(low[0]) - gap - right
    return np.array([way, 0.0, 0.0])
