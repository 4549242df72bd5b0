"""A block on gel under a flat plate: block and gel are two columns in series."""

from __future__ import annotations

import dataclasses

import numpy as np

from sim.contact.press import press_membrane
from sim.contact.studies import specimens
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import Label
from workbench.core.result.sensing import Contact

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
        PressCase(
            indenter=Indenter(kind=IndenterKind("cube"), size_mm=3.0 * BACKED_MM),
            press=Press(
                target_mm=(0.0, 0.0, BACKED_HEIGHT_MM),
                depth_mm=BACKED_DEPTH_MM,
                shear_mm=(shear_mm, 0.0),
                frames=1,
            ),
            settings=ContactSettings(active_radius_mm=2.0 * BACKED_MM),
        ),
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
