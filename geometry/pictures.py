"""Off-screen pictures for the report: the exploded mould, and a skin coloured by a field.

Rendered by VTK without a display: through EGL where there is a device for it, else in software
by OSMesa. Which one works is found out once, in a child process, because VTK ends the process
that asks for a window it cannot have.
"""

from __future__ import annotations

import functools
import os
import subprocess
import sys
from typing import Any

import numpy as np

from workbench.core.errors import DeviceError
from workbench.core.fabrication import MouldSet
from workbench.core.results import Skin

SIZE_PX = (1200, 900)
WINDOW = "VTK_DEFAULT_OPENGL_WINDOW"
WINDOWS = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow")
PROBE = """
import vtkmodules.vtkRenderingOpenGL2
from vtkmodules.vtkRenderingCore import vtkRenderWindow
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.Render()
"""
PROBE_SECONDS = 60
COLOURS = {"half_a": "lightsteelblue", "half_b": "slategray", "core": "khaki"}
PLAIN = "salmon"
VIEW = (1.6, -1.8, 0.9)
"""Direction from the body to the eye."""


def exploded_mould(moulds: MouldSet, size_px: tuple[int, int] = SIZE_PX) -> np.ndarray:
    """The parts of a mould drawn apart, as PNG bytes, shape (bytes,), uint8.

    Raises:
        DeviceError: If nothing here can render.
    """
    plotter = _plotter(size_px)
    for part in moulds.parts:
        mesh = _polydata(part.points_mm + np.asarray(part.explode), part.faces)
        colour = COLOURS.get(part.name, PLAIN)
        plotter.add_mesh(mesh, color=colour, smooth_shading=True, split_sharp_edges=True)
    return _png(plotter)


def skin_field(
    skin: Skin, values: np.ndarray, label: str, size_px: tuple[int, int] = SIZE_PX
) -> np.ndarray:
    """A skin coloured by one value at each vertex, as PNG bytes, shape (bytes,), uint8.

    Args:
        values: Shape (V,).
        label: Name and unit of the values, for the legend.

    Raises:
        DeviceError: If nothing here can render.
    """
    plotter = _plotter(size_px)
    mesh = _polydata(skin.points_mm, skin.faces)
    legend = {"title": label, "color": "black", "vertical": True, "position_x": 0.85}
    plotter.add_mesh(
        mesh,
        scalars=np.asarray(values),
        cmap="viridis",
        smooth_shading=True,
        scalar_bar_args=legend,
    )
    return _png(plotter)


@functools.cache
def _window() -> str:
    """The kind of VTK window that renders here.

    Raises:
        DeviceError: If none does.
    """
    chosen = os.environ.get(WINDOW)
    for window in (chosen,) if chosen else WINDOWS:
        environment = {**os.environ, WINDOW: window}
        command = [sys.executable, "-c", PROBE]
        try:
            probe = subprocess.run(
                command, env=environment, capture_output=True, timeout=PROBE_SECONDS, check=False
            )
        except subprocess.TimeoutExpired:
            continue
        if probe.returncode == 0 and not probe.stderr:
            return window
    raise DeviceError(
        "no off-screen renderer works here",
        hint=f"install libegl1 or libosmesa6, or set {WINDOW}",
    )


def _plotter(size_px: tuple[int, int]) -> Any:
    os.environ[WINDOW] = _window()
    import pyvista

    plotter: Any = pyvista.Plotter(off_screen=True, window_size=list(size_px))
    plotter.set_background("white")
    return plotter


def _png(plotter: Any) -> np.ndarray:
    import cv2

    plotter.view_vector(VIEW, viewup=(0.0, 0.0, 1.0))
    plotter.enable_anti_aliasing("ssaa")
    rgb = plotter.screenshot(return_img=True)
    plotter.close()
    return cv2.imencode(".png", np.ascontiguousarray(rgb[:, :, 2::-1]))[1].ravel()


def _polydata(points_mm: np.ndarray, faces: np.ndarray) -> Any:
    import pyvista

    padded = np.column_stack([np.full(len(faces), 3), faces]).ravel()
    return pyvista.PolyData(np.asarray(points_mm), padded)
