"""Where on a sensor's skin an object begins: a place, its axes, and how far above it touches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.base.frames import quaternion, tangent
from workbench.core.base.poses import rotations

if TYPE_CHECKING:
    from workbench.core.result.condensed import CondensedSkin
    from workbench.sensor.things import Thing

HALVINGS = 40


@dataclass(frozen=True, kw_only=True, slots=True)
class Place:
    """A point of the skin at rest with its axes."""

    origin_mm: np.ndarray
    """Sensor frame, shape (3,)."""
    axes: np.ndarray
    """Columns u, v and the outward normal n, shape (3, 3)."""

    def pose(self, moved_mm: np.ndarray) -> np.ndarray:
        """Pose, shape (7,), of an object that stands so far along u, v, n, its z along n."""
        return np.r_[self.origin_mm + self.axes @ moved_mm, quaternion(self.axes)]


def inner_nodes(skin: CondensedSkin, margin_mm: float) -> np.ndarray:
    """Nodes that are at least so far from the skin's open edge, shape (n,).

    Raises:
        DesignError: If there is none.
    """
    from scipy.spatial import KDTree

    edges = np.sort(np.concatenate([skin.faces[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]))
    found, count = np.unique(edges, axis=0, return_counts=True)
    rim = np.unique(found[count == 1])
    if not len(rim):
        return np.arange(len(skin.points_mm))
    away_mm, _ = KDTree(skin.points_mm[rim]).query(skin.points_mm)
    inner = np.flatnonzero(away_mm >= margin_mm)
    if not len(inner):
        raise DesignError(
            f"no place of the skin is {margin_mm:.1f} mm from its edge, only "
            f"{away_mm.max():.1f} mm",
            hint="take a smaller object, or a smaller margin_mm",
            at="margin_mm",
        )
    return inner


def place_at(skin: CondensedSkin, node: int, turn_rad: float = 0.0) -> Place:
    """The place of a node, its u turned about the normal."""
    normal = skin.normals[node]
    u = tangent(normal)
    u = np.cos(turn_rad) * u + np.sin(turn_rad) * np.cross(normal, u)
    axes = np.column_stack([u, np.cross(normal, u), normal])
    return Place(origin_mm=skin.points_mm[node], axes=axes)


def touching_mm(place: Place, thing: Thing, skin: CondensedSkin) -> float:
    """How far along n an object is that just touches the skin's nodes."""
    reach_mm = thing.collider.reach_mm + float(np.linalg.norm(thing.centre_mm))
    away_mm = np.linalg.norm(skin.points_mm - place.origin_mm, axis=1)
    nodes_mm = skin.points_mm[away_mm < 2.0 * reach_mm]

    def gap_mm(height_mm: float) -> float:
        pose = thing.placed(place.pose(np.array([0.0, 0.0, height_mm]))[None])[0]
        distance_mm, _ = thing.collider.distance((nodes_mm - pose[:3]) @ rotations(pose[3:]))
        return float(distance_mm.min())

    low_mm, high_mm = -reach_mm, 2.0 * reach_mm
    for _ in range(HALVINGS):
        middle_mm = 0.5 * (low_mm + high_mm)
        low_mm, high_mm = (middle_mm, high_mm) if gap_mm(middle_mm) < 0.0 else (low_mm, middle_mm)
    return high_mm
