"""What a converged state says about the skin: forces, pressure, stress, slip and balance.

Stress and energy are found at the Gauss points, carried to the corners of each element by its own
trilinear field, and averaged over the elements that meet there by their volume.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.readout.fields import VOIGT
from sim.fem.balance import LEAST_MM2, Balance
from sim.fem.elements import CORNERS, Elements, displacement_gradient
from sim.fem.increment import Pairing, State, slid_since
from sim.fem.newton import Effort
from sim.fem.submodel import Submodel
from sim.forces.slip import MOST_OF_IT, Slip
from sim.material import energy_density_MPa
from workbench.core.base.frames import quaternion
from workbench.core.result.results import MembraneMesh

LEAST = 1e-300
LEAST_PRESSURE_SHARE = 1e-3
"""Points that carry less than this share of the largest normal traction have no friction ratio."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FemFrame:
    """One frame of `ForceField`; the fields have the same names and units."""

    displacement_mm: np.ndarray
    inner_mm: np.ndarray
    contact_force_N: np.ndarray
    reaction_N: np.ndarray
    moment_Nmm: np.ndarray
    indenter_pose: np.ndarray
    residual: float
    balance: float
    converged: bool
    pressure_MPa: np.ndarray
    cauchy_MPa: np.ndarray
    energy_MPa: np.ndarray
    sliding: np.ndarray
    sliding_share: float
    slip_mm: np.ndarray
    support_N: np.ndarray
    cut_N: np.ndarray
    actuator_N: np.ndarray
    penetration_mm: float
    friction_ratio: float
    least_volume_ratio: float
    increments: int
    steps: int
    frame_seconds: float


def read_frame(
    mesh: MembraneMesh,
    submodel: Submodel,
    pairing: Pairing,
    state: State,
    before: State,
    effort: Effort,
) -> FemFrame:
    """Read a state at the end of a frame.

    Args:
        mesh: The membrane.
        submodel: The part that took part.
        pairing: Object and path.
        state: A converged state.
        before: The state at the end of the frame before, for what slid in this one.
        effort: What the frame took.
    """
    # Reading takes a while too, which is none of the solution's.
    seconds = effort.seconds
    body, forces = submodel.body, state.balance
    assert forces is not None
    pose = pairing.pose_at(state.progress)
    place_mm = body.points_mm + state.displacement_mm
    moved_mm = submodel.division.followed(state.displacement_mm)
    marks, whole = submodel.marks, submodel.on_whole
    moment_Nmm = -np.cross(place_mm - pose.origin_mm, forces.contact_N).sum(axis=0)
    holding_N = forces.internal_N - forces.contact_N - forces.gel_N
    held = _held_forces(submodel, holding_N, forces)
    contact_N = forces.contact_N.sum(axis=0)
    missing_N = contact_N + held[0] + held[1] + held[2].sum(axis=0)
    # After a release nothing is left but rounding, which is not out of balance.
    least_N = LEAST_MM2 * body.young_MPa
    load_N = max(float(np.linalg.norm(contact_N)), float(np.abs(holding_N).max()), least_N)
    cauchy, energy, least = _stress(body.elements, state.displacement_mm, len(place_mm))
    slip = slid_since(pairing, before, state.progress, forces)
    pressure, slid_mm, sliding = _contact_state(submodel, state, slip, forces)
    count = len(mesh.outer.points_mm)
    return FemFrame(
        displacement_mm=_on_skin(marks.outer, moved_mm, count),
        inner_mm=_on_skin(marks.inner, moved_mm, len(mesh.inner.points_mm)),
        contact_force_N=_on_skin(marks.outer, whole(forces.contact_N), count),
        reaction_N=-contact_N,
        moment_Nmm=moment_Nmm,
        indenter_pose=np.concatenate([pose.origin_mm, quaternion(pose.rotation)]),
        residual=forces.relative,
        balance=float(np.linalg.norm(missing_N)) / load_N,
        converged=forces.relative <= pairing.tolerance,
        pressure_MPa=_on_skin(marks.outer, pressure, count),
        cauchy_MPa=_on_skin(marks.outer, cauchy, count),
        energy_MPa=_on_skin(marks.outer, energy, count),
        sliding=_on_skin(marks.outer, sliding, count) > MOST_OF_IT,
        sliding_share=slip.share(body.faces.areas_mm2.ravel()),
        slip_mm=_on_skin(marks.outer, slid_mm, count),
        support_N=held[0],
        cut_N=held[1],
        actuator_N=held[2],
        penetration_mm=-float(forces.distance_mm.min(initial=0.0)),
        friction_ratio=_friction_ratio(forces),
        least_volume_ratio=least,
        increments=effort.increments,
        steps=effort.steps,
        frame_seconds=seconds,
    )


def _on_skin(vertices: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """Values of nodes at the vertices they are; vertices that took no part have 0."""
    found = np.zeros((count, *values.shape[1:]), np.float32)
    members = np.flatnonzero(vertices >= 0)
    found[vertices[members]] = values[members]
    return found


def _held_forces(
    submodel: Submodel, holding_N: np.ndarray, forces: Balance
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Forces of the support (gel included), of elastomer cut off, and of each drive (A, 3) [N]."""
    body = submodel.body
    driven = np.array(
        [holding_N[submodel.marks.drive == number].sum(axis=0) for number in range(submodel.drives)]
    ).reshape(-1, 3)
    cut_N = holding_N[submodel.marks.cut & (submodel.marks.drive < 0)].sum(axis=0)
    bonded = body.held & ~submodel.marks.cut & (submodel.marks.drive < 0)
    return holding_N[bonded].sum(axis=0) + forces.gel_N.sum(axis=0), cut_N, driven


def _contact_state(
    submodel: Submodel, state: State, slip: Slip, forces: Balance
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pressure [MPa], way slid [mm] and share of the touching area around it that slides, at each
    node, each of shape (N,)."""
    faces = submodel.body.faces
    size = len(submodel.body.points_mm)

    def summed(values: np.ndarray) -> np.ndarray:
        """Integral of values at the points, (Q P,), by node of the undivided mesh, (W,)."""
        by_corner = faces.shares(values.reshape(faces.areas_mm2.shape))
        return submodel.on_whole(np.bincount(faces.nodes.ravel(), by_corner.ravel(), size))

    normal = np.zeros(faces.areas_mm2.size)
    normal[forces.members] = forces.traction.lag.pressure_MPa
    touching = np.zeros(faces.areas_mm2.size)
    touching[forces.members] = normal[forces.members] > 0.0

    def mean(values: np.ndarray, weights: np.ndarray) -> np.ndarray:
        return summed(values * weights) / np.maximum(summed(weights), LEAST)

    pressed_N, area = summed(normal), summed(np.ones_like(normal))
    sliding = mean(slip.sliding, slip.stayed.astype(float))
    return pressed_N / np.maximum(area, LEAST), mean(state.slid_mm, touching), sliding


def _friction_ratio(forces: Balance) -> float:
    """Largest tangential over normal traction of the points that carry load."""
    pull = forces.traction
    normal = np.linalg.norm(pull.normal_MPa, axis=1)
    pressed = normal > LEAST_PRESSURE_SHARE * normal.max(initial=0.0)
    ratio = np.linalg.norm(pull.friction_MPa[pressed], axis=1) / np.maximum(normal[pressed], LEAST)
    return float(ratio.max(initial=0.0))


def _stress(
    elements: Elements, displacement_mm: np.ndarray, size: int
) -> tuple[np.ndarray, np.ndarray, float]:
    """Cauchy stress (N, 6) and energy density (N,) at the nodes [MPa], and the least J."""
    gradient = displacement_gradient(elements, displacement_mm)
    stress, energy, ratio = _point_stress(elements, gradient)
    values = np.concatenate([stress, energy[..., None]], axis=-1)
    corner = _to_corners() @ values
    weight = elements.volume_mm3[:, None] * elements.owns
    below = np.bincount(elements.cells.ravel(), weight.ravel(), size)
    found = (
        np.stack(
            [
                np.bincount(elements.cells.ravel(), (weight * corner[..., k]).ravel(), size)
                for k in range(7)
            ],
            axis=1,
        )
        / np.maximum(below, LEAST)[:, None]
    )
    return found[:, :6], found[:, 6], float(ratio.min(initial=1.0))


def _point_stress(
    elements: Elements, gradient: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cauchy stress (M, 8, 6), energy density (M, 8) and J (M, 8) at the Gauss points.

    sigma = (mu / J^(5/3)) dev(F F^T) + K (v / V - 1) I, with the mean dilatation of the element.
    """
    shear, bulk = elements.shear_MPa[:, None], elements.bulk_MPa[:, None]
    weight = elements.weights_mm3
    volume = weight.sum(axis=1, keepdims=True)
    eye = np.eye(3)
    if elements.linear:
        strain = 0.5 * (gradient + np.swapaxes(gradient, -1, -2))
        trace = np.trace(strain, axis1=-2, axis2=-1)
        ratio = 1.0 + trace
        dilation = (weight * trace).sum(axis=1, keepdims=True) / volume
        shifted = 2.0 * shear[..., None, None] * (strain - (trace / 3.0)[..., None, None] * eye)
    else:
        deformation = gradient + eye
        ratio = np.linalg.det(deformation)
        dilation = (weight * ratio).sum(axis=1, keepdims=True) / volume - 1.0
        left = deformation @ np.swapaxes(deformation, -1, -2)
        trace = np.trace(left, axis1=-2, axis2=-1)
        scale = (shear * ratio ** (-5.0 / 3.0))[..., None, None]
        shifted = scale * (left - (trace / 3.0)[..., None, None] * eye)
    cauchy = shifted + (bulk * dilation)[..., None, None] * eye
    # Energy of changes of volume is that of the element's mean, as in its forces.
    energy = energy_density_MPa(gradient, shear, 0.0, linear=elements.linear)
    energy = energy + 0.5 * bulk * dilation**2
    return np.stack([cauchy[..., r, c] for r, c in VOIGT], axis=-1), energy, ratio


def _to_corners() -> np.ndarray:
    """Weights of the Gauss points at the corners of an element, shape (8, 8): they lie inside, so
    their trilinear field is continued outward by sqrt 3."""
    places = CORNERS * 3.0**0.5
    return np.prod(1.0 + places[:, None, :] * CORNERS[None, :, :], axis=2) / 8.0
