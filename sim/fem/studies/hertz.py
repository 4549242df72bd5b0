"""A ball on a half-space, by finite elements on a quarter of a block, beside Hertz's solution.

    F = 4 E R^(1/2) d^(3/2) / (3 (1 - nu^2)),    a = (R d)^(1/2),    p = p0 (1 - r^2 / a^2)^(1/2).

Cells grow from the contact outwards. The far sides of the block are moved as Boussinesq's point
load of Hertz's force moves the half-space there, so that the half-space goes on beyond them; a
clamped block sixty contact radii wide and deep would push 1.2 % harder. The planes of symmetry are
stiff springs along their normal. Source: Johnson, Contact Mechanics, 1985, sections 3.2 and 4.2.
Left out: friction; finite strain, unless a neo-Hookean law is asked for.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from sim.contact.objects.collider import make_collider
from sim.fem.body import Body, Faces, make_faces
from sim.fem.contact_law import PENALTY
from sim.fem.contact_law import Law as Pair
from sim.fem.elements import make_elements
from sim.fem.increment import Pairing, State, advance, at_rest
from sim.fem.newton import Effort
from sim.fem.obstacle import RigidPose
from sim.fem.studies.blocks import block, graded
from sim.fem.submodel import boundary
from sim.fem.tangent import Tangent
from sim.material import elastic_solid
from workbench.core.design.design import Elastomer, Law
from workbench.core.press.indenter import Indenter

RADIUS_MM = 10.0
CONTACT_MM = 1.0
"""a: a tenth of the ball's radius, a strain of some 3 %."""
DEPTH_MM = CONTACT_MM**2 / RADIUS_MM
WIDE = 24.0
"""Width and depth of the block over a: there the load's spread is 1e-3 of its point's field."""
FINE = 1.35
"""Width and depth over a of the cells that are all of one size."""
GROWTH = 1.4
SYMMETRY_PER_MM = 1e3
"""Springs of the planes of symmetry, over Young's modulus [1/mm]: a thousandth of a cell's own."""
TOLERANCE = 1e-7


@dataclass(frozen=True, kw_only=True, slots=True)
class HertzPress:
    """A solved ball."""

    force_N: float
    """Of the whole ball."""
    radius_mm: float
    """Of the circle with the area of the contact points that carry pressure."""
    moment_radius_mm: float
    """sqrt(5/2 <r^2>) of the pressure."""
    off_axis_mm: float
    """Largest way of a node out of its plane of symmetry."""
    edge_mm: float
    cells: int


def exact_force_N(material: Elastomer) -> float:
    """Hertz's force [N]."""
    modulus = material.young_MPa / (1.0 - material.poisson**2)
    return 4.0 / 3.0 * modulus * math.sqrt(RADIUS_MM) * DEPTH_MM**1.5


def flat_punch_N(material: Elastomer) -> float:
    """Force of a flat punch of the contact's radius at the same depth: 2 a E d / (1 - nu^2)."""
    return 2.0 * CONTACT_MM * DEPTH_MM * material.young_MPa / (1.0 - material.poisson**2)


def overlap_radius_mm() -> float:
    """Radius at which the undeformed plane cuts the ball: contact without deformation around it."""
    return math.sqrt(2.0 * RADIUS_MM * DEPTH_MM - DEPTH_MM**2)


def point_load_mm(points_mm: np.ndarray, material: Elastomer) -> np.ndarray:
    """Displacement (N, 3) of a half-space z <= 0 by Hertz's force at the origin, Boussinesq.

    With G = mu, depth s = -z and R = |x|: u_r = F / (4 pi G) (r s / R^3 - (1 - 2 nu) r / (R (R +
    s))), inward motion F / (4 pi G) (s^2 / R^3 + 2 (1 - nu) / R). The origin itself has no answer.
    """
    aside, depth = points_mm[:, :2], -points_mm[:, 2:]
    away = np.maximum(np.linalg.norm(points_mm, axis=1, keepdims=True), 1e-9)
    nu = material.poisson
    scale = exact_force_N(material) / (4.0 * math.pi * elastic_solid(material).shear_MPa)
    sideways = aside * (depth / away**3 - (1.0 - 2.0 * nu) / (away * (away + depth)))
    inward = depth**2 / away**3 + 2.0 * (1.0 - nu) / away
    return scale * np.concatenate([sideways, -inward], axis=1)


@functools.cache
def press_ball(cells_per_radius: float, *, law: Law = Law.LINEAR) -> HertzPress:
    """Press the ball on a block with cells of a / `cells_per_radius`, without friction."""
    material = Elastomer(law=law, friction=0.0)
    body = quarter_block(CONTACT_MM / cells_per_radius, material)
    state = _pressed(body, material)
    return _read(body, state, CONTACT_MM / cells_per_radius)


def quarter_block(edge_mm: float, material: Elastomer) -> Body:
    """A quarter of the block: x >= 0, y >= 0, z <= 0."""
    solid = elastic_solid(material)
    far_mm = WIDE * CONTACT_MM
    axis = graded(FINE * CONTACT_MM, edge_mm, far_mm, GROWTH)
    points_mm, cells = block(axis, axis, -axis[::-1])
    quads = boundary(cells)
    on_top = (points_mm[quads][..., 2] == 0.0).all(axis=1)
    near = np.linalg.norm(points_mm[quads][..., :2], axis=2).max(axis=1) < 4.0 * CONTACT_MM
    springs, stiffness = _symmetry(points_mm, quads, SYMMETRY_PER_MM * material.young_MPa)
    return Body(
        points_mm=points_mm,
        elements=make_elements(
            points_mm,
            cells,
            shear_MPa=solid.shear_MPa,
            bulk_MPa=solid.bulk_MPa,
            linear=solid.linear,
        ),
        near=len(cells),
        faces=make_faces(points_mm, quads[on_top & near]),
        held=np.abs(points_mm).max(axis=1) == far_mm,
        driven=np.zeros(len(points_mm), dtype=bool),
        springs=springs,
        spring_N_mm=stiffness,
        young_MPa=material.young_MPa,
    )


def _symmetry(
    points_mm: np.ndarray, quads: np.ndarray, spring_N_mm3: float
) -> tuple[Faces, np.ndarray]:
    """Faces on the planes x = 0 and y = 0, and springs that hold them there."""
    chosen, moduli = [], []
    for axis in range(2):
        side = quads[(points_mm[quads][..., axis] == 0.0).all(axis=1)]
        chosen.append(side)
        moduli += [np.diag(spring_N_mm3 * np.eye(3)[axis])] * len(side)
    faces = make_faces(points_mm, np.concatenate(chosen))
    spread = np.repeat(np.array(moduli)[:, None], faces.areas_mm2.shape[1], axis=1)
    return faces, faces.stiffness(spread)


def _pressed(body: Body, material: Elastomer) -> State:
    """The ball `DEPTH_MM` deep, in one increment."""

    def pose_at(progress: float) -> RigidPose:
        height_mm = RADIUS_MM - progress * DEPTH_MM
        return RigidPose(origin_mm=np.array([0.0, 0.0, height_mm]), rotation=np.eye(3))

    far_mm = np.where(body.held[:, None], point_load_mm(body.points_mm, material), 0.0)
    tangent = Tangent(body)
    pairing = Pairing(
        tangent=tangent,
        law=Pair(penalty_MPa_mm=PENALTY * material.young_MPa, friction=0.0),
        collider=make_collider(Indenter(size_mm=2.0 * RADIUS_MM), grid_mm=1.0),
        pose_at=pose_at,
        held_mm=lambda progress: progress**1.5 * far_mm,
        tolerance=TOLERANCE,
    )
    try:
        return advance(pairing, at_rest(pairing), 1.0, Effort())
    finally:
        tangent.close()


def _read(body: Body, state: State, edge_mm: float) -> HertzPress:
    """Four quarters."""
    forces = state.balance
    assert forces is not None
    areas_mm2 = body.faces.areas_mm2.ravel()[forces.members]
    carried_N = forces.traction.lag.pressure_MPa * areas_mm2
    square_mm2 = np.square(forces.places_mm[forces.members, :2]).sum(axis=1)
    mean_mm2 = float(carried_N @ square_mm2) / float(carried_N.sum())
    planes = body.points_mm[:, :2] == 0.0
    return HertzPress(
        force_N=-4.0 * float(forces.contact_N[:, 2].sum()),
        radius_mm=math.sqrt(4.0 * float(areas_mm2.sum()) / math.pi),
        moment_radius_mm=math.sqrt(2.5 * mean_mm2),
        off_axis_mm=float(np.abs(state.displacement_mm[:, :2][planes]).max()),
        edge_mm=edge_mm,
        cells=len(body.elements.cells),
    )
