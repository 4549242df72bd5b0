"""Measures of an object as it stands: exact signed distance, extent and sharpness.

`workbench.core.objects.kinds` says what each is; a shape that the kernels know in closed form is
evaluated by their twin.
"""

from __future__ import annotations

import numpy as np

from sim.contact.objects.shape_distance import analytic_size, evaluate
from workbench.core.design.turning import turn_matrix
from workbench.core.objects.kind import Distance
from workbench.core.press.indenter import Indenter

FAR_SHARE = 1e6
"""Distance over the size from which a body is looked at for its extent: misses 1e-7 of it."""


def exact_distance(indenter: Indenter) -> Distance:
    """Exact distance of any indenter that is no mesh, as it is turned, without its texture."""
    upright = _upright(indenter)
    if not indenter.turned:
        return upright
    turn = turn_matrix(indenter.turn_deg)
    return lambda place: upright(place @ turn)


def _upright(indenter: Indenter) -> Distance:
    kind = indenter.record
    if kind.distance is not None:
        return kind.distance(indenter.size_mm, indenter.edge_radius_mm)
    numbers = analytic_size(indenter)
    return lambda place: evaluate(place, kind.shape, numbers)[0]


def smooth_box_mm(indenter: Indenter) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper corner [mm] of a box that holds an indenter without its texture, (3,) each.

    A turned body's is exact: the support function h(d) of a body is the limit of t - f(t d) for
    large t, f its distance.
    """
    mesh = indenter.standing_mesh
    if mesh is not None:
        return mesh.points_mm.min(axis=0), mesh.points_mm.max(axis=0)
    if not indenter.turned:
        half = indenter.record.extent_mm(indenter.size_mm)
        return -half, half
    far_mm = FAR_SHARE * indenter.size_mm
    ways = np.vstack([-np.eye(3), np.eye(3)])
    low, high = (far_mm - exact_distance(indenter)(far_mm * ways)).reshape(2, 3)
    return -low, high


def lowest_mm(indenter: Indenter) -> float:
    """Distance from the body origin to the plane that bounds an indenter toward -Z, untextured."""
    if indenter.turned:
        return -float(smooth_box_mm(indenter)[0][2])
    if indenter.mesh is not None:
        return -float(indenter.mesh.points_mm[:, 2].min())
    return indenter.record.lowest_mm(indenter.size_mm, indenter.edge_radius_mm)


def sharpest_mm(indenter: Indenter) -> float:
    """Least radius of curvature of an indenter that is no mesh, without its texture [mm]."""
    return indenter.record.sharpest_mm(indenter.size_mm, indenter.edge_radius_mm)
