"""Eight-node hexahedra with mean dilatation (Q1P0): energy, nodal forces and tangent.

The volume ratio is averaged over an element, so nearly incompressible elastomers do not lock:

    W_e = sum_q w_q (mu / 2) (J_q^(-2/3) tr(F_q^T F_q) - 3) + V (K / 2) (v / V - 1)^2,

V and v the volumes of the element at rest and deformed, q the 2x2x2 Gauss points. The pressure
p = K (v / V - 1) follows from v, and the tangent is the exact derivative of the forces. Sources:
Nagtegaal, Parks and Rice (1974) for mean dilatation; the law is that of `sim.material`, and of
SimTac's Supplementary with C10 = mu / 2, D1 = 2 / K.
Hooke's law (`linear`) drops all products of displacements, which makes it B-bar. All is plain NumPy
over chunks of elements that fit the cache.
"""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import dataclass

import numpy as np

from sim.fem.stiffness import Moduli, stiffness
from workbench.core.base.errors import MeshingError

CORNERS = np.array(
    [[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))], dtype=np.float64
)
"""Corners of the parent cube in VTK order."""
GAUSS = CORNERS / 3.0**0.5
"""2x2x2 Gauss points, of weight 1."""
LEAST_RATIO = 1e-3
"""J at a Gauss point below which an element counts as inverted."""
CHUNK = 256
"""Elements at once: 256 x 24 x 24 tangents are 1.2 MB."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Elements:
    """Hexahedra at rest."""

    cells: np.ndarray
    """Node numbers, shape (M, 8), int64, VTK order."""
    owns: np.ndarray
    """Whether each node is a corner of the element, (M, 8), bool; where a corner hangs it moves
    with other nodes (`division`)."""
    slopes: np.ndarray
    """dN_a / dX_J at the Gauss points [1/mm], shape (M, 8 nodes, 8 points, 3)."""
    weights_mm3: np.ndarray
    """Volume of each Gauss point, shape (M, 8)."""
    shear_MPa: np.ndarray
    """mu of each element, shape (M,)."""
    bulk_MPa: np.ndarray
    """K of each element, shape (M,)."""
    linear: bool = False
    """Hooke's law instead of the neo-Hookean one."""

    def take(self, part: slice) -> Elements:
        """Some of the elements."""
        names = ("cells", "owns", "slopes", "weights_mm3", "shear_MPa", "bulk_MPa")
        return dataclasses.replace(self, **{name: getattr(self, name)[part] for name in names})

    @property
    def volume_mm3(self) -> np.ndarray:
        """Volume of each element at rest, shape (M,)."""
        return self.weights_mm3.sum(axis=1)


@dataclass(frozen=True, kw_only=True, slots=True)
class ElementState:
    """What elements say about a displacement."""

    energy_Nmm: float
    """Strain energy; inf where an element is inverted."""
    force_N: np.ndarray
    """Internal nodal forces of each element, shape (M, 24)."""
    tangent_N_mm: np.ndarray | None
    """Their derivative by the nodal displacements, shape (L, 24, 24), symmetric; of the first L
    elements, as many as were asked for."""


def make_elements(
    points_mm: np.ndarray,
    cells: np.ndarray,
    *,
    shear_MPa: np.ndarray | float,
    bulk_MPa: np.ndarray | float,
    linear: bool = False,
) -> Elements:
    """Hexahedra of a mesh.

    Args:
        points_mm: Nodes, shape (N, 3).
        cells: Node numbers, shape (M, 8), VTK order.
        shear_MPa: mu, one or one per element.
        bulk_MPa: K, one or one per element.
        linear: Whether Hooke's law is meant.

    Raises:
        MeshingError: If an element is inverted at rest.
    """
    cells = np.ascontiguousarray(cells, dtype=np.int64)
    parent = np.stack([_parent_slopes(place) for place in GAUSS])
    jacobian = np.einsum("mai,qaj->mqij", points_mm[cells], parent)
    weights_mm3 = np.linalg.det(jacobian)
    if len(cells) and weights_mm3.min() <= 0.0:
        bad = int(np.argmin(weights_mm3.min(axis=1)))
        raise MeshingError(
            f"hexahedron {bad} of {len(cells)} is inverted",
            hint="lower meshing.hex_mm",
            at="meshing.hex_mm",
        )
    slopes = np.einsum("qaj,mqji->maqi", parent, np.linalg.inv(jacobian))
    count = len(cells)
    return Elements(
        cells=cells,
        owns=np.ones(cells.shape, dtype=bool),
        slopes=np.ascontiguousarray(slopes),
        weights_mm3=weights_mm3,
        shear_MPa=np.broadcast_to(np.asarray(shear_MPa, np.float64), count).copy(),
        bulk_MPa=np.broadcast_to(np.asarray(bulk_MPa, np.float64), count).copy(),
        linear=linear,
    )


def _parent_slopes(place: np.ndarray) -> np.ndarray:
    """dN_a / dxi_j of the eight shape functions at a place of the parent cube, shape (8, 3)."""
    factors = 1.0 + CORNERS * place
    return np.stack(
        [CORNERS[:, j] * factors[:, j - 2] * factors[:, j - 1] / 8.0 for j in range(3)], axis=1
    )


def evaluate(
    elements: Elements,
    displacement_mm: np.ndarray,
    *,
    tangent: bool = False,
    leading: int | None = None,
    known: ElementState | None = None,
) -> ElementState:
    """Energy and forces at nodal displacements.

    Args:
        elements: At rest.
        displacement_mm: Of all nodes, shape (N, 3).
        tangent: Whether stiffnesses are wanted too.
        leading: Of the first so many elements only; None: of all.
        known: Energy and forces where they were found at this displacement before; only
            stiffnesses are found then.
    """
    count = len(elements.cells)
    wanted = (count if leading is None else leading) if tangent else 0
    last = wanted if known is not None else count
    forces = np.zeros((last, 24))
    tangents = np.zeros((wanted, 24, 24)) if tangent else None
    energy = 0.0
    law = _linear_chunk if elements.linear else _neo_hookean_chunk
    edges = sorted({*range(0, wanted, CHUNK), *range(wanted, last, CHUNK), last})
    for begin, end in itertools.pairwise(edges):
        part = slice(begin, end)
        block = tangents[part] if tangents is not None and end <= wanted else None
        energy += law(elements, displacement_mm, part, forces[part], block)
        if not np.isfinite(energy):
            break
    if known is not None:
        energy, forces = known.energy_Nmm, known.force_N
    return ElementState(energy_Nmm=energy, force_N=forces, tangent_N_mm=tangents)


def displacement_gradient(
    elements: Elements, displacement_mm: np.ndarray, part: slice = slice(None)
) -> np.ndarray:
    """H = du/dX at the Gauss points, shape (M, 8, 3, 3)."""
    nodal = displacement_mm[elements.cells[part]]
    slopes = elements.slopes[part]
    flat = np.swapaxes(nodal, 1, 2) @ slopes.reshape(len(slopes), 8, 24)
    return flat.reshape(-1, 3, 8, 3).transpose(0, 2, 1, 3)


def _neo_hookean_chunk(
    elements: Elements,
    displacement_mm: np.ndarray,
    part: slice,
    force: np.ndarray,
    tangent: np.ndarray | None,
) -> float:
    weight = elements.weights_mm3[part]
    mu, bulk = elements.shear_MPa[part, None], elements.bulk_MPa[part]
    # By component, (3, 3, M, 8): NumPy is quick along long rows only.
    deformation = _by_component(displacement_gradient(elements, displacement_mm, part))
    for axis in range(3):
        deformation[axis, axis] += 1.0
    cofactor = _cofactors(deformation)
    ratio = (deformation[0] * cofactor[0]).sum(axis=0)
    if ratio.min(initial=1.0) <= LEAST_RATIO:
        return np.inf
    square = np.einsum("ijmq,ijmq->mq", deformation, deformation)
    volume = weight.sum(axis=1)
    dilation = (weight * ratio).sum(axis=1) / volume - 1.0
    pressure = bulk * dilation
    power = ratio ** (-2.0 / 3.0)
    scale = mu * power * weight
    along = pressure[:, None] * weight - scale * square / (3.0 * ratio)
    force[:] = _to_nodes(elements, part, _by_point(scale * deformation + along * cofactor))
    if tangent is not None:
        moduli = Moduli(
            scale_Nmm=scale,
            square=square,
            pressure_MPa=pressure,
            volumes_mm3=weight * ratio,
            bulk_N_mm5=bulk / volume,
        )
        inverse = _by_point(cofactor / ratio)
        stiffness(elements.slopes[part], _by_point(deformation), inverse, moduli, tangent)
    isochoric = 0.5 * mu * (square * power - 3.0) * weight
    return float(isochoric.sum() + (0.5 * bulk * volume * dilation**2).sum())


def _by_component(values: np.ndarray) -> np.ndarray:
    """Matrices at points, (M, 8, 3, 3), as (3, 3, M, 8)."""
    return np.ascontiguousarray(values.transpose(2, 3, 0, 1))


def _by_point(values: np.ndarray) -> np.ndarray:
    """Matrices by component, (3, 3, M, 8), as (M, 8, 3, 3)."""
    return values.transpose(2, 3, 0, 1)


def _linear_chunk(
    elements: Elements,
    displacement_mm: np.ndarray,
    part: slice,
    force: np.ndarray,
    tangent: np.ndarray | None,
) -> float:
    weight = elements.weights_mm3[part]
    mu, bulk = elements.shear_MPa[part, None], elements.bulk_MPa[part]
    gradient = displacement_gradient(elements, displacement_mm, part)
    strain = 0.5 * (gradient + np.swapaxes(gradient, -1, -2))
    trace = np.trace(strain, axis1=-2, axis2=-1)
    volume = weight.sum(axis=1)
    dilation = (weight * trace).sum(axis=1) / volume
    deviator = strain - (trace / 3.0)[..., None, None] * np.eye(3)
    unit = np.broadcast_to(weight[..., None, None] * np.eye(3), strain.shape)
    growth = _to_nodes(elements, part, np.ascontiguousarray(unit))
    stress = (2.0 * mu * weight)[..., None, None] * deviator
    force[:] = _to_nodes(elements, part, stress) + (bulk * dilation)[:, None] * growth
    if tangent is not None:
        # At rest the neo-Hookean stiffness is Hooke's.
        rest = np.broadcast_to(np.eye(3), gradient.shape)
        moduli = Moduli(
            scale_Nmm=mu * weight,
            square=np.full(weight.shape, 3.0),
            pressure_MPa=np.zeros(len(weight)),
            volumes_mm3=weight,
            bulk_N_mm5=bulk / volume,
        )
        stiffness(elements.slopes[part], rest, rest, moduli, tangent)
    sheared = (mu * weight) * np.einsum("mqij,mqij->mq", deviator, deviator)
    return float(sheared.sum() + (0.5 * bulk * volume * dilation**2).sum())


def _cofactors(matrix: np.ndarray) -> np.ndarray:
    """J F^-T of matrices (3, 3, ...): the derivative of the determinant."""
    found = np.empty_like(matrix)
    for i in range(3):
        for j in range(3):
            r, t, c, d = i - 2, i - 1, j - 2, j - 1
            np.multiply(matrix[r, c], matrix[t, d], out=found[i, j])
            found[i, j] -= matrix[r, d] * matrix[t, c]
    return found


def _to_nodes(elements: Elements, part: slice, stress: np.ndarray) -> np.ndarray:
    """Nodal forces sum_q dN_a/dX_J P_iJ of weighted stresses (M, 8, 3, 3), shape (M, 24)."""
    slopes = elements.slopes[part]
    by_slope = np.swapaxes(stress, -1, -2).reshape(len(slopes), 24, 3)
    return (slopes.reshape(len(slopes), 8, 24) @ by_slope).reshape(-1, 24)
