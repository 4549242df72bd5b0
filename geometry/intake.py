"""A designer's file to a closed surface in mm: read, repaired where that is safe, and said so.

Safe are: vertices that lie within a thousandth of a percent of the body's size, doubled and
collapsed triangles, a body that is inside out, flat openings (the open foot of a skin) and holes
smaller than a twentieth of the body. Refused, with place and remedy: several bodies, larger holes,
faces that cut through each other, files that enclose nothing.
"""

from __future__ import annotations

import numpy as np

from geometry.cad_file import read_cad
from geometry.holes import close_holes
from geometry.meshlab import crossing_faces
from geometry.solid import weld
from geometry.stl import stl_corners, welded
from geometry.surface import face_areas, mesh_volume, open_edges, pieces
from workbench.core.errors import DesignError, MeshingError
from workbench.core.imported import (
    BodyFile,
    FileKind,
    ImportedBody,
    LengthUnit,
    ReadBody,
    ReadSurface,
)
from workbench.core.monitor import Monitor, silent

OUTER, INNER = "outer", "inner"
MM_PER = {LengthUnit.MM: 1.0, LengthUnit.CM: 10.0, LengthUnit.M: 1000.0, LengthUnit.INCH: 25.4}
LIKELY_MM = (8.0, 200.0)
"""Sizes that a tactile sensor may have: what an unknown unit is judged by [mm]."""
MERGE_SHARE = 1e-5
"""Vertices nearer than this share of the body's size are one."""
STRAY_SHARE = 1e-5
"""Pieces with less than this share of the largest piece's area are debris: 0.1 mm on a finger."""
SHEET_SHARE = 1e-6
"""Volume over that of the bounding box below which a surface encloses nothing."""
SMOOTH_COSINE = 0.866
"""Neighbouring triangles of an STL that differ by less than 30 degrees are one patch."""


def read_body(body: ImportedBody, monitor: Monitor = silent) -> ReadBody:
    """Read the outer body and, where there is one, the inner.

    Raises:
        DesignError: Saying what is wrong with the file, where, and what to do.
    """
    outer, unit, said = _in_mm(body.outer, body.unit, (OUTER, "body.outer"), monitor)
    inner = None
    if body.inner is not None:
        # Files of one export share their unit; that of a STEP file says nothing about an STL.
        shared = unit if body.outer.kind is FileKind.STL else body.unit
        inner, _, more = _in_mm(body.inner, shared, (INNER, "body.inner"), monitor)
        said += more
    return ReadBody(outer=outer, inner=inner, unit=unit.value, notice="; ".join(said))


def _in_mm(
    file: BodyFile, wanted: LengthUnit, place: tuple[str, str], monitor: Monitor
) -> tuple[ReadSurface, LengthUnit, list[str]]:
    """One file's surface in mm, its unit, and what was done to it.

    Messages name the file, because they are shown once; notices are stored, and the same content
    under another name must read the same, so they name the role, the first of `place`.
    """
    role, at = place
    try:
        surface, notes = (
            _read_step(file, monitor) if file.kind is FileKind.STEP else _read_stl(file)
        )
        _expect_simple(surface, file.name)
        unit = _unit(surface, file, wanted, notes)
    except (DesignError, MeshingError) as error:
        error.at = error.at or at
        raise
    # The CAD kernel has already turned a STEP file's own unit into mm.
    factor = 1.0 if file.kind is FileKind.STEP else MM_PER[unit]
    scaled = ReadSurface(
        points_mm=surface.points_mm * factor, faces=surface.faces, patch=surface.patch
    )
    return scaled, unit, [f"{role} body: {note}" for note in notes]


def _unit(surface: ReadSurface, file: BodyFile, wanted: LengthUnit, notes: list[str]) -> LengthUnit:
    """The unit given, that of a STEP file, or the one that makes an STL as large as a sensor."""
    if file.kind is FileKind.STEP:
        return LengthUnit.MM
    if wanted is not LengthUnit.AUTO:
        return wanted
    size = float(np.ptp(surface.points_mm, axis=0).max())
    low, high = LIKELY_MM
    fits = [unit for unit, factor in MM_PER.items() if low <= size * factor <= high]
    if fits[:1] == [LengthUnit.MM]:
        if len(fits) > 1:
            notes.append(
                f"taken as {size:.3g} mm long; if it is {size * MM_PER[fits[1]]:.3g} mm, choose "
                f"{fits[1].value} as its unit"
            )
        return LengthUnit.MM
    if len(fits) == 1:
        notes.append(f"its numbers were taken as {fits[0].value}")
        return fits[0]
    options = ", ".join(f"{u.value}: {size * MM_PER[u]:.3g} mm" for u in fits or MM_PER)
    raise DesignError(
        f"{file.name} is {size:.3g} units long, and an STL does not say which ({options})",
        hint="choose the unit of the file: mm, cm, m or inch",
        at="body.unit",
    )


def _read_step(file: BodyFile, monitor: Monitor) -> tuple[ReadSurface, list[str]]:
    found = read_cad(file, monitor)
    if len(found.solids_mm3) != 1:
        _refuse_count(file.name, list(found.solids_mm3))
    if not found.sound:
        raise DesignError(
            f"{file.name} holds a solid that the CAD kernel calls invalid: its faces cut "
            "through each other or do not meet",
            hint="repair it in the program that made it, or export it as STL",
        )
    points, faces, patch = weld(found.points_mm, found.faces, found.patch)
    gaps = open_edges(faces)
    if gaps or mesh_volume(points, faces) <= 0.0:
        raise DesignError(
            f"{file.name} cannot be turned into a closed surface: {gaps} edges are open",
            hint="repair it in the program that made it, or export it as STL",
        )
    return ReadSurface(points_mm=points, faces=faces, patch=patch), list(found.notes)


def _read_stl(file: BodyFile) -> tuple[ReadSurface, list[str]]:
    points, faces = welded(stl_corners(file.data.tobytes(), file.name, at=""))
    notes: list[str] = []
    points, faces = _merged(points, faces, notes)
    faces = _one_piece(points, faces, file.name, notes)
    faces = _consistent(points, faces, notes)
    points, faces = close_holes(points, faces, file.name, notes)
    used, packed = np.unique(faces, return_inverse=True)
    points, faces = points[used], packed.reshape(-1, 3)
    volume = mesh_volume(points, faces)
    size = float(np.ptp(points, axis=0).max())
    if abs(volume) <= SHEET_SHARE * size**3:
        raise DesignError(
            f"{file.name} encloses no volume", hint="export a solid body, not a sheet"
        )
    if volume < 0.0:
        faces = faces[:, ::-1]
        notes.append("it was inside out and has been turned")
    faces = np.ascontiguousarray(faces, dtype=np.int32)
    return ReadSurface(points_mm=points, faces=faces, patch=smooth_patches(points, faces)), notes


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


def _one_piece(points: np.ndarray, faces: np.ndarray, name: str, notes: list[str]) -> np.ndarray:
    """Triangles of the only piece, after debris has been dropped."""
    piece = pieces(faces)
    area = np.bincount(piece, face_areas(points, faces))
    kept = np.flatnonzero(area > STRAY_SHARE * area.max())
    if len(kept) > 1:
        _refuse_count(name, [abs(mesh_volume(points, faces[piece == k])) for k in kept])
    if len(area) > 1:
        notes.append(f"{len(area) - 1} loose pieces of debris were removed")
    return faces[piece == kept[0]]


def _refuse_count(name: str, volumes: list[float]) -> None:
    if not volumes:
        raise DesignError(
            f"{name} holds no solid body",
            hint="export a closed solid, not surfaces or wires",
        )
    sizes = ", ".join(f"{volume:.4g}" for volume in sorted(volumes, reverse=True)[:4])
    raise DesignError(
        f"{name} holds {len(volumes)} bodies (volumes {sizes} in the file's unit), a membrane is "
        "one",
        hint="union parts that belong together; a body that hollows the other is the inner file",
    )


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


def _expect_simple(surface: ReadSurface, name: str) -> None:
    """Refuse faces that cut through each other."""
    crossing = crossing_faces(surface.points_mm, surface.faces)
    if crossing.any():
        x, y, z = surface.points_mm[surface.faces[crossing]].mean(axis=(0, 1))
        raise DesignError(
            f"{np.count_nonzero(crossing)} of {len(crossing)} faces of {name} cut through each "
            f"other, near ({x:.3g}, {y:.3g}, {z:.3g}) in the file's own coordinates",
            hint="repair it in the program that made it: union the parts, or remove the fold",
        )


def smooth_patches(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Patches of a closed mesh between edges sharper than 30 degrees, shape (M,), int32."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    corners = points_mm[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    wide = faces.astype(np.int64)
    start, stop = wide.ravel(), np.roll(wide, -1, axis=1).ravel()
    span = int(wide.max()) + 1
    order = np.argsort(start * span + stop)
    across = order[np.searchsorted((start * span + stop)[order], stop * span + start)] // 3
    here = np.repeat(np.arange(len(faces)), 3)
    smooth = np.einsum("ij,ij->i", normal[here], normal[across]) > SMOOTH_COSINE
    links = coo_matrix((np.ones(smooth.sum()), (here[smooth], across[smooth])), [len(faces)] * 2)
    return connected_components(links, directed=False)[1].astype(np.int32)
