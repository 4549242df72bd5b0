"""A surface of loose triangles to closed ones, by repairs that change nothing that was meant.

Safe are: vertices that lie within a thousandth of a percent of the body's size, doubled and
collapsed triangles, a body that is inside out, flat openings (the open foot of a skin) and holes
smaller than a twentieth of the body. What is left is `Damaged`, with its place.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.holes import Damaged, close_holes
from geometry.surface.meshlab import crossing_faces
from geometry.surface.offset import inside
from geometry.surface.surface import face_areas, mesh_volume, open_edges, pieces
from workbench.core.base.errors import DesignError

MERGE_SHARE = 1e-5
"""Vertices nearer than this share of the body's size are one."""
STRAY_SHARE = 1e-5
"""Pieces with less than this share of the largest piece's area are debris: 0.1 mm on a finger."""
SHEET_SHARE = 1e-6
"""Volume over that of the bounding box below which a surface encloses nothing."""
LOOKED_AT = 50
"""Vertices of a piece by which it is told whether it lies inside another."""

Triangles = tuple[np.ndarray, np.ndarray]
"""Vertices (N, 3) and triangles (M, 3)."""


def mended(
    points: np.ndarray, faces: np.ndarray, name: str, notes: list[str]
) -> tuple[Triangles, Triangles | None]:
    """The one closed body of a file, and the hollow inside it where it is double-walled.

    Both face outward. What was done is added to `notes`.

    Raises:
        Damaged: If there are several bodies, larger holes, or faces that cut through each other.
        DesignError: If it encloses nothing.
    """
    points, faces = _merged(points, faces, notes)
    kept = _kept(points, faces, notes)
    hollow = _nested(points, kept)
    if hollow is not None:
        outer, inner = (_packed(points, _outward(points, part)) for part in hollow)
        notes.append("it is a shell already, so its two sides are used")
        expect_simple(*outer, name)
        expect_simple(*inner, name)
        return outer, inner
    if len(kept) > 1:
        refuse_count(name, [abs(mesh_volume(points, part)) for part in kept])
    faces = _consistent(points, kept[0], notes)
    points, faces = _packed(*close_holes(points, faces, name, notes))
    volume = mesh_volume(points, faces)
    size = float(np.ptp(points, axis=0).max())
    if abs(volume) <= SHEET_SHARE * size**3:
        raise DesignError(f"{name} encloses no volume", hint="export a solid body, not a sheet")
    if volume < 0.0:
        faces = faces[:, ::-1]
        notes.append("it was inside out and has been turned")
    expect_simple(points, faces, name)
    return (points, np.ascontiguousarray(faces, dtype=np.int32)), None


def facing_outward(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Triangles (M, 3), piece by piece turned away from the middle, open pieces as well.

    What a winding number needs of a surface that could not be mended.
    """
    faces = _consistent(points, _merged(points, faces, [])[1], [])
    number, middle = pieces(faces), points[faces].mean(axis=(0, 1))
    corners = points[faces] - middle
    held = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    wrong = np.bincount(number, held)[number] < 0.0
    return np.where(wrong[:, None], faces[:, ::-1], faces)


def refuse_count(name: str, volumes: list[float]) -> None:
    """Refuse a file that holds no body, or several.

    Raises:
        Damaged: With the number of bodies and their volumes.
    """
    if not volumes:
        raise Damaged(
            f"{name} holds no solid body",
            hint="export a closed solid, not surfaces or wires",
        )
    sizes = ", ".join(f"{volume:.4g}" for volume in sorted(volumes, reverse=True)[:4])
    raise Damaged(
        f"{name} holds {len(volumes)} bodies (volumes {sizes} in the file's unit), a membrane is "
        "one",
        hint="union parts that belong together; a body that hollows the other is the inner file",
    )


def expect_simple(points: np.ndarray, faces: np.ndarray, name: str) -> None:
    """Refuse faces that cut through each other.

    Raises:
        Damaged: With their number and place.
    """
    crossing = crossing_faces(points, faces)
    if crossing.any():
        x, y, z = points[faces[crossing]].mean(axis=(0, 1))
        raise Damaged(
            f"{np.count_nonzero(crossing)} of {len(crossing)} faces of {name} cut through each "
            f"other, near ({x:.3g}, {y:.3g}, {z:.3g}) in the file's own coordinates",
            hint="repair it in the program that made it: union the parts, or remove the fold",
        )


def _merged(
    points: np.ndarray, faces: np.ndarray, notes: list[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Without doubled triangles; where edges are open, with near vertices made one."""
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    if len(first) < len(faces):
        notes.append(f"{len(faces) - len(first)} doubled triangles were removed")
        faces = faces[np.sort(first)]
    if not open_edges(faces):
        return points, faces
    reach = MERGE_SHARE * float(np.ptp(points, axis=0).max())
    _, group = np.unique(np.round(points / reach), axis=0, return_inverse=True)
    count = int(group.max()) + 1
    if count == len(points):
        return points, faces
    notes.append(f"{len(points) - count} vertices were merged with a neighbour")
    merged = np.zeros((count, 3))
    merged[group.ravel()] = points
    faces = group.ravel()[faces]
    return merged, faces[np.all(faces != np.roll(faces, 1, axis=1), axis=1)]


def _kept(points: np.ndarray, faces: np.ndarray, notes: list[str]) -> list[np.ndarray]:
    """Triangles of each piece that is not debris, the largest first."""
    piece = pieces(faces)
    area = np.bincount(piece, face_areas(points, faces))
    kept = np.flatnonzero(area > STRAY_SHARE * area.max())
    if len(kept) < len(area):
        notes.append(f"{len(area) - len(kept)} loose pieces of debris were removed")
    return [faces[piece == k] for k in kept[np.argsort(-area[kept])]]


def _nested(points: np.ndarray, kept: list[np.ndarray]) -> list[np.ndarray] | None:
    """The two closed pieces of a double-walled body, the outer first; None if it is none."""
    if len(kept) != 2 or any(open_edges(part) for part in kept):
        return None
    outer, inner = kept
    corners = np.unique(inner)
    looked = points[corners[:: max(1, len(corners) // LOOKED_AT)]]
    found = inside(points, _outward(points, outer), looked)
    return kept if found.all() else None


def _outward(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    return faces if mesh_volume(points, faces) > 0.0 else faces[:, ::-1]


def _packed(points: np.ndarray, faces: np.ndarray) -> Triangles:
    """Without vertices that no triangle has."""
    used, packed = np.unique(faces, return_inverse=True)
    return points[used], np.ascontiguousarray(packed.reshape(-1, 3), dtype=np.int32)


def _consistent(points: np.ndarray, faces: np.ndarray, notes: list[str]) -> np.ndarray:
    """Triangles that all turn the same way round."""
    start, stop = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    span = int(faces.max()) + 1
    if len(np.unique(start * span + stop)) == len(start):
        return faces
    import trimesh

    mesh = trimesh.Trimesh(points, faces, process=False)
    trimesh.repair.fix_winding(mesh)
    notes.append("triangles that faced the wrong way were turned")
    return np.asarray(mesh.faces, dtype=np.int64)
