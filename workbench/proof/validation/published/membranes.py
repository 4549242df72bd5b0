"""Outer skins of the presets beside the membranes that were released with the paper.

Left out on both sides: inner faces, and the flat cuts by which a membrane is held. Of the pad no
file was released; its block of 20 x 20 x 4 mm is the one of the paper's GelSight.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np

from geometry.surface.primitives import rounded_box
from workbench.core.base.monitor import silent
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import Label
from workbench.pipeline.stages.build import build
from workbench.planning.plan import plan
from workbench.project.named_designs import load_design
from workbench.proof.row import Row, bounded
from workbench.proof.validation.published.alignment import laid_on
from workbench.proof.validation.published.apart import distances_mm, ellipsoid
from workbench.proof.validation.published.released import Cut, Skin, membrane

PRESETS = {
    "finger": "geltip",
    "trunk": "trunk",
    "paw": "paw",
    "thumb": "thumb",
    "tentacle": "tentacle",
    "pad": "pad",
    "digitac": "digitac",
}
"""What is compared, by family."""
PAD_MM = (20.0, 20.0, 4.0)
MEAN_MM, OUTER_MM = 0.25, 0.8
"""Limits of the mean and of the 95 % quantile."""
LOOSER = {"thumb": (0.4, 1.2)}
"""A nail and a bend of freer form."""
SHARE = 95.0


def rows() -> list[Row]:
    """Two rows of each family."""
    return [row for family in PRESETS for row in _rows(family)]


def _rows(family: str) -> list[Row]:
    @functools.cache
    def found() -> np.ndarray:
        return measured_mm(preset_skin(PRESETS[family]), released_skin(family))

    @functools.cache
    def null() -> np.ndarray:
        return distances_mm(ellipsoid(released_skin(family)), released_skin(family))

    def share(of: Callable[[], np.ndarray]) -> Callable[[], float]:
        return lambda: float(np.percentile(of(), SHARE))

    mean_mm, outer_mm = LOOSER.get(family, (MEAN_MM, OUTER_MM))
    return [
        bounded(
            "membrane_shape",
            family,
            lambda: float(found().mean()),
            unit="mm",
            limit=mean_mm,
            null=lambda: float(null().mean()),
        ),
        bounded(
            "membrane_shape_95", family, share(found), unit="mm", limit=outer_mm, null=share(null)
        ),
    ]


def measured_mm(ours: Skin, released: Skin) -> np.ndarray:
    """Distances of both skins to each other, ours laid on the released one."""
    return distances_mm(laid_on(ours, released), released)


def preset_skin(name: str) -> Skin:
    """The outer skin of a preset's body.

    Raises:
        DesignError: If the preset is refused.
        MeshingError: If its body cannot be built.
    """
    body = build(plan(load_design(name), PressCase())["build"].inputs, monitor=silent).membrane
    return Skin(points_mm=body.points_mm, faces=body.faces[body.has(Label.OUTER)])


def released_skin(family: str) -> Skin:
    """What was released for a family."""
    return _block() if family == "pad" else membrane(family)


def _block() -> Skin:
    """The pad's block without the face by which it is held."""
    corners, faces = rounded_box(0.5, 0.0)
    points = corners * np.array(PAD_MM)
    held = (points[faces][:, :, 2] < 0.0).all(axis=1)
    cut = Cut((0.0, 0.0, -1.0), 0.5 * PAD_MM[2])
    return Skin(points_mm=points, faces=faces[~held], cuts=(cut,))
