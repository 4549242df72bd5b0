"""What one settled frame of a press says."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sim.contact.objects.collider import Collider


@dataclass(frozen=True, kw_only=True, slots=True)
class FrameOutcome:
    """One frame of `Contact`; the fields have the same names and units."""

    displacement_mm: np.ndarray
    inner_mm: np.ndarray
    reaction_N: np.ndarray
    moment_Nmm: np.ndarray
    indenter_pose: np.ndarray
    residual: float
    penetration_mm: float
    support_N: np.ndarray
    support_moment_Nmm: np.ndarray
    cut_N: np.ndarray
    actuator_N: np.ndarray
    actuator_moment_Nmm: np.ndarray
    friction_ratio: float
    contact_force_N: np.ndarray
    pressure_MPa: np.ndarray
    tangential_N: float
    pressing_N: float
    cauchy_MPa: np.ndarray
    energy_MPa: np.ndarray
    strain_energy_Nmm: float
    kinetic_ratio: float
    least_volume_ratio: float
    frame_seconds: float
    # What slid is known once the frame is closed (`slipping`).
    sliding: np.ndarray = field(default_factory=lambda: np.zeros(0, bool))
    sliding_share: float = 0.0
    slip_mm: np.ndarray = field(default_factory=lambda: np.zeros(0, np.float32))


def deepest_overlap_mm(
    places_mm: np.ndarray, collider: Collider, origin: np.ndarray, rotation: np.ndarray
) -> float:
    """How deep the deepest of some places, (N, 3), lies inside the object [mm]; 0 if none."""
    body = places_mm - origin
    body = body[np.einsum("nc,nc->n", body, body) < collider.reach_mm**2]
    distance, _ = collider.distance(body @ rotation)
    return -float(distance.min(initial=0.0))
