"""What holds exactly: equilibrium of uniform strain, objectivity, mirrors.

Patch test: in a uniformly deformed solid no interior node feels a force. Objectivity: a solid that
is only turned feels none anywhere. Both are asked of the single-precision kernel and of its
double-precision twin, on a block without bond or contact.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from sim.contact.engine import reference
from sim.contact.engine.batch import Case
from sim.contact.engine.relaxation import Relaxation
from sim.contact.grid.stencil import gradient_table
from sim.contact.motion.approach import plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.readout.problem import prepare
from sim.contact.region.domain import Domain, stencil_nodes
from sim.contact.studies import specimens
from sim.contact.studies.finger import at_45_degrees, press_finger
from sim.material import elastic_solid, first_piola
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Press
from workbench.core.result.results import Label

MATERIAL = Elastomer(backing_MPa=0.0)
GRID_MM = 0.5
WIDTH_MM = 4.0
HEIGHT_MM = 4.0
STRETCH = np.array([[0.1, 0.05, 0.0], [-0.02, -0.08, 0.03], [0.0, 0.04, 0.12]])
"""Displacement gradient of the patch test: stretch, shear and spin of about 10 %."""
TURN_DEG = 30.0
TURN_AXIS = np.array([1.0, 2.0, 2.0]) / 3.0
CLEAR = 1.6
"""Cells between an interior node and the nearest face: its 27 cells are then full."""
TOLERANCE = 1e-4
"""Residual to which mirrored presses settle: their own difference is ten times less."""


@dataclasses.dataclass(frozen=True, kw_only=True, slots=True)
class NodalForces:
    """Forces on the nodes of a block at a prescribed displacement [N], shape (N, 3)."""

    kernel_N: np.ndarray
    twin_N: np.ndarray
    cell_N: float
    """Largest force of one cell on one node: what cancels in an interior node."""
    interior: np.ndarray
    """Nodes whose cells are all full, shape (N,), bool."""


def patch_forces() -> NodalForces:
    """Forces under the uniform displacement gradient `STRETCH`."""
    return _forces(STRETCH)


def turned_forces() -> NodalForces:
    """Forces after a turn by `TURN_DEG` about `TURN_AXIS` through the middle of the block."""
    angle = math.radians(TURN_DEG)
    x, y, z = TURN_AXIS
    spin = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return _forces(math.sin(angle) * spin + (1.0 - math.cos(angle)) * spin @ spin)


def _forces(gradient: np.ndarray) -> NodalForces:
    domain, relaxation = _free_block()
    centre = np.array([0.0, 0.0, 0.5 * HEIGHT_MM]) - domain.target_mm
    displacement = (domain.node_mm - centre) @ gradient.T
    relaxation.restart(0, displacement)
    relaxation.evaluate(np.ones(1, bool))
    slopes = gradient_table() / domain.grid_mm
    at_points = np.einsum("anr,pnc->aprc", displacement[stencil_nodes(domain.rows)], slopes)
    stress = first_piola(at_points, elastic_solid(MATERIAL))
    cells = np.einsum("ap,aprc,pnc->anr", domain.volumes_mm3, stress, slopes)
    return NodalForces(
        kernel_N=relaxation.node_forces().astype(np.float64),
        twin_N=reference.stress_forces(domain, displacement),
        cell_N=float(np.linalg.norm(cells, axis=2).max()),
        interior=_interior(domain),
    )


def _free_block() -> tuple[Domain, Relaxation]:
    """A block over air and its relaxation, with the ball far away."""
    mesh, points = specimens.flat_block(width_mm=WIDTH_MM, height_mm=HEIGHT_MM, grid_mm=GRID_MM)
    labels = np.full(len(mesh.inner.faces), Label.INNER | Label.BACKED, dtype=np.uint8)
    inner = dataclasses.replace(mesh.inner, labels=labels)
    mesh = dataclasses.replace(mesh, inner=inner, backing_mm=1.0)
    collider = make_collider(Indenter(), grid_mm=GRID_MM)
    press = Press(target_mm=(0.0, 0.0, HEIGHT_MM), depth_mm=0.2, frames=1)
    approach = plan_approach(mesh.outer, collider, press)
    domain = prepare(mesh, points, MATERIAL, approach, ContactSettings(), radius_mm=3.0 * WIDTH_MM)
    relaxation = Relaxation([Case(domain=domain, collider=collider, friction=0.0)])
    away_mm = approach.target_mm + 100.0 * approach.normal
    pose = np.concatenate([away_mm, np.eye(3).ravel(), [1.0]])
    relaxation.set_poses(0, pose[None])
    return domain, relaxation


def _interior(domain: Domain) -> np.ndarray:
    place = domain.node_mm + domain.target_mm
    clear_mm = CLEAR * domain.grid_mm
    aside = np.abs(place[:, :2]).max(axis=1) < 0.5 * WIDTH_MM - clear_mm
    return aside & (np.abs(place[:, 2] - 0.5 * HEIGHT_MM) < 0.5 * HEIGHT_MM - clear_mm)


def mirror_error(*, active_radius_mm: float = 9.0) -> float:
    """Difference of the forces of a press and its mirror image in x, over the force."""
    settings = ContactSettings(active_radius_mm=active_radius_mm, tolerance=TOLERANCE)
    ahead, behind = (
        press_finger(at_45_degrees(azimuth_deg=azimuth_deg), settings=settings).reaction_N[-1]
        for azimuth_deg in (0.0, 180.0)
    )
    return float(np.linalg.norm(ahead * [-1.0, 1.0, 1.0] - behind) / np.linalg.norm(ahead))
