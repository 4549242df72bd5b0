"""The rigid object as Newton's method needs it: distance, gradient and curvature, in float64.

Distance and gradient are those of `sim.contact.objects.shape_distance`; the second derivatives are
added here, in closed form for sphere, cylinders, cube and cone, and as those of the B-spline for
objects that are sampled, where they are constant within a sample's cell. A shape of revolution has
the distance d(rho, z), so H = d_rr r r^T + d_rz (r z^T + z r^T) + d_zz z z^T + (d_r / rho) t t^T
with the unit vectors r, t, z of cylindrical coordinates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.grid.stencil import line_slopes, line_weights
from sim.contact.objects.collider import Collider
from sim.contact.objects.shape_distance import TINY_MM
from workbench.core.objects.kind import Shape

CURVES = np.array([1.0, -2.0, 1.0])
"""Second derivatives of the quadratic B-spline's three weights by the position in cells."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RigidPose:
    """Where the object is."""

    origin_mm: np.ndarray
    """Its origin, shape (3,)."""
    rotation: np.ndarray
    """Body to sensor, shape (3, 3)."""

    def carried(self, points_mm: np.ndarray, before: RigidPose) -> np.ndarray:
        """Where points (..., 3) fixed to the object go between the pose `before` and this one."""
        return (points_mm - before.origin_mm) @ self.turn(before).T + self.origin_mm

    def turn(self, before: RigidPose) -> np.ndarray:
        """Rotation since the pose `before`, shape (3, 3)."""
        return self.rotation @ before.rotation.T


def distance(
    collider: Collider, pose: RigidPose, points_mm: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Signed distances [mm], (N,), and gradients, (N, 3), at points (N, 3) of the sensor frame.

    Beyond the samples of a sampled object no contact is seen, also where a window has cut it: there
    the distance is that from their box, and the gradient is zero.
    """
    body = (points_mm - pose.origin_mm) @ pose.rotation
    if collider.shape is not Shape.GRID:
        found, slopes = collider.distance(body)
        return found, slopes @ pose.rotation.T
    raw, inside = _cells(body, collider)
    found = np.linalg.norm(raw - inside, axis=1) / collider.size[3]
    slopes = np.zeros_like(body)
    near = found <= 0.0
    found[near], slopes[near] = collider.distance(body[near])
    return found, slopes @ pose.rotation.T


def _cells(body: np.ndarray, collider: Collider) -> tuple[np.ndarray, np.ndarray]:
    """Places in cells of the samples, (N, 3), and the nearest ones where they can be looked up."""
    raw = (body - collider.size[:3]) * collider.size[3]
    return raw, np.clip(raw, 1.5, np.array(collider.samples.shape) - 2.5)


def curvature(collider: Collider, pose: RigidPose, points_mm: np.ndarray) -> np.ndarray:
    """Second derivatives of the distance [1/mm] at points (N, 3), shape (N, 3, 3)."""
    body = (points_mm - pose.origin_mm) @ pose.rotation
    if collider.shape is Shape.SPHERE:
        found = _sphere(body)
    elif collider.shape is Shape.CUBE:
        found = _cube(body, collider.size)
    elif collider.shape is Shape.GRID:
        found = _sampled(body, collider)
    else:
        found = _revolved(body, collider)
    return pose.rotation @ found @ pose.rotation.T


def _across(directions: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """(I - d d^T) / length: how the unit vector d turns with its place."""
    projector = np.eye(3) - directions[:, :, None] * directions[:, None, :]
    return projector / np.maximum(lengths, TINY_MM)[:, None, None]


def _sphere(body: np.ndarray) -> np.ndarray:
    radius = np.linalg.norm(body, axis=1)
    return _across(body / np.maximum(radius, TINY_MM)[:, None], radius)


def _cube(body: np.ndarray, size: np.ndarray) -> np.ndarray:
    over = np.abs(body) - size[0]
    outside = np.maximum(over, 0.0)
    length = np.linalg.norm(outside, axis=1)
    direction = np.where(body < 0.0, -1.0, 1.0) * outside
    direction /= np.maximum(length, TINY_MM)[:, None]
    beyond = (over > 0.0).astype(np.float64)
    found = beyond[:, :, None] * np.eye(3) - direction[:, :, None] * direction[:, None, :]
    found /= np.maximum(length, TINY_MM)[:, None, None]
    found[length <= TINY_MM] = 0.0
    return found


def _revolved(body: np.ndarray, collider: Collider) -> np.ndarray:
    axes = [2, 0, 1] if collider.shape is Shape.CYLINDER_Y else [0, 1, 2]
    first, second, axial = body[:, axes].T
    rho = np.maximum(np.hypot(first, second), TINY_MM)
    _, slopes = collider.distance(body)
    by_rho = (slopes[:, axes[0]] * first + slopes[:, axes[1]] * second) / rho
    by_z = slopes[:, axes[2]]
    profile = _cone_corner if collider.shape is Shape.CONE else _rim_corner
    # At a distance l from a rounded corner the profile's gradient (a, b) turns by 1 / l.
    bend = profile(rho, axial, collider.size)
    radial = np.zeros_like(body)
    radial[:, axes[0]], radial[:, axes[1]] = first / rho, second / rho
    around = np.zeros_like(body)
    around[:, axes[0]], around[:, axes[1]] = -second / rho, first / rho
    tangent = -by_z[:, None] * radial
    tangent[:, axes[2]] += by_rho
    found = bend[:, None, None] * tangent[:, :, None] * tangent[:, None, :]
    return found + (by_rho / rho)[:, None, None] * around[:, :, None] * around[:, None, :]


def _rim_corner(rho: np.ndarray, z: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Curvature of the profile of a cylinder [1/mm]: one over the distance from its rim."""
    over_rho, over_z = rho - size[0], np.abs(z) - size[1]
    corner = (over_rho > 0.0) & (over_z > 0.0)
    return np.where(corner, 1.0 / np.maximum(np.hypot(over_rho, over_z), TINY_MM), 0.0)


def _cone_corner(rho: np.ndarray, z: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Curvature of the profile of a cone [1/mm]: one over the distance from apex or rim."""
    rim, top, apex = size[0], size[1], size[3]
    along = 0.5 * (rho + z - apex)
    below = along < 0.0
    beyond = (along > rim) & (rho > rim)
    to_apex, to_rim = np.hypot(rho, z - apex), np.hypot(rho - rim, z - top)
    # Over the base, inside the rim, the profile is flat.
    length = np.where(below, to_apex, np.where(beyond, to_rim, np.inf))
    length[(z > top) & (rho <= rim)] = np.inf
    return 1.0 / np.maximum(length, TINY_MM)


def _sampled(body: np.ndarray, collider: Collider) -> np.ndarray:
    size, samples = collider.size, collider.samples
    raw, inside = _cells(body, collider)
    nearest = np.floor(inside + 0.5)
    local = inside - nearest
    orders = (line_weights(local), line_slopes(local), np.broadcast_to(CURVES, (*local.shape, 3)))
    index = nearest.astype(int)[:, :, None] + np.arange(-1, 2)
    block = samples[
        index[:, 0, :, None, None], index[:, 1, None, :, None], index[:, 2, None, None, :]
    ]
    found = np.empty((len(body), 3, 3))
    for row in range(3):
        for column in range(3):
            degree = [int(axis == row) + int(axis == column) for axis in range(3)]
            x, y, z = (orders[d][:, axis] for axis, d in enumerate(degree))
            found[:, row, column] = np.einsum("nijk,ni,nj,nk->n", block, x, y, z)
    found *= size[3] ** 2
    # Beyond the samples only a bound is known; nothing touches there.
    found[(np.abs(raw - inside) > 0.0).any(axis=1)] = 0.0
    return found
