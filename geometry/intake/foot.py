"""The rigid foot of an imported body: its base, wider by a lip, bored for the camera."""

from __future__ import annotations

from typing import Any

import numpy as np

from geometry.intake.labelling import flat_arrays
from geometry.surface.surface import FLAT_MM, on_plane
from workbench.core.base.errors import DesignError
from workbench.core.result.results import Label, LabelledSurface

BORE_SHARE = 0.6
"""Diameter of the bore over the width of the way into the cavity."""
FIN_MM = 0.1
"""What of the foot's outline is thinner than twice this is left out: a remeshed body has burrs."""
LEAST_OPENING_MM = 6.0
"""Narrowest way into the cavity about the middle of the base: the smallest camera modules are
about 4 mm wide."""


def foot(outer: Any, cavity: Any, shape: Any) -> LabelledSurface:
    """The outline of the base, wider by the lip, with a bore for the camera."""
    import manifold3d

    outline = outer.slice(0.01).offset(-FIN_MM, manifold3d.JoinType.Round)
    outline = outline.offset(shape.base_lip_mm + FIN_MM, manifold3d.JoinType.Round)
    height = shape.base_height_mm
    plate = manifold3d.Manifold.extrude(outline, height).translate((0.0, 0.0, -height))
    radius = BORE_SHARE * _opening_mm(cavity) / 2
    bore = manifold3d.Manifold.cylinder(height + 2.0, radius, radius, 64)
    points, faces, _ = flat_arrays(plate - bore.translate((0.0, 0.0, -height - 1.0)))
    labels = np.where(on_plane(points, faces), Label.BASE, Label.OUTER).astype(np.uint8)
    return LabelledSurface(points_mm=points, faces=faces, labels=labels)


def _opening_mm(cavity: Any) -> float:
    """Width of the way into the cavity about the middle of the base.

    Raises:
        DesignError: If a camera does not pass.
    """
    import manifold3d
    import shapely

    section = cavity.slice(0.01)
    # To the edges of the outline: it has corners only where it bends.
    outlines = [shapely.LinearRing(outline) for outline in section.to_polygons()]
    rim_mm = min(outline.distance(shapely.Point(0.0, 0.0)) for outline in outlines)
    open_there = not (section ^ manifold3d.CrossSection.circle(FLAT_MM, 8)).is_empty()
    width_mm = 2.0 * rim_mm if open_there else 0.0
    if width_mm < LEAST_OPENING_MM:
        raise DesignError(
            f"the way into the cavity is {width_mm:.2g} mm wide about the middle of the base, a "
            f"camera needs {LEAST_OPENING_MM:g} mm",
            hint="lower layers.elastomer_mm or layers.support_mm, or change shape.cut_mm",
            at="layers.support_mm",
        )
    return width_mm
