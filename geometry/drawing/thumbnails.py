"""Small drawings of a membrane for lists of variants: at rest, and pressed.

PNG bytes, shape (bytes,), uint8, drawn off-screen as in `sensor_drawings`; DeviceError where
nothing can render.
"""

from __future__ import annotations

import numpy as np

from geometry.drawing.rendering import canvas, look, png, surface
from geometry.drawing.sensor_drawings import EYE, membrane_drawing
from workbench.core.result.results import Skin, Solid

SIZE_PX = (240, 240)


def at_rest(solid: Solid, size_px: tuple[int, int] = SIZE_PX) -> np.ndarray:
    """The membrane, untouched, on a clear ground."""
    return membrane_drawing(solid, size_px)


def pressed(
    skin: Skin, moved_mm: np.ndarray, normal: np.ndarray, size_px: tuple[int, int] = SIZE_PX
) -> np.ndarray:
    """The deformed skin, pale to dark by how far it moved, on a clear ground.

    Args:
        skin: At rest.
        moved_mm: Displacement of its vertices [mm], shape (V, 3).
        normal: Outward normal at the target: the eye is on its side, a little above.
    """
    moved_mm = np.asarray(moved_mm, dtype=np.float64)
    values = np.linalg.norm(moved_mm, axis=1)
    plotter = canvas(size_px)
    plotter.add_mesh(
        surface(skin.points_mm + moved_mm, skin.faces),
        scalars=values,
        cmap="YlGnBu",
        clim=(0.0, max(float(values.max(initial=0.0)), 1e-9)),
        smooth_shading=True,
        ambient=0.3,
        diffuse=0.8,
        show_scalar_bar=False,
    )
    look(plotter, np.asarray(normal) + 0.4 * EYE, skin.points_mm)
    return png(plotter, clear=True)
