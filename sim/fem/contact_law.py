"""Contact and friction at points of the skin: traction, its exact tangent, and what is remembered.

Normal: a penalty on the penetration p = max(-phi, 0) of the signed distance phi,

    U(p) = eps p^3 / (6 delta) for p < delta, else eps (p^2 / 2 - delta p / 2 + delta^2 / 6),

once continuously differentiable in its force lam = U'(p); traction lam g, g = grad phi.
Friction: elastic slip with memory. With v = (slip kept before) + (motion relative to the object in
this increment) and e = (I - n n^T) v, n = g / |g|, y = |e| / gamma, the traction is

    tau = -mu lam |g| (2 y - y^2) e / |e| for y < 1, else -mu lam |g| e / |e|:

its size never exceeds the Coulomb cone, its stiffness at rest is 2 mu lam / gamma. e min(1, 1/y)
is what the point keeps when an increment has converged. The tangent includes the turning of n.
mu is the kinetic coefficient of a point that slid in the last increment, else the static one, so it
does not change within an increment; a point that comes to stick holds by the static one again.
With `lag` pressure and normal of the friction are held, and then it has a potential too:
mu lam gamma (y^2 - y^3 / 3 for y < 1, else y - 1/3).
Source of the numbers: `PENALTY` and the lengths below were chosen so that force and contact
radius of a Hertz contact no longer depend on them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

PENALTY = 1380.0
"""eps over Young's modulus [1/mm]: 200 MPa/mm at 0.145 MPa; a quarter reads 2-3 % low."""
SOFT_MM = 2e-3
"""delta: penetration within which the penalty sets in [mm]."""
SLIP_MM = 5e-3
"""gamma: elastic slip at which a point begins to slide [mm]."""
LEAST_MM = 1e-14
"""Guards quotients by the length of a vanishing slip."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Law:
    """Constants of one pairing."""

    penalty_MPa_mm: float
    """eps [MPa/mm]."""
    friction: float
    """mu of what sticks [1]."""
    kinetic_friction: float | None = None
    """mu of what slides; None: the same."""
    soft_mm: float = SOFT_MM
    slip_mm: float = SLIP_MM


@dataclass(frozen=True, kw_only=True)
class Touch:
    """Points that may touch, Q of them, against the object at one pose."""

    distance_mm: np.ndarray
    """phi, shape (Q,)."""
    gradient: np.ndarray
    """grad phi, shape (Q, 3)."""
    curvature: np.ndarray | None
    """Second derivatives of phi [1/mm], shape (Q, 3, 3); needed for tangents only."""
    slip_mm: np.ndarray
    """v, shape (Q, 3)."""
    slides: np.ndarray | None = None
    """Whether each slid in the last increment, shape (Q,), bool; None: none did."""

    def friction(self, law: Law) -> np.ndarray:
        """mu, shape (Q,)."""
        static = np.full(len(self.distance_mm), law.friction)
        if law.kinetic_friction is None or self.slides is None:
            return static
        return np.where(self.slides, law.kinetic_friction, static)

    @cached_property
    def steepness(self) -> np.ndarray:
        """|grad phi|, shape (Q,)."""
        return np.linalg.norm(self.gradient, axis=1)


@dataclass(frozen=True, kw_only=True, slots=True)
class Lag:
    """Pressure and normal that friction is taken with, from an earlier iterate."""

    pressure_MPa: np.ndarray
    """lam |grad phi|, shape (Q,)."""
    normal: np.ndarray
    """n, shape (Q, 3)."""

    def take(self, members: np.ndarray) -> Lag:
        """Some of the points."""
        return Lag(pressure_MPa=self.pressure_MPa[members], normal=self.normal[members])


@dataclass(frozen=True, kw_only=True, slots=True)
class Traction:
    """What the law says, per undeformed area."""

    energy_N_mm: np.ndarray
    """Potential, shape (Q,); of friction only where it has one."""
    normal_MPa: np.ndarray
    """Normal traction on the skin, shape (Q, 3)."""
    friction_MPa: np.ndarray
    """Tangential traction on the skin, shape (Q, 3)."""
    stiffness_MPa_mm: np.ndarray | None
    """Minus the derivative of the whole traction by the place, shape (Q, 3, 3)."""
    lag: Lag
    """Pressure and normal of this state."""
    elastic_mm: np.ndarray
    """Slip that a converged increment keeps, shape (Q, 3)."""
    slid_mm: np.ndarray
    """Way that the point slides in this increment, shape (Q,)."""

    @property
    def total_MPa(self) -> np.ndarray:
        """Traction on the skin, shape (Q, 3)."""
        return self.normal_MPa + self.friction_MPa


def traction(law: Law, touch: Touch, *, lag: Lag | None = None, convex: bool = False) -> Traction:
    """Traction at points, with its tangent where `touch` has curvatures.

    Args:
        law: Constants.
        touch: Distances and slips.
        lag: Friction with this pressure and normal instead of the state's own.
        convex: Leave the object's curvature out of the normal stiffness, which then has no
            negative part.
    """
    gradient = touch.gradient
    size = touch.steepness
    normal = gradient / np.maximum(size, LEAST_MM)[:, None]
    depth_mm = np.maximum(-touch.distance_mm, 0.0)
    penalty = _penalty(law, depth_mm)
    lam = penalty.pressure_MPa
    own = Lag(pressure_MPa=lam * size, normal=normal)
    stiffness = None
    if touch.curvature is not None:
        stiffness = (
            penalty.slope_MPa_mm[:, None, None] * gradient[:, :, None] * gradient[:, None, :]
        )
        if not convex:
            stiffness -= lam[:, None, None] * touch.curvature
    rub = _Rub.of(law, lag or own, touch)
    if law.friction > 0.0 and stiffness is not None and touch.curvature is not None:
        if lag is None:
            stiffness += _exact_friction(law, touch, rub, normal, penalty)
        else:
            projector = _projectors(lag.normal)
            stiffness += projector @ rub.moduli(law) @ projector
    return Traction(
        energy_N_mm=penalty.energy_N_mm + rub.energy_N_mm(law),
        normal_MPa=lam[:, None] * gradient,
        friction_MPa=rub.traction_MPa(),
        stiffness_MPa_mm=stiffness,
        lag=own,
        elastic_mm=rub.elastic_mm * np.minimum(1.0, 1.0 / np.maximum(rub.ratio, LEAST_MM))[:, None],
        slid_mm=np.maximum(rub.length_mm - law.slip_mm, 0.0),
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class _Penalty:
    """What penetration costs at points, each of shape (Q,)."""

    energy_N_mm: np.ndarray
    """Per area."""
    pressure_MPa: np.ndarray
    """lam."""
    slope_MPa_mm: np.ndarray
    """Derivative of lam by the depth."""


def _penalty(law: Law, depth_mm: np.ndarray) -> _Penalty:
    """Of penetrations, shape (Q,)."""
    stiffness, soft = law.penalty_MPa_mm, law.soft_mm
    early = depth_mm < soft
    energy = np.where(
        early,
        depth_mm**3 / (6.0 * soft),
        0.5 * depth_mm * (depth_mm - soft) + soft**2 / 6.0,
    )
    pressure = np.where(early, depth_mm**2 / (2.0 * soft), depth_mm - 0.5 * soft)
    slope = np.where(early, depth_mm / soft, 1.0)
    return _Penalty(
        energy_N_mm=stiffness * energy,
        pressure_MPa=stiffness * pressure,
        slope_MPa_mm=stiffness * slope,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class _Rub:
    """Friction at points: the slip in the tangent plane, and the law's factors."""

    friction: np.ndarray
    """mu, shape (Q,)."""
    pressure_MPa: np.ndarray
    elastic_mm: np.ndarray
    """e, shape (Q, 3)."""
    length_mm: np.ndarray
    direction: np.ndarray
    ratio: np.ndarray
    """y, shape (Q,)."""

    @classmethod
    def of(cls, law: Law, lag: Lag, touch: Touch) -> _Rub:
        along = np.einsum("qi,qi->q", lag.normal, touch.slip_mm)
        elastic_mm = touch.slip_mm - along[:, None] * lag.normal
        length_mm = np.linalg.norm(elastic_mm, axis=1)
        return cls(
            friction=touch.friction(law),
            pressure_MPa=lag.pressure_MPa,
            elastic_mm=elastic_mm,
            length_mm=length_mm,
            direction=elastic_mm / np.maximum(length_mm, LEAST_MM)[:, None],
            ratio=length_mm / law.slip_mm,
        )

    @property
    def share(self) -> np.ndarray:
        """Share of the cone that is used, shape (Q,)."""
        return np.where(self.ratio < 1.0, self.ratio * (2.0 - self.ratio), 1.0)

    def traction_MPa(self) -> np.ndarray:
        return -(self.friction * self.pressure_MPa * self.share)[:, None] * self.direction

    def energy_N_mm(self, law: Law) -> np.ndarray:
        y = self.ratio
        shape = np.where(y < 1.0, y**2 - y**3 / 3.0, y - 1.0 / 3.0)
        return self.friction * law.slip_mm * self.pressure_MPa * shape

    def moduli(self, law: Law) -> np.ndarray:
        """Minus the derivative of the traction by e at constant pressure, shape (Q, 3, 3)."""
        stick = self.ratio < 1.0
        across = np.where(
            stick, (2.0 - self.ratio) / law.slip_mm, 1.0 / np.maximum(self.length_mm, LEAST_MM)
        )
        along = np.where(stick, 2.0 * (1.0 - self.ratio) / law.slip_mm, 0.0)
        scale = self.friction * self.pressure_MPa
        pairs = self.direction[:, :, None] * self.direction[:, None, :]
        found = (scale * across)[:, None, None] * np.eye(3)
        return found + (scale * (along - across))[:, None, None] * pairs


def _exact_friction(
    law: Law, touch: Touch, rub: _Rub, normal: np.ndarray, penalty: _Penalty
) -> np.ndarray:
    """Minus the derivative of the friction by the place, pressure and normal moving with it."""
    assert touch.curvature is not None
    slip, size = touch.slip_mm, touch.steepness
    projector = _projectors(normal)
    turning = projector @ touch.curvature / np.maximum(size, LEAST_MM)[:, None, None]
    along = np.einsum("qi,qi->q", normal, slip)
    carried = np.einsum("qi,qij->qj", slip, turning)
    slope_of_slip = projector - along[:, None, None] * turning
    slope_of_slip -= normal[:, :, None] * carried[:, None, :]
    bent = np.einsum("qij,qj->qi", touch.curvature, normal)
    rise = penalty.slope_MPa_mm * size
    slope_of_pressure = penalty.pressure_MPa[:, None] * bent - rise[:, None] * touch.gradient
    pull = (rub.friction * rub.share)[:, None, None] * rub.direction[:, :, None]
    return rub.moduli(law) @ slope_of_slip + pull * slope_of_pressure[:, None, :]


def _projectors(normal: np.ndarray) -> np.ndarray:
    """I - n n^T, shape (Q, 3, 3)."""
    return np.eye(3) - normal[:, :, None] * normal[:, None, :]
