"""Skins: the sensing surface, the face behind it, and the air side of the support.

Where there are hexahedra the skins are their own boundary, every quadrilateral split along its
shorter diagonal; elsewhere they are regions of an evenly remeshed surface.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.body.solid import COARSE_TOLERANCE_MM, TOLERANCE_MM
from geometry.surface.rays import RayCaster
from geometry.surface.remesh import remesh
from geometry.surface.surface import face_areas, pieces, vertex_normals
from geometry.surface.transfer import face_regions
from geometry.volume.curved import CurvedSurface
from geometry.volume.ogrid import Pace, axis_of, on_base, ray_grid
from workbench.core.base.errors import MeshingError
from workbench.core.result.results import Label, LabelledSurface, MembraneMesh, Skin, Solid

CAVITY_EDGE_MM = 0.65
"""Cell of the cavity skin [mm], so that no diagonal exceeds 1 mm; it only refracts light."""
REMESHED_EDGE_MM = 0.52
"""Mean edge where rays do not do [mm]; the longest is about twice that."""
LONGEST_EDGE_MM = 1.0
FINEST_CAVITY_MM = 0.45
"""Grids finer than this cost more than remeshing, and only one long edge asks for them."""
LOOKS = 16
CAVITY_AREA = 0.005
"""Relative error of area above which rays have cut corners of the cavity."""


def quad_skin(points_mm: np.ndarray, quads: np.ndarray) -> tuple[Skin, np.ndarray]:
    """Triangles of quadrilaterals (Q, 4), and the number of each of its vertices, shape (V,)."""
    corner = points_mm[quads]
    diagonals = np.linalg.norm(corner[:, [0, 1]] - corner[:, [2, 3]], axis=2)
    # Equal to rounding counts as equal, or noise would decide which way squares are split.
    first = diagonals[:, 0] <= diagonals[:, 1] * (1.0 + 1e-6)
    split = np.where(
        first[:, None, None], quads[:, [[0, 1, 2], [0, 2, 3]]], quads[:, [[0, 1, 3], [1, 2, 3]]]
    )
    return _compact(points_mm, split.reshape(-1, 3))


def region_skin(surface: LabelledSurface, side: Label) -> Skin:
    """The faces of one side of a closed surface, turned to point out of the sensor.

    Raises:
        MeshingError: If there is no such face.
    """
    chosen = surface.has(side)
    faces = labelled_faces(surface, side)
    turned = faces[:, ::-1] if side is Label.INNER else faces
    skin, _ = _compact(surface.points_mm, turned)
    return Skin(
        points_mm=skin.points_mm,
        faces=skin.faces,
        normals=skin.normals,
        labels=surface.labels[chosen],
        numbers=surface.numbers[chosen],
    )


def with_regions(skin: Skin, source: LabelledSurface, side: Label) -> Skin:
    """The skin with labels and numbers of the source's faces on that side."""
    labels, numbers = face_regions(part_of(source, side), skin.points_mm, skin.faces)
    return Skin(
        points_mm=skin.points_mm,
        faces=skin.faces,
        normals=skin.normals,
        labels=labels,
        numbers=numbers,
    )


def rough_skins(solid: Solid) -> MembraneMesh:
    """The skins of a body as it was tessellated: long triangles on straight walls, no hexahedra.

    Made in a hundredth of a second, for looking at where things are; nothing can be pressed on it.

    Raises:
        MeshingError: If a region has no face.
    """
    return MembraneMesh(
        hexes=None,
        outer=region_skin(solid.membrane, Label.OUTER),
        inner=region_skin(solid.membrane, Label.INNER),
        cavity=region_skin(_facing_the_camera(solid.support), Label.INNER),
        tips_mm=solid.tips_mm,
        tip_radius_mm=solid.tip_radius_mm,
        backing_mm=solid.backing_mm,
    )


def cavity_skin(support: LabelledSurface) -> Skin:
    """The air side of the support, open at its base, with edges of at most about 1 mm.

    An even grid of rays where the axis sees all of it and it has no edges, else remeshed.

    Raises:
        MeshingError: If the support has no such face.
    """
    support = _facing_the_camera(support)
    wanted_mm2 = float(face_areas(support.points_mm, labelled_faces(support, Label.INNER)).sum())
    spacing_mm = CAVITY_EDGE_MM
    try:
        while spacing_mm > FINEST_CAVITY_MM:
            skin = _cavity_grid(support, spacing_mm)
            found_mm2 = float(face_areas(skin.points_mm, skin.faces).sum())
            if abs(found_mm2 - wanted_mm2) > CAVITY_AREA * wanted_mm2:
                break
            longest_mm = _longest_edge_mm(skin)
            if longest_mm <= LONGEST_EDGE_MM:
                return with_regions(skin, support, Label.INNER)
            spacing_mm *= 0.97 * LONGEST_EDGE_MM / longest_mm
    except MeshingError:
        # Rays from the axis miss a wall that is bent or hollowed; triangles do not mind.
        pass
    return region_skin(remesh(support, REMESHED_EDGE_MM), Label.INNER)


def _facing_the_camera(support: LabelledSurface) -> LabelledSurface:
    """The support with only those faces INNER that rays from low on the axis meet first.

    A support that stands off from a backed skin has faces toward the gap too.
    """
    members = np.flatnonzero(support.has(Label.INNER))
    faces = labelled_faces(support, Label.INNER)
    piece = pieces(faces)
    turn = np.arange(LOOKS) / LOOKS * 2.0 * np.pi
    around = np.column_stack([np.cos(turn), np.sin(turn), np.full(LOOKS, 0.1)])
    height = support.points_mm[faces, 2]
    low_mm = 0.9 * max(float(height.min()), 0.0) + 0.1 * float(height.max())
    start = np.broadcast_to([0.0, 0.0, low_mm], around.shape)
    met = RayCaster(support.points_mm, faces).hits(start, around)[1]
    if not (met >= 0).any():
        return support
    seen = np.bincount(piece[met[met >= 0]]).argmax()
    labels = support.labels.copy()
    labels[members[piece != seen]] = Label.OUTER
    return dataclasses.replace(support, labels=labels)


def _cavity_grid(support: LabelledSurface, spacing_mm: float) -> Skin:
    region = curved_region(support, Label.INNER, sagitta_mm=COARSE_TOLERANCE_MM)
    points = support.points_mm[labelled_faces(support, Label.INNER)].reshape(-1, 3)
    grid = ray_grid(region, axis_of(points), Pace(spacing_mm))
    return quad_skin(on_base(region.points(grid.origins, grid.directions), grid), grid.quads)[0]


def _longest_edge_mm(skin: Skin) -> float:
    corner = skin.points_mm[skin.faces]
    return float(np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2).max())


def labelled_faces(surface: LabelledSurface, label: Label) -> np.ndarray:
    """Faces with a label, shape (F, 3).

    Raises:
        MeshingError: If there are none.
    """
    faces = surface.faces[surface.has(label)]
    if not len(faces):
        raise MeshingError(
            f"the body has no {label.name} face",
            hint="check that the wall is closed and thicker than 0.1 mm",
            at="shape",
        )
    return faces


def part_of(surface: LabelledSurface, label: Label) -> LabelledSurface:
    """The faces with a label as a surface of their own, open."""
    used, faces = np.unique(labelled_faces(surface, label), return_inverse=True)
    chosen = surface.has(label)
    return LabelledSurface(
        points_mm=surface.points_mm[used],
        faces=faces.reshape(-1, 3).astype(np.int32),
        labels=surface.labels[chosen],
        numbers=surface.numbers[chosen],
    )


def curved_region(
    surface: LabelledSurface, label: Label, *, sagitta_mm: float = TOLERANCE_MM
) -> CurvedSurface:
    """The smooth surface through the faces with a label, whose chords are off by `sagitta_mm`."""
    part = part_of(surface, label)
    return CurvedSurface(part.points_mm, part.faces, sagitta_mm=sagitta_mm)


def _compact(points_mm: np.ndarray, faces: np.ndarray) -> tuple[Skin, np.ndarray]:
    """A skin of the vertices that faces use, and their numbers."""
    used, renumbered = np.unique(faces, return_inverse=True)
    triangles = renumbered.reshape(-1, 3).astype(np.int32)
    points = points_mm[used]
    return Skin(points_mm=points, faces=triangles, normals=vertex_normals(points, triangles)), used
