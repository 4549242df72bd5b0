"""Arducam OV9282 on a board of Luxonis: grey, global shutter, fixed at 20 cm and beyond."""

from __future__ import annotations

from workbench.core.catalogue.camera_part import CameraPart

CAMERA = CameraPart(
    title="Luxonis OAK-FFC-OV9282",
    image_sensor="OmniVision OV9282",
    source="https://docs.luxonis.com/projects/hardware/en/latest/pages/BG0250TG",
    sources={
        "view_x_deg": "https://docs.luxonis.com/hardware/products/OAK-FFC-OV9282.md",
        "view_y_deg": "https://docs.luxonis.com/hardware/products/OAK-FFC-OV9282.md",
    },
    pixels=(1280, 800),
    image_px=(1280, 800),
    view_x_deg=80.0,
    view_y_deg=55.0,
    focal_mm=2.35,
    stop=2.0,
    pixel_um=3.0,
    width_mm=25.0,
    height_mm=24.0,
)
