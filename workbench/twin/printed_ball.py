"""A ball from a printer: its diameter is off, and its surface stands in layers.

Printed layers of height a are discs across the axis of the press, each as wide as the ball is in
the middle of the layer. So where a smooth ball has the height z over its pole, the printed one has

    a round(z / a):

terraces, the first of radius sqrt(R a), with steps between that are a high. The steps are given to
the solvers as a picture of heights (`Texture`), which they feel through a Gaussian filter of 1.5
samples of the object's distance, .15 mm at the usual .1 mm: the first two or three terraces, and
of the closer ones no more than their mean. Photographs show what the mesh of the skin took of them.
Left out: supports, strings, and how a nozzle rounds the edge of a layer.
"""

from __future__ import annotations

import numpy as np

from workbench.core.press.indenter import BALL, Indenter
from workbench.core.press.texture import SMOOTH, HeightImage, Pattern, Texture

PIXEL_MM = 0.025
"""Of the picture of heights: a sixth of the filter."""
STEEP_SHARE = 0.9
"""Of the radius: farther out the ball is as steep as a wall, and layers are no relief."""


def printed_ball(diameter_mm: float, layer_mm: float) -> Indenter:
    """A printed ball, its printing axis along the press.

    Args:
        diameter_mm: Of the ball that the layers follow.
        layer_mm: Height of a layer; 0 leaves it smooth.
    """
    texture = SMOOTH if layer_mm <= 0.0 else _layers(0.5 * diameter_mm, layer_mm)
    return Indenter(BALL, size_mm=diameter_mm, texture=texture)


def layer_shares(across_mm: np.ndarray, radius_mm: float, layer_mm: float) -> np.ndarray:
    """How far the layers stand out at distances from the axis, over the height of one [1].

    From 0 to 1, .5 being the ball itself; any shape.
    """
    share = np.minimum(across_mm / radius_mm, STEEP_SHARE)
    layers = radius_mm * (1.0 - np.sqrt(1.0 - share**2)) / layer_mm
    relief = layers - np.round(layers)
    return np.where(across_mm < STEEP_SHARE * radius_mm, 0.5 + relief, 0.5)


def _layers(radius_mm: float, layer_mm: float) -> Texture:
    count = 2 * round(radius_mm / PIXEL_MM)
    at_mm = (np.arange(count) + 0.5) * (2.0 * radius_mm / count) - radius_mm
    across_mm = np.hypot(at_mm[:, None], at_mm[None, :])
    heights = layer_shares(across_mm, radius_mm, layer_mm)
    return Texture(
        pattern=Pattern.IMAGE,
        height_mm=layer_mm,
        pitch_mm=2.0 * radius_mm,
        image=HeightImage(heights=heights),
    )
