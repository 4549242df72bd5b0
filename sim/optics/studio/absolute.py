"""One absolute image: what a dent changes in the light of skin that did not move.

Over the background, skin that did not move keeps its light exactly. In an absolute image `direct`
and `hybrid` let the moved patch cast the shadows of their lights on all of the skin, without the
fade toward the rim, and `photons` shows what was traced everywhere. Models without shadows have
nothing to change. Left out: light that the dent scatters onto other skin, which only `photons` has.
"""

from __future__ import annotations

import numpy as np

from sim.optics.raster.backdrop import at_pixels
from sim.optics.raster.imager import Imager
from sim.optics.raster.raster_kernels import SAME


def cast_change(imager: Imager) -> np.ndarray:
    """Change of linear light where the frame just looked at did not move, (N, 3), float32.

    The imager must hold a single frame, shaded with `everywhere`.
    """
    raster, back = imager.raster, imager.backdrop
    still = raster.seen.triangle.to_numpy()[: raster.pixels] == SAME
    if not raster.vertex_entries and not imager.shader.given:
        return np.zeros((raster.pixels, 3), dtype=np.float32)
    lit = imager.shader.everywhere()
    change = at_pixels(raster.view, lit - back.undeformed)
    change *= (1.0 + (back.ink_gain - 1.0) * back.ink)[:, None]
    change[~still] = 0.0
    return change
