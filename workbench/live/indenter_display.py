"""Meshes that show an indenter: the zero of the very distance that contact uses.

Spheres, cubes, cones, cylinders and loaded meshes have meshes of their own. All other kinds are
contoured (flying edges) from their sampled distance, on a grid as fine as the smallest feature
asks. A loaded mesh is shown with its texture, by moved vertices, but without its rounding.
"""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Shape
from workbench.core.press.indenter import Indenter

FINEST_MM, COARSEST_SHARE = 0.05, 1.0 / 45.0
"""Limits of the grid that is contoured: an edge, and one over the size."""
STEPS_PER_RADIUS = 3.0
MOST_SHOWN = 1_000_000
"""Samples of the distance that is contoured."""
EDGES_PER_FLANK = 2.0
MOST_TRIANGLES = 200_000
"""Triangles of a loaded mesh after subdivision."""


def display_mesh(indenter: Indenter) -> tuple[np.ndarray, np.ndarray]:
    """Closed outward mesh of any indenter in its body frame.

    Returns:
        Points [mm], shape (N, 3), float64; faces, shape (M, 3), int32.

    Raises:
        DesignError: If the shape cannot be made.
    """
    from geometry.objects.indenters import primitive_mesh

    if indenter.mesh is not None:
        points, faces = primitive_mesh(indenter)
        return _displaced(indenter, points, faces) if indenter.texture.raised else (points, faces)
    if indenter.record.shape is Shape.GRID or indenter.texture.raised:
        return _contoured(indenter)
    return primitive_mesh(indenter)


def _contoured(indenter: Indenter) -> tuple[np.ndarray, np.ndarray]:
    from geometry.surface.isosurface import isosurface
    from sim.contact.objects import textures
    from sim.contact.objects.object_measures import exact_distance, sharpest_mm
    from sim.contact.objects.samples import make_grid
    from sim.contact.objects.sampling import box_mm

    sharpest = min(sharpest_mm(indenter), textures.sharpest_mm(indenter.texture))
    step_mm = max(sharpest / STEPS_PER_RADIUS, FINEST_MM)
    step_mm = min(step_mm, COARSEST_SHARE * indenter.size_mm)
    grid = make_grid(*box_mm(indenter), spacing_mm=step_mm, most=MOST_SHOWN)
    function = exact_distance(indenter)
    if indenter.texture.raised:
        field = textures.heights(indenter.texture, grid.spacing_mm)
        function = textures.textured(function, field, float(box_mm(indenter)[1][2]))
    found = isosurface(function(grid.places()).reshape(grid.shape), grid.origin_mm, grid.spacing_mm)
    assert found is not None, "every kind has an inside"
    return found


def _displaced(
    indenter: Indenter, points: np.ndarray, faces: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """A loaded mesh with the vertices of its lower side moved by the texture."""
    import trimesh

    from sim.contact.objects import textures

    flank_mm = min(indenter.texture.flank_mm, indenter.size_mm / 20.0)
    while len(faces) < MOST_TRIANGLES // 4:
        edges = np.roll(points[faces], -1, axis=1) - points[faces]
        if np.linalg.norm(edges, axis=2).max() < flank_mm / EDGES_PER_FLANK:
            break
        points, faces, *_ = trimesh.remesh.subdivide(points, faces)
    field = textures.heights(indenter.texture, flank_mm / EDGES_PER_FLANK)
    moved = textures.displaced(points, field, float(points[:, 2].max()))
    return moved, np.asarray(faces, dtype=np.int32)
