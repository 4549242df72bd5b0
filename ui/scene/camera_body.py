"""What a camera looks like in the 3D view: a barrel behind its pinhole, and a lens before it.

The same for every camera: no design knows the housing of the camera that is bought for it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

BARREL_COLOUR = (38, 40, 46)
LENS_COLOUR = (40, 70, 150)
BARREL_MM = ((0.0, -2.6), (1.5, -2.6), (1.5, -0.3), (1.15, -0.3), (1.15, -0.55), (0.0, -0.55))
LENS_MM = ((1.15, -0.5), (1.0, -0.28), (0.65, -0.1), (0.3, -0.02), (0.0, 0.0))
"""Radius and place along the axis of the outlines, z forward from the pinhole [mm]."""
AROUND = 28


def add_camera_body(api: Any, camera: str) -> None:
    """Put both below the node of a camera, which they follow."""
    for part, outline, colour in (
        ("barrel", BARREL_MM, BARREL_COLOUR),
        ("lens", LENS_MM, LENS_COLOUR),
    ):
        points, faces = turned(outline)
        api.add_mesh_simple(
            f"{camera}/{part}",
            points,
            faces,
            color=colour,
            flat_shading=part == "barrel",
            side="double",
        )


def turned(outline_mm: tuple[tuple[float, float], ...]) -> tuple[np.ndarray, np.ndarray]:
    """A body of revolution about z: vertices [mm] (N, 3) and triangles (M, 3).

    Args:
        outline_mm: Radius and height of the corners of its outline.
    """
    from trimesh.creation import revolve

    body = revolve(np.array(outline_mm), sections=AROUND)
    return body.vertices.astype(np.float32), body.faces.astype(np.uint32)
