"""Images of dents in a flat skin, with the heights below them: what a table is fitted to.

Dents are by geometry alone (`sim.optics.studio.geometric_dent`): a table knows light, not force.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geometry.objects.indenters import primitive_mesh
from sim.optics.studio.geometric_dent import geometric_dent
from workbench.core.base.errors import OpticsError
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.taxim.flatness import FACING_DEG, FlatView

if TYPE_CHECKING:
    from sim.optics.studio.render import Studio
    from workbench.core.result.results import Skin

SIZE_MM = 4.0
"""Of the ball, as in Taxim's own calibration."""
DEPTH_MM = (0.3, 1.2)
"""A dent's depth is drawn evenly from these [mm]."""
SMOOTH = 0.3
"""Heights are smoothed by so many spacings of the skin's vertices, whose triangles they show while
the light shows none."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Dent:
    """One of them, or several."""

    rgb: np.ndarray
    """Image, shape (H, W, 3), uint8."""
    height_px: np.ndarray
    """Way of the skin toward the camera along its axis, in pixels, shape (H, W); 0 at rest."""
    moved: np.ndarray
    """Flat pixels whose skin moved, shape (H, W), bool."""


class DentMaker:
    """Presses objects into the flat part of a skin."""

    def __init__(self, studio: Studio, skin: Skin, view: FlatView, axis: np.ndarray) -> None:
        from scipy.ndimage import gaussian_filter

        self._studio, self._skin, self._view = studio, skin, view
        still = np.zeros((0, len(skin.points_mm), 3), dtype=np.float32)
        at_rest = studio.shoot(still)
        self.rest: np.ndarray = at_rest.rgb[0]
        """The image at rest, shape (H, W, 3), uint8."""
        self._depth_mm = at_rest.depth_z_mm[0].astype(float)
        facing = np.cos(np.radians(FACING_DEG))
        flat = studio.visible & (np.asarray(skin.normals) @ axis > facing)
        self._places = self._in_the_middle(np.flatnonzero(flat))
        edges = skin.points_mm[skin.faces[:, 1]] - skin.points_mm[skin.faces[:, 0]]
        spacing_mm = float(np.median(np.linalg.norm(edges, axis=1)))
        self._blur_px = SMOOTH * spacing_mm / view.mm_per_px
        self._smooth = gaussian_filter

    def dents(self, kind: IndenterKind, count: int, seed: int) -> Iterator[Dent]:
        """So many dents of an object at random places and depths.

        Raises:
            OpticsError: If a dent cannot be drawn.
        """
        rng = np.random.default_rng(seed)
        points_mm, faces = primitive_mesh(Indenter(kind=kind, size_mm=SIZE_MM))
        for _ in range(count):
            target_mm = self._skin.points_mm[rng.choice(self._places)]
            moved = geometric_dent(
                self._skin,
                points_mm,
                faces,
                target_mm=target_mm,
                depth_mm=float(rng.uniform(*DEPTH_MM)),
            )
            yield self._shown(moved)

    def _shown(self, moved_mm: np.ndarray) -> Dent:
        frames = self._studio.shoot(moved_mm[None])
        toward_mm = self._depth_mm - frames.depth_z_mm[1]
        toward_mm[~(np.isfinite(toward_mm) & self._view.flat)] = 0.0
        height_px = self._smooth(toward_mm, self._blur_px) / self._view.mm_per_px
        return Dent(rgb=frames.rgb[1], height_px=height_px, moved=frames.moved[1] & self._view.flat)

    def _in_the_middle(self, nodes: np.ndarray) -> np.ndarray:
        """Those whose dents stay on the flat skin."""
        from scipy.spatial import KDTree

        others = np.setdiff1d(np.arange(len(self._skin.points_mm)), nodes)
        points = self._skin.points_mm
        if not len(others):
            return nodes
        away_mm, _ = KDTree(points[others]).query(points[nodes])
        inside = nodes[away_mm > 0.5 * SIZE_MM]
        if not len(inside):
            raise OpticsError(
                f"no place of the flat skin is {0.5 * SIZE_MM:g} mm from its edge",
                hint="the format of Taxim is fitted with a ball that needs so much",
                at="--taxim",
            )
        return inside
