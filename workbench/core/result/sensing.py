"""What the stages of pressing and looking return: contact, light, images and their metrics.

Sensor frame; mm, N, MPa; float32 fields. V outer-surface vertices, N mesh nodes, K frames, L LEDs,
C grid cells.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


def _none(*shape: int) -> np.ndarray:
    return np.zeros(shape, dtype=np.float32)


@dataclass(frozen=True, kw_only=True, slots=True)
class Contact:
    """What the solver found, frame by frame. Forces act on the indenter, in the sensor frame."""

    displacement_mm: np.ndarray
    """Displacement of the outer skin's vertices [mm], shape (K, V, 3), float32."""
    reaction_N: np.ndarray
    """Force on the indenter [N], shape (K, 3), float64."""
    moment_Nmm: np.ndarray
    """Moment on the indenter about its own origin [N mm], shape (K, 3), float64."""
    indenter_pose: np.ndarray
    """x, y, z [mm], qw, qx, qy, qz of the indenter's body frame, shape (K, 7), float64."""
    residual: np.ndarray
    """Out-of-balance force over the load: reaction and drives, at least 2 % of their peak; (K,)."""
    penetration_mm: np.ndarray
    """Deepest overlap of skin and indenter [mm], shape (K,), float64."""
    support_N: np.ndarray
    """Force of the rigid support on the membrane [N], shape (K, 3), float64."""
    cut_N: np.ndarray
    """Force of elastomer left out of the region on the part that took part [N], shape (K, 3).

    reaction = support + cut + sum of actuators, to within the residual.
    """
    friction_ratio: np.ndarray
    """Largest pointwise tangential over normal contact force, shape (K,), float64."""
    sliding: np.ndarray
    """Outer vertices around which most of the contact slides (`sim.forces.slip`), (K, V), bool."""
    target_mm: np.ndarray
    """Target on the undeformed skin [mm], shape (3,), float64."""
    normal: np.ndarray
    """Outward unit normal there, shape (3,), float64."""
    tangent_u: np.ndarray
    """Unit U: +Z projected on the tangent plane, shape (3,), float64."""
    grid_mm: float
    active_radius_mm: float
    """Radius of the region that took part, about the target [mm]."""
    particles: int
    """Material points in the active region."""
    substeps: int
    """Relaxation steps of all frames together."""
    device: str
    inner_mm: np.ndarray = field(default_factory=lambda: np.zeros((0, 0, 3), dtype=np.float32))
    """Displacement of the inner skin's vertices [mm], shape (K, W, 3), float32; W = 0 where that
    skin is bonded and stays where it is."""
    contact_force_N: np.ndarray = field(default_factory=lambda: _none(0, 0, 3))
    """Force of the object on the skin, shared out to the outer vertices [N], shape (K, V, 3);
    their sum is minus the reaction."""
    pressure_MPa: np.ndarray = field(default_factory=lambda: _none(0, 0))
    """Contact force along the object's normal per undeformed area of the vertex, (K, V)."""
    cauchy_MPa: np.ndarray = field(default_factory=lambda: _none(0, 0, 6))
    """Cauchy stress at the outer vertices: xx, yy, zz, xy, yz, zx, shape (K, V, 6)."""
    energy_MPa: np.ndarray = field(default_factory=lambda: _none(0, 0))
    """Strain energy per undeformed volume at the outer vertices [MPa = N mm / mm3], (K, V)."""
    sliding_share: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Share of the contact's area that slides, of what touched at both ends of the frame, (K,)."""
    slip_mm: np.ndarray = field(default_factory=lambda: _none(0, 0))
    """Way that each vertex has slid on the object since it first touched [mm], shape (K, V)."""
    tangential_N: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Sum over points of the tangential contact force's magnitude [N], shape (K,), float64."""
    pressing_N: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Sum over points of the normal contact force [N], shape (K,), float64."""
    support_moment_Nmm: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Moment of the support on the membrane about the sensor's origin [N mm], shape (K, 3)."""
    actuator_N: np.ndarray = field(default_factory=lambda: np.zeros((0, 0, 3)))
    """Force of each driven region's drive on the membrane [N], (K, A, 3), as in the press."""
    actuator_moment_Nmm: np.ndarray = field(default_factory=lambda: np.zeros((0, 0, 3)))
    """Its moment about the axis point of the actuation [N mm], shape (K, A, 3)."""
    strain_energy_Nmm: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Strain energy of the active region [N mm], shape (K,), float64."""
    kinetic_ratio: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Energy of the relaxation's motion over the strain energy, shape (K,), float64."""
    least_volume_ratio: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Least J = det F of a material point, shape (K,), float64."""
    frame_seconds: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Time each frame took [s], shape (K,), float64; differs from run to run."""
    object_mm: np.ndarray = field(default_factory=lambda: _none(0, 0, 0, 0, 3))
    """How a soft object is deformed, in its body frame at `indenter_pose`: displacement [mm] at the
    nodes of a lattice over its undeformed body, shape (K, A, B, C, 3); empty where it is rigid."""
    object_origin_mm: np.ndarray = field(default_factory=lambda: np.zeros(3))
    """Place of the lattice's first node in the body frame [mm], shape (3,)."""
    object_spacing_mm: float = 1.0
    """Distance of the lattice's nodes [mm]."""
    sensor_pose: np.ndarray = field(default_factory=lambda: np.zeros((0, 7)))
    """Pose of the sensor in the room where the sensor is what moves, as `indenter_pose`, else
    (0, 7); all other fields stay in the sensor frame."""

    @property
    def normal_N(self) -> np.ndarray:
        """Reaction along the outward target normal [N], shape (K,)."""
        return self.reaction_N @ self.normal


@dataclass(frozen=True, kw_only=True, slots=True)
class TactileFrames:
    """Images of a press: frame 0 of `rgb` is the background, then one per contact frame."""

    rgb: np.ndarray
    """sRGB images, shape (1 + K, H, W, 3), uint8."""
    depth_z_mm: np.ndarray
    """Depth along the optical axis [mm], not the range; (1 + K, H, W), float32, NaN misses."""
    normal: np.ndarray
    """Unit normals facing the camera, sensor frame, shape (1 + K, H, W, 3), float16."""
    moved: np.ndarray
    """Pixels that see a displaced part of the skin, shape (1 + K, H, W), bool."""
    marker_uv_px: np.ndarray
    """Marker centres [px], shape (1 + K, M, 2), float32; NaN when hidden."""
    exposure: np.ndarray
    """Gain from linear radiance to display value, chosen once per design."""
    marker_mm: np.ndarray = field(default_factory=lambda: _none(0, 3))
    """Reference places of the markers or tips of pins [mm], shape (M, 3), float32."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Metrics:
    """Scalars of a variant by name; each name ends in its unit."""

    values: dict[str, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Shot:
    """What the camera saw during a press, and the measures of it."""

    frames: TactileFrames
    metrics: Metrics
    others: tuple[TactileFrames, ...] = ()
    """Of the further cameras, in their order."""
