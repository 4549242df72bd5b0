"""Where a first press of a design makes sense."""

from __future__ import annotations

import numpy as np

from workbench.bodies import IMPORTED
from workbench.core.design import SensorDesign
from workbench.core.results import Label, Solid


def default_target_mm(
    design: SensorDesign, solid: Solid | None = None
) -> tuple[float, float, float]:
    """Point near the skin by the family, or the top of an imported body [mm].

    Args:
        design: The sensor.
        solid: Its body; only imported designs need it, and aim at the origin without.
    """
    from designs.family import family, resolve_shape

    if design.family == IMPORTED and solid is not None:
        membrane = solid.membrane
        outer = membrane.points_mm[np.unique(membrane.faces[membrane.has(Label.OUTER)])]
        x, y, z = (round(float(c), 3) for c in outer[np.argmax(outer[:, 2])])
        return x, y, z
    shape = resolve_shape(design.family, design.shape)
    x, y, z = (round(float(c), 3) for c in family(design.family).target(shape, design.layers))
    return x, y, z
