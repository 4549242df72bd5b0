"""Raspberry Pi Camera Module 1: 5 megapixels, fixed at 1 m and beyond as it is sold."""

from __future__ import annotations

from workbench.core.catalogue.camera_part import CameraPart

CAMERA = CameraPart(
    title="Raspberry Pi Camera Module 1",
    image_sensor="OmniVision OV5647",
    source="https://www.raspberrypi.com/documentation/accessories/camera.html",
    sources={
        "image_px": "https://github.com/techyian/MMALSharp/wiki/OmniVision-OV5647-Camera-Module",
        "full_well_e": "https://cdn.shopify.com/s/files/1/1509/1638/files/TechSpecs.pdf",
    },
    pixels=(2592, 1944),
    image_px=(1296, 972),
    view_x_deg=53.5,
    view_y_deg=41.41,
    focal_mm=3.6,
    stop=2.9,
    sensor_width_mm=3.76,
    pixel_um=1.4,
    width_mm=25.0,
    height_mm=24.0,
    depth_mm=9.0,
    full_well_e=4300.0,
)
