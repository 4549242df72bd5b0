"""How far from the target a press reaches: the radius of the active region.

Strains of a bonded layer die out within a few thicknesses of the contact patch, so only the patch
and a margin of `MARGIN_WALLS` walls take part. On the default press that is 8.5 mm; against a
region of 20 mm the force then reads up to 0.3 % high and a displacement of 1 mm is off by at most
0.016 mm (12 mm: 0.03 % and 0.003 mm). See `tests/convergence/test_contact_region.py`.
"""

from __future__ import annotations

import math

import numpy as np

from sim.contact.motion.approach import Approach
from sim.contact.region.backing import decay_mm
from sim.contact.region.materials import stiffest_MPa
from sim.contact.region.refinement import path_samples
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Elastomer
from workbench.core.press.press import ContactSettings, Extent
from workbench.core.result.results import MembraneMesh

MARGIN_WALLS = 3.2
"""Margin around the patch, over the thickness of the wall, that costs at most `MARGIN_ERROR`; at
3.1 a cube at 45 degrees moved the skin by .030 mm another way than in a region of 16 mm, at 3.2 by
.027 mm."""
MARGIN_ERROR = 3e-3
DECAY_WALLS = 1.09
"""Rate at which the error falls with the margin in walls: on the default press from 0.3 % at 3.1
walls to 0.04 % at 4.95."""
STIFFEST_RATIO = 30.0
"""Modulus of an inclusion over that of the elastomer beyond which all of the membrane takes part:
a stiff coat carries the load farther than the wall says."""
LEAST_MARGIN_MM = 4.0
LEAST_MARGIN_WALLS = 1.5
"""Margin that a radius chosen by hand must leave around the patch, in walls."""
LEAST_DECAY = 0.75
"""The same over gel, in lengths after which the skin is at rest: where a plate on a foundation is
down to 4 % of its deflection, exp(-x) (cos x + sin x) with x = 3 / sqrt 2."""


def region_radius_mm(
    mesh: MembraneMesh,
    material: Elastomer,
    approach: Approach,
    settings: ContactSettings,
) -> float:
    """The designer's radius [mm], or with 0 the one that patch and wall ask for.

    The patch is the part of the undeformed skin inside the indenter anywhere on its path, so any
    shape, shear and twist are covered. A skin over gel bends farther than a bonded one, and over
    air all of it takes part.

    Raises:
        DesignError: If the designer's radius leaves less than 1.5 walls around the patch, cuts a
            skin over gel where it still bends, or a skin over air anywhere.
    """
    to_support = np.linalg.norm(mesh.inner.points_mm - approach.target_mm, axis=1)
    wall_mm = float(to_support.min())
    patch_mm = patch_radius_mm(mesh, approach)
    chosen_mm = settings.active_radius_mm
    decays_mm = decay_mm(mesh, material, wall_mm)
    from_target = np.linalg.norm(mesh.outer.points_mm - approach.target_mm, axis=1)
    whole_mm = float(from_target.max()) + wall_mm
    stiff = stiffest_MPa(material) > STIFFEST_RATIO * material.young_MPa
    if settings.extent is Extent.FULL or approach.press.actuations or stiff:
        return whole_mm
    if chosen_mm == 0.0:
        margin_mm = margin_walls(settings.region_error) * wall_mm
        return min(patch_mm + max(LEAST_MARGIN_MM, margin_mm, decays_mm), whole_mm)
    walls_mm, bends_mm = LEAST_MARGIN_WALLS * wall_mm, LEAST_DECAY * decays_mm
    least_mm = min(patch_mm + max(walls_mm, bends_mm), whole_mm)
    if chosen_mm < least_mm:
        needed = f"patch and {LEAST_MARGIN_WALLS:g} walls need"
        if bends_mm > walls_mm:
            needed = "patch and the bending of the skin on its gel need"
        if math.isinf(bends_mm):
            needed = "a skin over air moves as a whole and needs"
        raise DesignError(
            f"active radius {chosen_mm:g} mm is smaller than the contact: {needed} "
            f"{least_mm:.1f} mm",
            hint="raise contact.active_radius_mm, or 0, and the contact patch and the wall decide",
            at="contact.active_radius_mm",
        )
    return chosen_mm


def margin_walls(error: float) -> float:
    """Margin around the patch, in walls, that costs a relative error of the force."""
    return max(LEAST_MARGIN_WALLS, MARGIN_WALLS + math.log(MARGIN_ERROR / error) / DECAY_WALLS)


def patch_radius_mm(mesh: MembraneMesh, approach: Approach) -> float:
    """Farthest skin vertex from the target that the indenter covers on its path."""
    from_target = np.linalg.norm(mesh.outer.points_mm - approach.target_mm, axis=1)
    patch_mm = 0.0
    for progress in path_samples(approach):
        origin, rotation = approach.pose(float(progress))
        body = (mesh.outer.points_mm - origin) @ rotation
        inside = approach.collider.distance(body)[0] < 0.0
        patch_mm = max(patch_mm, float(from_target[inside].max(initial=0.0)))
    return patch_mm
