"""The shape that the 3D view draws of the object that presses, made in a lane.

Contouring a cross takes more than a second, for which the server would hold all tabs up. A
`DrawingCall` is a `workbench.live.preview_call`; the lane keeps the last shapes, by their content,
and its previews of the tactile image take them from there too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.core.base.digest import at_defaults, digest
from workbench.core.base.monitor import Monitor
from workbench.core.design.turning import Angles
from workbench.core.press.indenter import Indenter
from workbench.pipeline.store import Store
from workbench.pipeline.touching_side import meant_turn

KEPT_SHAPES = 8
"""Shapes that a lane remembers: back and forth between a few objects costs nothing."""
TOUCHING_MM = 0.5
"""Height above its lowest point up to which an object is drawn as touching."""
SHAPES = "object shapes"
"""Name under which a lane keeps them."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Drawing:
    """What is drawn of an object, in its body frame."""

    points_mm: np.ndarray
    """Vertices, shape (N, 3), float64."""
    faces: np.ndarray
    """Triangles counter-clockwise from outside, shape (M, 3), uint32."""
    lowest_mm: float
    """Extent below the origin."""
    touching: tuple[np.ndarray, np.ndarray] = (np.zeros((0, 3)), np.zeros((0, 3), np.uint32))
    """Vertices [mm], (P, 3), and triangles, (Q, 3), of the side that touches."""
    meant: Angles | None = None
    """Turn with which its structured side would touch, where a flat one does."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DrawingCall:
    """One object to draw; a `PreviewCall`."""

    indenter: Indenter

    @property
    def lane(self) -> str:
        """The worker that answers what follows the hand."""
        return "look"

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "drawing the object"

    @property
    def needs(self) -> tuple[str, ...]:
        """No stage: the object is all that it depends on."""
        return ()

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> Drawing:
        """Make the shape, or remember it.

        Raises:
            DesignError: If the shape cannot be made.
        """
        from geometry.objects.touching import touching_patch

        points_mm, faces = shapes_of(kept).shape(self.indenter)
        return Drawing(
            points_mm=points_mm,
            faces=faces.astype(np.uint32),
            lowest_mm=-float(points_mm[:, 2].min()),
            touching=touching_patch(points_mm, faces, TOUCHING_MM),
            meant=meant_turn(self.indenter),
        )


class Shapes:
    """The last shapes of one process, by the content of their objects."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[np.ndarray, np.ndarray]] = {}

    def shape(self, indenter: Indenter) -> tuple[np.ndarray, np.ndarray]:
        """Vertices [mm] (N, 3) in the body frame and triangles (M, 3) of an object.

        Raises:
            DesignError: If the shape cannot be made.
        """
        from workbench.live.indenter_display import display_mesh

        # How soft it is does not change how it looks at rest.
        key = digest(at_defaults(indenter, "soft"))
        found = self._kept.pop(key, None)
        self._kept[key] = display_mesh(indenter) if found is None else found
        while len(self._kept) > KEPT_SHAPES:
            del self._kept[next(iter(self._kept))]
        return self._kept[key]


def shapes_of(kept: dict[str, Any]) -> Shapes:
    """The shapes among what a lane keeps from one preview to the next."""
    return kept.setdefault(SHAPES, Shapes())
