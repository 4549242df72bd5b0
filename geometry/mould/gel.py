"""The soft gel behind a skin that stands off from its window: how much, and of what.

The gap is what the skin's inside encloses, less the support: of the pieces that are left, those
that touch the skin at its top. The others are the cavity, which stays empty.
"""

from __future__ import annotations

import numpy as np

from geometry.body.csg_mesh import closed
from geometry.body.silicones import NEAR, nearest
from geometry.surface.holes import cap
from workbench.core.result.results import Label, Solid

TOUCH_MM = 0.05
"""A piece this near to the inside's highest place is the gap [mm]: chords of the support."""


def gap_ml(solid: Solid) -> float:
    """Volume of the gap between skin and support [ml].

    Raises:
        GeometryError: If the skin's inside cannot be closed at its rim.
    """
    skin, support = solid.membrane, solid.support
    inner = skin.faces[skin.has(Label.INNER)]
    lid = cap(skin.points_mm, inner)
    # The membrane's faces look into the inside: turned over they look out of it.
    inside = closed("inside", skin.points_mm, np.vstack([inner, lid])[:, ::-1])
    left = inside - closed("support", support.points_mm, support.faces)
    top_mm = inside.bounding_box()[5] - TOUCH_MM
    gap = [piece.volume() for piece in left.decompose() if piece.bounding_box()[5] > top_mm]
    return float(sum(gap)) / 1000.0


def gel_step(solid: Solid, backing_MPa: float) -> str:
    """What to do about the gap, as one step of the recipe; for skins that stand off.

    Args:
        backing_MPa: Young's modulus of the gel.
    """
    near = nearest(backing_MPa)
    known = abs(near.young_MPa / backing_MPa - 1.0) <= NEAR
    what = near.name if known else f"soft silicone gel of E {backing_MPa:g} MPa"
    return (
        f"Fill the gap of {solid.backing_mm:g} mm between skin and window with "
        f"{gap_ml(solid):.2f} ml of {what}: inject it through a needle at the rim, with a second "
        "needle opposite for the air, and let it cure."
    )
