"""Photographs of a built sensor for the screenshot of *Calibrate*, drawn by the program itself.

The twin's LEDs have other powers than the design's, as those of a built sensor would.
"""

from __future__ import annotations

import zipfile
from pathlib import Path

import cv2  # noqa: TID253 (a program of its own, not part of the package)
import numpy as np

import workbench as wb

BALL_MM, DEPTH_MM = 6.0, 1.0
ELEVATION_DEG = 55.0
"""Of the places on the dome, above the plane in which it begins."""
AZIMUTHS_DEG = (-90.0, -30.0, 30.0, 90.0, 150.0, -150.0)
POWERS = (1.1, 0.9, 1.0, 0.85, 1.15, 1.0, 0.95, 1.05, 1.0)
"""Factors on the powers of the nine LEDs of the finger."""


def photo_set(folder: Path) -> Path:
    """A zip of six photographs of balls on the finger's dome, one at rest, and their depths."""
    design = wb.load("geltip")
    ring = design.optics.ring
    powers = np.asarray(ring.powers or np.ones(ring.count)) * POWERS
    twin = design.replace("optics.ring.powers", tuple(float(power) for power in powers))
    project = folder / "photographed"
    radius_mm, _, top_mm = wb.evaluate(twin, project=project).mesh.outer.points_mm.max(axis=0)
    path = folder / "photographs.zip"
    with zipfile.ZipFile(path, "w") as file:
        lines = [f"press_{number}.png,{DEPTH_MM}" for number in range(len(AZIMUTHS_DEG))]
        file.writestr("presses.csv", "\n".join(["photo,depth_mm", *lines]))
        for number, azimuth_deg in enumerate(AZIMUTHS_DEG):
            images = _images(twin, _place(azimuth_deg, radius_mm, top_mm), project)
            file.writestr(f"press_{number}.png", _png(images[-1]))
            if not number:
                file.writestr("idle.png", _png(images[0]))
    return path


def _images(twin: wb.Design, place_mm: tuple[float, float, float], project: Path) -> np.ndarray:
    """At rest and pressed; shape (2, H, W, 3), RGB."""
    motion = wb.Press(target_mm=place_mm, depth_mm=DEPTH_MM, frames=2)
    ball, settings = wb.Indenter(size_mm=BALL_MM), wb.ContactSettings(grid_mm=1.0)
    return wb.evaluate(twin, ball, motion, settings=settings, project=project).images


def _place(azimuth_deg: float, radius_mm: float, top_mm: float) -> tuple[float, float, float]:
    """A place on the dome [mm], sensor frame."""
    azimuth, elevation = np.deg2rad(azimuth_deg), np.deg2rad(ELEVATION_DEG)
    aside_mm = radius_mm * np.cos(elevation)
    height_mm = top_mm - radius_mm * (1.0 - np.sin(elevation))
    x_mm, y_mm = aside_mm * np.cos(azimuth), aside_mm * np.sin(azimuth)
    return float(x_mm), float(y_mm), float(height_mm)


def _png(rgb: np.ndarray) -> bytes:
    """A picture as the bytes of a file."""
    return cv2.imencode(".png", rgb[:, :, ::-1])[1].tobytes()
