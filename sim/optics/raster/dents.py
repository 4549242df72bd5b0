"""Analytic dents for validation: a ball, a cross or an edge pressed into any skin.

At the place where a ray from inside leaves the skin, with outward normal n, height k = q . n over
the tangent plane and tangential coordinates u, w: the object's face is the profile p(u, w) above
its lowest point, pushed in by the depth d, and the skin moves inward by a softened overlap

    disp = s ln(1 + exp((k + d - p) / s)),  s = 0.25 mm,

so that the foot of a dent is rounded over more than a triangle of 0.4 mm, as an elastomer of 2 mm
rounds it; a sharper foot would compare the triangles of both methods instead of their light.

No elasticity: dents with steep and gentle slopes, known to everyone who compares with them.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np

from workbench.core.base.errors import OpticsError
from workbench.core.result.results import Skin

SOFTNESS_MM = 0.25
LEAST_MM = 2e-3
"""Displacements below this are cut off: a tenth of a grey level."""
REACH_MM = 9.0
"""Nothing moves farther away than this from the place."""
FOOT_MM = 2.0
"""The dent fades to nothing over this height above the base, where the skin is held."""


class DentKind(enum.StrEnum):
    """What is pressed in."""

    SPHERE = "sphere"
    CROSS = "cross"
    EDGE = "edge"


@dataclass(frozen=True, kw_only=True, slots=True)
class Dent:
    """One dent: from a point inside, in a direction, to the skin."""

    name: str
    kind: DentKind
    from_mm: tuple[float, float, float]
    """Point inside the sensor [mm]."""
    toward: tuple[float, float, float]
    """Direction from there to the place."""
    depth_mm: float


FINGER_DENTS = (
    Dent(
        name="sphere",
        kind=DentKind.SPHERE,
        from_mm=(0, 0, 22),
        toward=(0.866, 0.5, 0),
        depth_mm=1.3,
    ),
    Dent(name="cross", kind=DentKind.CROSS, from_mm=(0, 0, 26), toward=(0, -1, 0), depth_mm=0.9),
    Dent(name="tip", kind=DentKind.SPHERE, from_mm=(0, 0, 26), toward=(0, 0, 1), depth_mm=1.3),
)
"""On a finger of 15 mm radius and 42 mm height."""
TRUNK_DENTS = (
    Dent(
        name="sphere",
        kind=DentKind.SPHERE,
        from_mm=(0, 0, 17),
        toward=(0.55, 0.8, 0),
        depth_mm=1.3,
    ),
    Dent(
        name="edge",
        kind=DentKind.EDGE,
        from_mm=(0, 0, 20),
        toward=(-0.8, 0.3, 0.3),
        depth_mm=1.1,
    ),
)
"""On the shipped trunk: the sphere on its broad side, the edge where the side meets the saddle."""
PAW_DENTS = (
    Dent(
        name="sphere",
        kind=DentKind.SPHERE,
        from_mm=(0, 0, 9),
        toward=(0.55, 0.8, 0.3),
        depth_mm=1.3,
    ),
    Dent(
        name="edge",
        kind=DentKind.EDGE,
        from_mm=(0, 0, 10),
        toward=(0.15, -0.35, 0.95),
        depth_mm=1.1,
    ),
)
"""On the shipped paw: the sphere on a toe's side, the edge on the heel pad."""


def dented(skin: Skin, dent: Dent) -> np.ndarray:
    """Displacement of the skin's vertices [mm], shape (V, 3), float32.

    Raises:
        OpticsError: If the dent's ray misses the skin.
    """
    place, normal = _place(skin, dent)
    across = np.cross(normal, [0.3, 0.5, 0.8])
    across /= np.linalg.norm(across)
    along = np.cross(normal, across)
    offset = skin.points_mm - place
    height = offset @ normal
    overlap = height + dent.depth_mm - _profile(dent.kind, offset @ across, offset @ along)
    near = (np.linalg.norm(offset, axis=1) < REACH_MM) & (height > -3.0)
    moved = SOFTNESS_MM * np.logaddexp(0.0, overlap / SOFTNESS_MM)
    moved = np.where(near & (moved > LEAST_MM), moved, 0.0)
    base = float(skin.points_mm[:, 2].min())
    moved *= np.clip((skin.points_mm[:, 2] - base) / FOOT_MM, 0.0, 1.0)
    return (-moved[:, None] * normal).astype(np.float32)


def _place(skin: Skin, dent: Dent) -> tuple[np.ndarray, np.ndarray]:
    """Where the dent's ray leaves the skin [mm], and the outward unit normal there."""
    from geometry.surface.rays import RayCaster

    toward = np.asarray(dent.toward, dtype=np.float64)
    toward /= np.linalg.norm(toward)
    origin = np.asarray(dent.from_mm, dtype=np.float64)
    distance, face, weights = RayCaster(skin.points_mm, skin.faces).hits(origin[None], toward[None])
    if face[0] < 0:
        raise OpticsError(f"the dent {dent.name} misses the skin", hint="aim it at the skin")
    normal = weights[0] @ skin.normals[skin.faces[face[0]]]
    return origin + distance[0] * toward, normal / np.linalg.norm(normal)


def _profile(kind: DentKind, u: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Height of the object's face over its lowest point [mm]."""
    if kind is DentKind.SPHERE:
        square = 16.0 - u**2 - w**2
        return np.where(square > 0.0, 4.0 - np.sqrt(np.maximum(square, 0.0)), 9.0)
    if kind is DentKind.EDGE:
        return _bar(u, w, half_width_mm=0.25)
    return np.minimum(_bar(u, w, half_width_mm=1.0), _bar(w, u, half_width_mm=1.0))


def _bar(u: np.ndarray, w: np.ndarray, *, half_width_mm: float) -> np.ndarray:
    """A bar of 8 mm length with flanks of about 40 degrees."""
    across, beyond = np.abs(u) - half_width_mm, np.abs(w) - 4.0
    return 0.8 * np.maximum(across, 0.0) + 0.9 * np.maximum(beyond, 0.0)
