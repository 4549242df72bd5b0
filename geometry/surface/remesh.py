"""Even triangles on any closed surface: what skins are made of where there are no hexahedra.

Isotropic explicit remeshing (Botsch and Kobbelt, A remeshing approach to multiresolution
modelling, 2004) as MeshLab does it: edges are split, collapsed and flipped toward one length, and
vertices slide on the original surface; edges of the body sharper than 35 degrees are kept. It
runs in two passes, so that small features survive: numbered regions much smaller than the others
(pins) and what touches them first, with a shorter edge; then all the rest.

Leaves out: edges that grow with flatness.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.meshlab import isotropic
from geometry.surface.surface import face_areas, is_watertight
from geometry.surface.transfer import face_regions, nearest_source
from workbench.core.base.errors import MeshingError
from workbench.core.result.results import NO_NUMBER, Label, LabelledSurface

RIM_MM = 0.05
"""Vertices of base faces nearer to z = 0 than this are put there [mm]."""
SPAN = 18.0
"""A numbered region is divided at least this finely over the root of its area."""


def remesh(surface: LabelledSurface, edge_mm: float) -> LabelledSurface:
    """The surface in triangles with edges of about `edge_mm`, regions carried over.

    Args:
        surface: Closed surface.
        edge_mm: Edge of a triangle; shorter on small numbered regions.

    Raises:
        MeshingError: If pymeshlab is not installed, or the result is not closed.
    """
    points, faces = surface.points_mm, surface.faces
    fine_mm, small = _small_regions(surface, edge_mm)
    if small.any():
        touched = np.zeros(len(points), dtype=bool)
        touched[faces[small]] = True
        points, faces = isotropic(
            points, faces, fine_mm, np.flatnonzero(touched[faces].any(axis=1))
        )
        kept = small[nearest_source(surface, points, faces)]
        points, faces = isotropic(points, faces, edge_mm, np.flatnonzero(~kept))
    else:
        points, faces = isotropic(points, faces, edge_mm, None)
    if not is_watertight(faces):
        raise MeshingError(
            f"the surface is not closed after remeshing to {edge_mm:g} mm",
            hint="lower meshing.hex_mm, or change the last shape parameter a little",
            at="meshing.hex_mm",
        )
    labels, numbers = face_regions(surface, points, faces)
    # Vertices slide along creases on chords, so a few of the base's rim rise by micrometres.
    rim = np.unique(faces[(labels & Label.BASE) != 0])
    points[rim, 2] = np.where(np.abs(points[rim, 2]) < RIM_MM, 0.0, points[rim, 2])
    return LabelledSurface(points_mm=points, faces=faces, labels=labels, numbers=numbers)


def _small_regions(surface: LabelledSurface, edge_mm: float) -> tuple[float, np.ndarray]:
    """Edge for the smallest numbered region [mm], and the faces of those that need less."""
    small = np.zeros(len(surface.faces), dtype=bool)
    finest_mm = edge_mm
    areas = face_areas(surface.points_mm, surface.faces)
    for number in np.unique(surface.numbers[surface.numbers != NO_NUMBER]):
        members = surface.numbers == number
        wanted_mm = float(np.sqrt(areas[members].sum())) / SPAN
        if wanted_mm < edge_mm:
            small |= members
            finest_mm = min(finest_mm, wanted_mm)
    return finest_mm, small
