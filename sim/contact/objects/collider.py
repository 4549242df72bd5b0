"""A rigid indenter ready for contact: its shape number, dimensions and samples where it has any."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from sim.contact.objects import textures
from sim.contact.objects.object_measures import lowest_mm, sharpest_mm
from sim.contact.objects.samples import Window
from sim.contact.objects.sampling import box_mm, kept_samples
from sim.contact.objects.shape_distance import SEAT, analytic_size, evaluate
from workbench.core.objects.kind import Shape
from workbench.core.press.indenter import Indenter
from workbench.core.result.sampled import SampledDistance

SEATED = (Shape.SPHERE, Shape.CUBE, Shape.CYLINDER_Z)
"""Shapes whose lowest point is on the axis, a half width and an edge below the centre."""
SHARPEST_MESH_CELLS = 2.4
"""Least radius taken for a mesh, whose edges are not known, in cells."""
COARSE_SLACK = 0.5
"""Coarse distances are lowered by this many of their samples, so that they are lower bounds."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Collider:
    """Signed distance of a rigid body in its own frame."""

    shape: Shape
    size: np.ndarray
    """Dimensions as in `shape_distance.analytic_size`, or grid origin and 1 / spacing, shape
    (8,)."""
    samples: np.ndarray
    """Quadratic B-spline coefficients of the distance [mm], shape (A, B, C); (1, 1, 1) if none."""
    reach_mm: float
    """Radius about the origin that holds the whole body."""
    half_height_mm: float
    """Distance from the origin to the lowest point."""
    least_radius_mm: float
    """Radius of the sharpest part: the ball or the edge; `SHARPEST_MESH_CELLS` for a mesh."""
    whole: Collider | None = None
    """The whole body, sampled coarsely, where `samples` hold only the part in a window."""
    cut: np.ndarray | None = None
    """Lower and upper sides of the window beyond which the body goes on, shape (2, 3), bool."""

    soft: bool = False
    """Whether the body gives way itself; its kernels count positions from the body's origin."""

    @property
    def seat_mm(self) -> np.ndarray:
        """Where the kernels count positions from, body frame, shape (3,): a lowest point.

        From the centre of a ball of 50 mm, a place is known to 4 nm in single precision; as stiff
        as the contact is, forces then rattle by a thousandth and never settle. Under a flat face
        all points rattle as one: a cube of 18 mm on gel of 5 kPa, by half a percent.
        """
        seated = self.shape in SEATED and not self.soft
        return np.array([0.0, 0.0, -self.size[0] - self.size[2] if seated else 0.0])

    @property
    def seated_size(self) -> np.ndarray:
        """`size` for positions counted from `seat_mm`, shape (8,)."""
        size = self.size.copy()
        if self.shape in SEATED:
            size[SEAT] = self.seat_mm[2]
        return size

    def distance(self, position_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Signed distances [mm], (N,), and gradients, (N, 3), at body positions, (N, 3).

        Beyond a side where a window cut the body they are a coarse lower bound; the kernels see
        no contact there.
        """
        distance, gradient = evaluate(position_mm, self.shape, self.size, self.samples)
        if self.whole is not None and self.cut is not None:
            steps = (position_mm - self.size[:3]) * self.size[3]
            last = np.array(self.samples.shape) - 2.5
            out = ((steps < 1.5) & self.cut[0] | (steps > last) & self.cut[1]).any(axis=1)
            coarse, slopes = self.whole.distance(position_mm[out])
            distance[out] = coarse - COARSE_SLACK / self.whole.size[3]
            gradient[out] = slopes
        return distance, gradient


def make_collider(
    indenter: Indenter,
    *,
    grid_mm: float,
    window_mm: Window | None = None,
    whole: SampledDistance | None = None,
) -> Collider:
    """Prepare an indenter; all but unturned spheres, cylinders, cubes and cones are sampled.

    Args:
        indenter: The object.
        grid_mm: Edge of a cell of the contact grid; distances are sampled at 0.4 of it.
        window_mm: Lower and upper corner, in the body frame, of what can come near the skin. A
            large object is then sampled finely there only. Outside, `distance` is a coarse lower
            bound, while the kernels see no contact: choose it to hold all that may touch.
        whole: What `sampling.sample_indenter` returned for the whole object on this grid, from a
            store; sampled here if None. Shapes that need no samples leave it unused.

    Raises:
        DesignError: If the shape cannot be made.
    """
    shape = indenter.record.shape
    if shape is Shape.GRID or indenter.texture.raised or indenter.turned:
        return _sampled(indenter, grid_mm, window_mm, whole)
    ball = shape is Shape.SPHERE
    return Collider(
        shape=shape,
        size=analytic_size(indenter),
        samples=np.zeros((1, 1, 1)),
        reach_mm=indenter.size_mm * (0.5 if ball else 0.5 * 3.0**0.5),
        half_height_mm=lowest_mm(indenter),
        least_radius_mm=sharpest_mm(indenter),
        soft=indenter.soft is not None,
    )


def _sampled(
    indenter: Indenter, grid_mm: float, window_mm: Window | None, whole: SampledDistance | None
) -> Collider:
    if window_mm is not None:
        field = kept_samples(indenter, grid_mm=grid_mm, window_mm=window_mm)
        fine = _collider(indenter, grid_mm, field)
        if not field.cut.any():
            return fine
        around = _sampled(indenter, grid_mm, None, whole)
        return dataclasses.replace(fine, whole=around, cut=field.cut)
    return _collider(indenter, grid_mm, whole or kept_samples(indenter, grid_mm=grid_mm))


def _collider(indenter: Indenter, grid_mm: float, field: SampledDistance) -> Collider:
    size = np.zeros(8)
    size[:3], size[3] = field.origin_mm, 1.0 / field.spacing_mm
    raised_mm = indenter.texture.height_mm if indenter.texture.raised else 0.0
    if indenter.mesh is not None:
        reach_mm = float(np.linalg.norm(indenter.mesh.points_mm, axis=1).max()) + raised_mm
        least_radius_mm = indenter.mesh_rounding_mm or SHARPEST_MESH_CELLS * grid_mm
    else:
        low, high = box_mm(indenter)
        reach_mm = float(np.linalg.norm(np.maximum(-low, high)))
        least_radius_mm = sharpest_mm(indenter)
    return Collider(
        shape=Shape.GRID,
        size=size,
        samples=field.coefficients,
        reach_mm=reach_mm,
        half_height_mm=lowest_mm(indenter) + raised_mm,
        least_radius_mm=min(
            least_radius_mm, textures.sharpest_mm(indenter.texture, field.spacing_mm)
        ),
        soft=indenter.soft is not None,
    )
