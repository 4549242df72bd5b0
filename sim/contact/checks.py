"""Validation of the contact room: each function runs a small study and returns its numbers.

(a) `bonded_block_errors`: against the closed form of Dimitriadis and others, Determination of
elastic moduli of thin layers of soft material using the atomic force microscope, Biophys. J. 82
(2002), eq. 11 with the bonded coefficients. (b) and (c) `penetration_and_balance`.
(d) `backed_block_force_N`: a block and the gel behind it against two columns in series, pushed and
sheared.
(e) `finger_45`: the finger of SimTac under a sphere at 45 degrees; finite elements give 1.29 N.
Taichi must have been initialised in this thread.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from sim.contact import specimens
from sim.contact.solver import press_membrane
from workbench.core.design import Elastomer
from workbench.core.indenter import Indenter, IndenterKind
from workbench.core.press import ContactSettings, Press
from workbench.core.results import Label
from workbench.core.sensing import Contact

BLOCK_HEIGHT_MM = 5.0
BLOCK_WIDTH_MM = 16.0
BLOCK_SPHERE_MM = 12.0
BLOCK_REGION_MM = 11.0
BLOCK_DEPTHS_MM = (0.3, 0.4, 0.5)
FINGER_SPHERE_MM = 6.0
BACKED_MM = 6.0
"""Width of the block on gel [mm]."""
BACKED_HEIGHT_MM = 2.0
BACKED_GAP_MM = 1.0
BACKED_DEPTH_MM = 0.1
STICKING = 2.0
"""Friction of the plate that shears [1]."""
BACKED_MATERIAL = Elastomer(poisson=0.0, friction=0.0)
BACKED_SHEAR_MM = 0.05
SHEARED_BACKING_MPa = 0.005
"""Gel for the check of shear: so soft that the block, 4 % of the way, hardly bends."""
BACKINGS_MPa = (0.02, 0.1, 1.0)
"""Gels for the check: the block takes 22 %, 58 % and 93 % of the way."""


def bonded_layer_force_N(
    material: Elastomer, *, radius_mm: float, height_mm: float, depth_mm: float
) -> float:
    """Force of a frictionless sphere on a bonded layer at small strain.

    F = 4 E / (3 (1 - nu^2)) sqrt(R) d^(3/2) [1 - 2 a chi / pi + 4 a^2 chi^2 / pi^2
    - (8 / pi^3)(a^3 + 4 pi^2 b / 15) chi^3 + (16 a / pi^4)(a^3 + 3 pi^2 b / 5) chi^4],
    chi = sqrt(R d) / h. Source: Dimitriadis and others 2002, eq. 11.
    """
    nu = material.poisson
    a = -(1.2876 - 1.4678 * nu + 1.3442 * nu**2) / (1.0 - nu)
    b = (0.6387 - 1.0277 * nu + 1.5164 * nu**2) / (1.0 - nu)
    chi = math.sqrt(radius_mm * depth_mm) / height_mm
    pi = math.pi
    series = 1.0 - 2.0 * a * chi / pi + 4.0 * (a * chi / pi) ** 2
    series -= 8.0 / pi**3 * (a**3 + 4.0 * pi**2 / 15.0 * b) * chi**3
    series += 16.0 * a / pi**4 * (a**3 + 3.0 * pi**2 / 5.0 * b) * chi**4
    modulus = 4.0 * material.young_MPa / (3.0 * (1.0 - nu**2))
    return modulus * math.sqrt(radius_mm) * depth_mm**1.5 * series


def bonded_block_errors(*, grid_mm: float = 0.4, poisson: float = 0.45) -> np.ndarray:
    """Relative force error at three depths against the bonded layer, shape (3,).

    The contact radius at the least depth, about sqrt(R d), is 1.34 mm: 3.4 cells at 0.4 mm.
    """
    material = Elastomer(poisson=poisson, friction=0.0)
    mesh, points = specimens.flat_block(
        width_mm=BLOCK_WIDTH_MM, height_mm=BLOCK_HEIGHT_MM, grid_mm=grid_mm
    )
    errors = []
    for depth_mm in BLOCK_DEPTHS_MM:
        contact = press_membrane(
            mesh,
            points,
            material,
            Indenter(size_mm=BLOCK_SPHERE_MM),
            Press(target_mm=(0.0, 0.0, BLOCK_HEIGHT_MM), depth_mm=depth_mm, frames=1),
            ContactSettings(active_radius_mm=BLOCK_REGION_MM),
        )
        exact_N = bonded_layer_force_N(
            material,
            radius_mm=0.5 * BLOCK_SPHERE_MM,
            height_mm=BLOCK_HEIGHT_MM,
            depth_mm=depth_mm,
        )
        errors.append(float(contact.normal_N[-1]) / exact_N - 1.0)
    return np.array(errors)


def press_finger(
    press: Press,
    *,
    material: Elastomer | None = None,
    settings: ContactSettings | None = None,
    grid_mm: float = 0.5,
    cylinder_mm: float = 27.0,
) -> Contact:
    """Press a 6 mm sphere into the exact finger of radius 15 and wall 2 mm."""
    mesh, points = specimens.finger(grid_mm=grid_mm, cylinder_mm=cylinder_mm)
    return press_membrane(
        mesh,
        points,
        material or Elastomer(),
        Indenter(size_mm=FINGER_SPHERE_MM),
        press,
        settings or ContactSettings(),
    )


def at_45_degrees(
    *, depth_mm: float = 1.0, frames: int = 1, azimuth_deg: float = 0.0, **path: object
) -> Press:
    """A press on the tip at 45 degrees to the axis."""
    azimuth = math.radians(azimuth_deg)
    radius = 15.0 * math.sqrt(0.5)
    target_mm = (radius * math.cos(azimuth), radius * math.sin(azimuth), 27.0 + radius)
    return Press(target_mm=target_mm, depth_mm=depth_mm, frames=frames, **path)  # type: ignore[arg-type]


def finger_45(*, grid_mm: float = 0.5, active_radius_mm: float = 12.0) -> float:
    """Normal force [N] of a sphere pressed 1 mm into the tip at 45 degrees."""
    settings = ContactSettings(active_radius_mm=active_radius_mm)
    contact = press_finger(at_45_degrees(), settings=settings, grid_mm=grid_mm)
    return float(contact.normal_N[-1])


def finger_45_sheared(*, shear_mm: float = 0.5) -> np.ndarray:
    """Force [N] along n, U, V after 1 mm of depth and a shear along V, shape (3,)."""
    path = at_45_degrees(frames=5, shear_mm=(0.0, shear_mm))
    contact = press_finger(path)
    axes = [contact.normal, contact.tangent_u, np.cross(contact.normal, contact.tangent_u)]
    return np.stack(axes) @ contact.reaction_N[-1]


def backed_block_force_N(backing_MPa: float) -> float:
    """Force of a flat plate that pushes a whole block into the gel behind it [N]."""
    return float(_press_backed_block(backing_MPa, shear_mm=0.0).reaction_N[-1][2])


def backed_block_shear_N(backing_MPa: float) -> float:
    """Force of a rough plate that pushes the block, then shears it, along the shear [N]."""
    contact = _press_backed_block(backing_MPa, shear_mm=BACKED_SHEAR_MM)
    return float(-contact.reaction_N[-1] @ contact.tangent_u)


def _press_backed_block(backing_MPa: float, *, shear_mm: float) -> Contact:
    bonded, points = specimens.flat_block(
        width_mm=BACKED_MM, height_mm=BACKED_HEIGHT_MM, grid_mm=0.5
    )
    label = np.full(len(bonded.inner.faces), Label.INNER | Label.BACKED, dtype=np.uint8)
    inner = dataclasses.replace(bonded.inner, labels=label)
    friction = STICKING if shear_mm else BACKED_MATERIAL.friction
    return press_membrane(
        dataclasses.replace(bonded, inner=inner, backing_mm=BACKED_GAP_MM),
        points,
        dataclasses.replace(BACKED_MATERIAL, backing_MPa=backing_MPa, friction=friction),
        Indenter(kind=IndenterKind.CUBE, size_mm=3.0 * BACKED_MM),
        Press(
            target_mm=(0.0, 0.0, BACKED_HEIGHT_MM),
            depth_mm=BACKED_DEPTH_MM,
            shear_mm=(shear_mm, 0.0),
            frames=1,
        ),
        ContactSettings(active_radius_mm=2.0 * BACKED_MM),
    )


def two_columns_force_N(backing_MPa: float) -> float:
    """The same in closed form, for small strain: block and gel as two columns in series [N].

    F = A d / (h / E + gap / E_gel); without Poisson effect nothing is held sideways.
    """
    compliance = BACKED_HEIGHT_MM / BACKED_MATERIAL.young_MPa + BACKED_GAP_MM / backing_MPa
    return BACKED_MM**2 * BACKED_DEPTH_MM / compliance


def two_sheared_columns_force_N(backing_MPa: float) -> float:
    """Shear of the same in closed form [N]: F = A d / (h / G + gap / G_gel), G_gel = E_gel / 3."""
    shear_MPa = BACKED_MATERIAL.young_MPa / (2.0 * (1.0 + BACKED_MATERIAL.poisson))
    compliance = BACKED_HEIGHT_MM / shear_MPa + 3.0 * BACKED_GAP_MM / backing_MPa
    return BACKED_MM**2 * BACKED_SHEAR_MM / compliance


def penetration_and_balance(contact: Contact) -> tuple[float, float]:
    """Deepest overlap in cells, and |reaction - support - cut| / |reaction|, of the last frame."""
    reaction_N = contact.reaction_N[-1]
    imbalance_N = float(np.linalg.norm(reaction_N - contact.support_N[-1] - contact.cut_N[-1]))
    overlap = float(contact.penetration_mm[-1]) / contact.grid_mm
    return overlap, imbalance_N / float(np.linalg.norm(reaction_N))
