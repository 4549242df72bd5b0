"""Drawing off screen: a white or clear canvas, bodies on it, framing, PNG bytes.

Rendered by VTK without a display: through EGL where there is a device for it, else in software
by OSMesa. Which one works is found out once, in a child process, because VTK ends the process
that asks for a window it cannot have. The projection is parallel, so a drawing is framed exactly
by projecting its points, and it has one scale.
"""

from __future__ import annotations

import functools
import os
import subprocess
import sys
from typing import Any

import numpy as np

from workbench.core.base.errors import DeviceError

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
CREASE_DEG = 30.0
"""Edges sharper than this are drawn sharp, and as lines."""
EDGE_COLOUR = "#3a4048"
MARGIN = 1.06
"""Size of the drawing over that of what is on it."""


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


def canvas(size_px: tuple[int, int]) -> Any:
    """An empty white drawing, to be drawn on and handed to `png`.

    Raises:
        DeviceError: If nothing here can render.
    """
    os.environ[WINDOW] = _window()
    import pyvista

    plotter: Any = pyvista.Plotter(off_screen=True, window_size=list(size_px))
    plotter.set_background("white")
    return plotter


def surface(points_mm: np.ndarray, faces: np.ndarray) -> Any:
    """Triangles (M, 3) on points (N, 3) as VTK draws them."""
    import pyvista

    return pyvista.PolyData.from_regular_faces(np.array(points_mm), np.asarray(faces))


def draw(
    plotter: Any,
    points_mm: np.ndarray,
    faces: np.ndarray,
    colour: str,
    *,
    opacity: float = 1.0,
    edges: bool = True,
) -> None:
    """Draw a body, smooth but for its creases, which also become thin lines."""
    body = surface(points_mm, faces)
    plotter.add_mesh(
        body,
        color=colour,
        opacity=opacity,
        smooth_shading=True,
        split_sharp_edges=True,
        feature_angle=CREASE_DEG,
        ambient=0.3,
        diffuse=0.8,
        specular=0.12,
    )
    if edges:
        lines = body.extract_feature_edges(CREASE_DEG, non_manifold_edges=False)
        if lines.n_cells:
            plotter.add_mesh(lines, color=EDGE_COLOUR, line_width=1.0, opacity=0.7)


def screen_axes(eye: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors to the right and upward of a drawing seen from direction `eye`; +Z is up.

    Looked at along Z itself, +Y is up.
    """
    forward = -np.asarray(eye, dtype=np.float64) / np.linalg.norm(eye)
    upward = np.array([0.0, 0.0, 1.0]) if abs(forward[2]) < 0.999 else np.array([0.0, 1.0, 0.0])
    right = np.cross(forward, upward)
    right /= np.linalg.norm(right)
    return right, np.cross(right, forward)


def look(
    plotter: Any, eye: np.ndarray, points_mm: np.ndarray, margins: tuple[float, float] = (0.0, 0.0)
) -> None:
    """Aim the drawing so that the points fill it.

    Args:
        eye: Direction from the bodies to the eye.
        margins: Share of the width kept free at the left and at the right, for a legend.
    """
    right, up = screen_axes(eye)
    across, height = points_mm @ right, points_mm @ up
    width_px, height_px = plotter.window_size
    free = 1.0 - sum(margins)
    half = max(np.ptp(height), np.ptp(across) * height_px / (free * width_px)) / 2.0 * MARGIN
    shift = (margins[1] - margins[0]) / 2.0 * 2.0 * half * width_px / height_px
    depth = points_mm @ (eye / np.linalg.norm(eye))
    centre = (across.min() + across.max()) / 2.0 * right + (height.min() + height.max()) / 2.0 * up
    centre = centre + shift * right + depth.mean() * eye / np.linalg.norm(eye)
    camera = plotter.camera
    camera.parallel_projection = True
    camera.focal_point = centre
    camera.position = centre + (np.ptp(depth) + 100.0) * eye / np.linalg.norm(eye)
    camera.up = up
    camera.parallel_scale = float(half)
    plotter.reset_camera_clipping_range()


def png(plotter: Any, *, clear: bool = False) -> np.ndarray:
    """Render and close: the drawing as PNG bytes, shape (bytes,), uint8.

    Args:
        clear: Whether the ground is transparent instead of white.
    """
    import cv2

    plotter.enable_anti_aliasing("ssaa")
    image = plotter.screenshot(return_img=True, transparent_background=clear)
    plotter.close()
    order = [2, 1, 0, 3] if clear else [2, 1, 0]
    return cv2.imencode(".png", np.ascontiguousarray(image[:, :, order]))[1].ravel()
