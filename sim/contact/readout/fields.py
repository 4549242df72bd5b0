"""Stress, strain energy and volume ratio of a displacement, on the skin and in the volume.

Cauchy stress sigma = P F^T / J with the first Piola-Kirchhoff stress of `sim.material`; Hooke's law
does not tell the two apart. On the skin the gradient is that of the B-splines at the vertex.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.grid.stencil import gradient_table
from sim.contact.region.domain import Domain, stencil_nodes
from sim.material import energy_density_MPa, stress_of

VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
"""Components of a stress in the order of `Contact.cauchy_MPa`."""
LEAST_FILLED = 0.1
"""Filled fraction below which a point is fringe, whose J says nothing."""
LEAST_MOVE = 1e-4
"""Cells with no node moved by this share of the largest displacement are taken to be at rest."""


@dataclass(frozen=True, kw_only=True, slots=True)
class VolumeState:
    """The active region as a whole."""

    least_volume_ratio: float
    """Least J = det F over the points with at least a tenth of their volume filled."""
    strain_energy_Nmm: float


def volume_state(domain: Domain, nodal_mm: np.ndarray) -> VolumeState:
    """Volume ratio and strain energy of a nodal displacement, shape (N, 3)."""
    nodes = stencil_nodes(domain.rows)
    size_mm = np.abs(nodal_mm).max(axis=1)
    moved = (size_mm > LEAST_MOVE * size_mm.max(initial=0.0))[nodes].any(axis=1)
    volumes, moduli = domain.volumes_mm3[moved], domain.moduli_MPa[moved]
    slopes = gradient_table().transpose(1, 0, 2).reshape(27, 24)
    edges_mm = domain.edges_mm[moved, None]
    nodal = nodal_mm[nodes[moved]].transpose(0, 2, 1).reshape(-1, 27)
    gradient = (nodal @ slopes).reshape(-1, 3, 8, 3).transpose(0, 2, 1, 3)
    gradient = gradient / edges_mm[:, :, None, None]
    shear, bulk = moduli[:, :1], moduli[:, 1:]
    energy = energy_density_MPa(gradient, shear, bulk, linear=domain.linear)
    filled = volumes >= LEAST_FILLED * edges_mm**3 / 8.0
    ratio = np.linalg.det(gradient[filled] + np.eye(3))
    return VolumeState(
        least_volume_ratio=float(ratio.min(initial=1.0)),
        strain_energy_Nmm=float((volumes * energy).sum()),
    )


def skin_stress(domain: Domain, nodal_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cauchy stress (V, 6) and strain energy density (V,) at the outer vertices [MPa], float32.

    Args:
        domain: The active region; vertices outside it are free of stress.
        nodal_mm: Nodal displacement, shape (N, 3).
    """
    readout = domain.outer
    stress = np.zeros((readout.count, 6), np.float32)
    energy = np.zeros(readout.count, np.float32)
    gradient = readout.gradient(nodal_mm)
    shear, bulk = domain.moduli_MPa[readout.cells].T
    piola = stress_of(gradient, shear, bulk, linear=domain.linear)
    if domain.linear:
        cauchy = piola
    else:
        deformation = gradient + np.eye(3)
        ratio = np.linalg.det(deformation)[:, None, None]
        cauchy = piola @ np.swapaxes(deformation, 1, 2) / ratio
    stress[readout.vertices] = np.stack([cauchy[:, r, c] for r, c in VOIGT], axis=1)
    energy[readout.vertices] = energy_density_MPa(gradient, shear, bulk, linear=domain.linear)
    return stress, energy
