"""Which part of a membrane takes part in a press, how much of it strains, and how fine it is."""

from __future__ import annotations

import math

import numpy as np

from sim.contact.motion.approach import Approach
from sim.contact.region.backing import decay_mm
from sim.contact.region.radius import patch_radius_mm
from sim.fem.grading import finer_under
from sim.fem.submodel import Part, hexahedra_of
from workbench.core.design.design import Elastomer
from workbench.core.press.fem import FemSettings
from workbench.core.result.results import MembraneMesh

NEAR_MARGIN_MM = 1.0
"""Around the patch that the object covers on its path, tangents are exact so far [mm]. A cube half
a millimetre into the paw takes 95 systems at 2.0, 1.2 and 0.6 mm alike, in 52, 39 and 30 s; a whole
millimetre deep 317 at 0.6 mm but 524 at 0.2, in 102 and 125 s. Forces agree to 3e-8 of the largest.
"""


def part_of(
    mesh: MembraneMesh, material: Elastomer, approach: Approach, settings: FemSettings
) -> Part:
    """The part of a membrane that a press asks for."""
    # Without halvings cells stay as they were meshed, away from the contact too.
    paired = settings.halvings > 0 and len(hexahedra_of(mesh).groups) > 0
    whole_mm = settings.hex_mm * (2.0 if paired else 1.0)
    return Part(
        centre_mm=approach.target_mm,
        radius_mm=_radius_mm(mesh, material, approach, settings),
        near_mm=patch_radius_mm(mesh, approach) + NEAR_MARGIN_MM,
        paired=paired,
        wanted=finer_under(approach, mesh.outer.points_mm, whole_mm),
        halvings=settings.halvings + int(paired),
    )


def _radius_mm(
    mesh: MembraneMesh, material: Elastomer, approach: Approach, settings: FemSettings
) -> float:
    """Radius of the part that takes part; inf for all of it.

    A driven membrane moves as a whole, and a skin over gel or air bends farther than a bonded one.
    """
    wall_mm = float(np.linalg.norm(mesh.inner.points_mm - approach.target_mm, axis=1).min())
    decays_mm = decay_mm(mesh, material, wall_mm)
    if settings.radius_mm == 0.0 or approach.press.actuations or math.isinf(decays_mm):
        return math.inf
    return settings.radius_mm + approach.aside_mm + decays_mm
