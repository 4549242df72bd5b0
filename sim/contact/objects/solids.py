"""Exact signed distances of the objects that the kernel samples on a grid, in plain NumPy.

A prism is its cross-section (`profiles`) between two planes: outside both, the distance is that of
a right angle. Rounding is exact: the sharp body is made smaller by the edge radius and its
distance lowered by it, so concave corners stay sharp. Widths are those of `IndenterKind`.
Sources: Quilez, Distance functions (octahedron); Eberly, Distance from a point to an ellipsoid.
Left out: inside a re-entrant corner the depth is that to the shrunk body, not to the corner.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim.contact.objects.profiles import POLYGONS, area_mm2, profile
from sim.contact.objects.shapes import SHAPE_OF_KIND, Shape, analytic_size, evaluate, half_height_mm
from workbench.core.indenter import Indenter, IndenterKind
from workbench.core.turning import turn_matrix

Solid = Callable[[np.ndarray], np.ndarray]
"""Signed distances [mm], shape (N,), of places (N, 3) in the body frame."""

ELLIPSOID_AXES = np.array([1.0, 0.7, 0.5])
TUBE_SHARE = 0.15
"""Radius of the torus's tube over its outer diameter."""
BISECTIONS = 60
FAR_SHARE = 1e6
"""Distance over the size from which a body is looked at for its extent: misses 1e-7 of it."""
LEAST_SHARE = 1e-9
"""Places are kept this share of an axis off the ellipsoid's planes, where the root is double."""


def solid(indenter: Indenter) -> Solid:
    """Exact distance of any indenter that is no mesh, as it is turned, without its texture."""
    upright = _upright(indenter)
    if not indenter.turned:
        return upright
    turn = turn_matrix(indenter.turn_deg)
    return lambda place: upright(place @ turn)


def _upright(indenter: Indenter) -> Solid:
    kind, size_mm, edge_mm = indenter.kind, indenter.size_mm, indenter.edge_radius_mm
    shape = SHAPE_OF_KIND[kind]
    if shape is not Shape.GRID:
        numbers = analytic_size(indenter)
        return lambda place: evaluate(place, shape, numbers)[0]
    if kind is IndenterKind.ELLIPSOID:
        semi_axes = 0.5 * size_mm * ELLIPSOID_AXES
        return lambda place: _ellipsoid(place, semi_axes)
    if kind is IndenterKind.TORUS:
        return lambda place: _torus(place, size_mm)
    if kind is IndenterKind.DIAMOND:
        # A face lies at half / sqrt(3) from the centre.
        inner = 0.5 * size_mm - 3.0**0.5 * edge_mm
        return lambda place: _octahedron(place, inner) - edge_mm
    section = profile(kind, size_mm, edge_mm)
    half_mm = 0.5 * size_mm - edge_mm
    return lambda place: _prism(place, section, half_mm) - edge_mm


def smooth_box_mm(indenter: Indenter) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper corner [mm] of a box that holds an indenter without its texture, (3,) each.

    A turned body's is exact: the support function h(d) of a body is the limit of t - f(t d) for
    large t, f its distance.
    """
    mesh = indenter.standing_mesh
    if mesh is not None:
        return mesh.points_mm.min(axis=0), mesh.points_mm.max(axis=0)
    if not indenter.turned:
        half = _half_extent_mm(indenter)
        return -half, half
    far_mm = FAR_SHARE * indenter.size_mm
    ways = np.vstack([-np.eye(3), np.eye(3)])
    low, high = (far_mm - solid(indenter)(far_mm * ways)).reshape(2, 3)
    return -low, high


def _half_extent_mm(indenter: Indenter) -> np.ndarray:
    """Half widths of such a box about the origin of an unturned kind, shape (3,)."""
    half = 0.5 * indenter.size_mm
    if indenter.kind is IndenterKind.ELLIPSOID:
        return half * ELLIPSOID_AXES
    if indenter.kind is IndenterKind.TORUS:
        return np.array([half, half, lowest_mm(indenter)])
    if indenter.kind in POLYGONS:
        # A triangle reaches beyond half its side on one side only.
        wide = np.abs(POLYGONS[indenter.kind](indenter.size_mm)).max(axis=0)
        return np.append(wide, half)
    return np.full(3, half)


def lowest_mm(indenter: Indenter) -> float:
    """Distance from the body origin to the plane that bounds an indenter toward -Z, untextured."""
    if indenter.turned:
        return -float(smooth_box_mm(indenter)[0][2])
    if indenter.kind is IndenterKind.ELLIPSOID:
        return 0.5 * indenter.size_mm * float(ELLIPSOID_AXES[2])
    if indenter.kind is IndenterKind.TORUS:
        return TUBE_SHARE * indenter.size_mm
    if indenter.kind is IndenterKind.DIAMOND:
        # The tip of the sharp body is cut back from sqrt(3) radii to one.
        return 0.5 * indenter.size_mm - (3.0**0.5 - 1.0) * indenter.edge_radius_mm
    return half_height_mm(indenter)


def sharpest_mm(indenter: Indenter) -> float:
    """Least radius of curvature of an indenter that is no mesh, without its texture [mm]."""
    half = 0.5 * indenter.size_mm
    if indenter.kind is IndenterKind.SPHERE:
        return half
    if indenter.kind is IndenterKind.ELLIPSOID:
        return half * float(ELLIPSOID_AXES[2] ** 2 / ELLIPSOID_AXES[0])
    if indenter.kind is IndenterKind.TORUS:
        return TUBE_SHARE * indenter.size_mm
    return indenter.edge_radius_mm


def sharp_volume_mm3(indenter: Indenter) -> float:
    """Volume of a kind that is sampled, without rounding or texture [mm3]: a closed form."""
    size_mm = indenter.size_mm
    if indenter.kind is IndenterKind.ELLIPSOID:
        return np.pi / 6.0 * size_mm**3 * float(np.prod(ELLIPSOID_AXES))
    if indenter.kind is IndenterKind.TORUS:
        tube = TUBE_SHARE * size_mm
        return 2.0 * np.pi**2 * (0.5 * size_mm - tube) * tube**2
    if indenter.kind is IndenterKind.DIAMOND:
        return size_mm**3 / 6.0
    return area_mm2(indenter.kind, size_mm) * size_mm


def _prism(
    place: np.ndarray, section: Callable[[np.ndarray], np.ndarray], half_mm: float
) -> np.ndarray:
    over = np.stack([section(place[:, :2]), np.abs(place[:, 2]) - half_mm])
    return np.minimum(over.max(axis=0), 0.0) + np.hypot(*np.maximum(over, 0.0))


def _torus(place: np.ndarray, size_mm: float) -> np.ndarray:
    tube = TUBE_SHARE * size_mm
    rho = np.hypot(place[:, 0], place[:, 1])
    return np.hypot(rho - (0.5 * size_mm - tube), place[:, 2]) - tube


def _octahedron(place: np.ndarray, half_mm: float) -> np.ndarray:
    """Distance to |x| + |y| + |z| <= half."""
    # With the axes in order of size, the face, an edge and a tip are met one after the other.
    small, middle, large = np.sort(np.abs(place), axis=1).T
    over = small + middle + large - half_mm
    along = np.clip(0.5 * (large - middle + half_mm), 0.0, half_mm)
    edge = np.sqrt(small**2 + (middle - half_mm + along) ** 2 + (large - along) ** 2)
    return np.where(3.0 * small >= over, over / 3.0**0.5, edge)


def _ellipsoid(place: np.ndarray, semi_axes: np.ndarray) -> np.ndarray:
    """The foot e^2 y / (t + e^2) of a place y, with t the largest root of |e y / (t + e^2)| = 1."""
    where = np.maximum(np.abs(place), LEAST_SHARE * semi_axes)
    least = int(np.argmin(semi_axes))
    low = semi_axes[least] * where[:, least] - semi_axes[least] ** 2
    high = np.linalg.norm(semi_axes * where, axis=1) - semi_axes[least] ** 2
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        ratio = semi_axes * where / (middle[:, None] + semi_axes**2)
        beyond = np.einsum("nc,nc->n", ratio, ratio) > 1.0
        low, high = np.where(beyond, middle, low), np.where(beyond, high, middle)
    foot = semi_axes**2 * where / (0.5 * (low + high)[:, None] + semi_axes**2)
    distance = np.linalg.norm(where - foot, axis=1)
    inside = np.linalg.norm(where / semi_axes, axis=1) < 1.0
    return np.where(inside, -distance, distance)
