"""Cheap shapes for the 3D view: regions of a body, a standing object, clicks, cells of a mesh.

Everything here takes milliseconds on the largest body; what takes longer is a stage.
"""

from __future__ import annotations

import itertools

import numpy as np

from geometry.surface.surface_place import SkinPlace
from geometry.volume.quality import CELL_EDGES, volume_quality
from workbench.core.base.frames import quaternion, tangent
from workbench.core.result.quality import MeshQuality
from workbench.core.result.results import Label, LabelledSurface, Skin, VolumeMesh, region_masks

LEAST_SINE = 1e-12
"""Rays flatter to a triangle than this do not meet it."""
USUAL_VIEW = np.array([0.51, -0.77, 0.38])
"""Unit direction toward the eye that people expect: from the front, a little from above."""
UNUSUAL_MM = 0.5
"""Material that one looks through rather than from the opposite side, per unit of 1 - cosine."""
EDGE_ON_MM = 1.0
"""Material that one looks through rather than at a surface edge-on."""
SLANT_COSINES = (0.55, 0.75)
"""Cosine between the normal at a contact and the way to an eye that sees it beside its object."""
SLANT_SHARE = 3.0
"""Weight of a slant that is missed, over that of the way from the side one looks from anyway."""
HEIGHTS = (0.3, 0.5, 0.7)
"""Upright parts of the directions from which a contact is looked at."""
AROUND = 16
"""How many directions of each height there are."""
NEAR_MM = 2.5
"""How far around a contact the skin is to be seen as well."""
CELL_SIDES = {
    8: ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    4: ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)),
}
"""Corners of the faces of a cell in VTK order, by its number of corners."""
PLANE_MM = 1e-3
"""Faces nearer to the base plane than this lie on it [mm]."""


def outer_faces(surface: LabelledSurface) -> tuple[np.ndarray, np.ndarray]:
    """The sensing side of a body: its vertices [mm] (N, 3) and triangles (M, 3)."""
    return _packed(surface, surface.has(Label.OUTER))


def skin_parts(surface: LabelledSurface) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """What is drawn of a membrane, each as vertices [mm] (N, 3) and triangles (M, 3).

    `skin` is the sensing side without `actuator_i`; `pins` are internal; `unsensed` are faces off
    the base plane that the designer took out of the sensing side.
    """
    masks = region_masks(surface.labels, surface.numbers)
    actuators = {name: mask for name, mask in masks.items() if name.startswith("actuator")}
    driven = surface.has(Label.ACTUATOR)
    off_plane = np.abs(surface.points_mm[surface.faces][:, :, 2]).max(axis=1) > PLANE_MM
    parts = {
        "skin": surface.has(Label.OUTER) & ~driven,
        **actuators,
        "pins": surface.has(Label.PIN),
        "unsensed": surface.has(Label.BASE) & off_plane,
    }
    return {name: _packed(surface, mask) for name, mask in parts.items() if mask.any()}


def _packed(surface: LabelledSurface, mask: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    faces = surface.faces[mask]
    used, packed = np.unique(faces, return_inverse=True)
    return np.asarray(surface.points_mm)[used], packed.reshape(faces.shape)


def first_hit(
    points_mm: np.ndarray,
    faces: np.ndarray,
    origin: np.ndarray,
    direction: np.ndarray,
    *,
    both_sides: bool = False,
) -> tuple[int, np.ndarray] | None:
    """The face a ray enters first from outside, and where [mm]; None when it misses.

    Source: Moeller and Trumbore, Journal of Graphics Tools 2, 1997.

    Args:
        points_mm: Vertices, shape (N, 3).
        faces: Triangles counter-clockwise from outside, shape (M, 3).
        origin: Start of the ray [mm], shape (3,).
        direction: Unit direction, shape (3,).
        both_sides: Whether faces are met from inside as well.
    """
    a, b, c = (np.asarray(points_mm)[faces[:, i]] for i in range(3))
    edge_1, edge_2, offset = b - a, c - a, origin - a
    across = np.cross(direction, edge_2)
    volume = np.einsum("ij,ij->i", edge_1, across)
    front = (np.abs(volume) if both_sides else volume) > LEAST_SINE
    scale = 1.0 / np.where(front, volume, 1.0)
    u = np.einsum("ij,ij->i", offset, across) * scale
    turned = np.cross(offset, edge_1)
    v = turned @ direction * scale
    along = np.einsum("ij,ij->i", edge_2, turned) * scale
    met = front & (u >= 0) & (v >= 0) & (u + v <= 1) & (along > 0)
    if not met.any():
        return None
    best = int(np.argmin(np.where(met, along, np.inf)))
    return best, origin + along[best] * np.asarray(direction)


def clear_view(
    points_mm: np.ndarray, faces: np.ndarray, place_mm: np.ndarray, distance_mm: float
) -> np.ndarray:
    """Unit direction from a place toward an eye that sees it, shape (3,).

    Of 24 directions the one with the least material before the place; of equals the one nearest
    to `USUAL_VIEW`. A place inside a wall is seen through its thinner side.

    Args:
        points_mm: Vertices of what may stand in the way, shape (N, 3).
        faces: Triangles counter-clockwise from outside, shape (M, 3).
        place_mm: The place, shape (3,).
        distance_mm: From the place to the eye.
    """
    place = np.asarray(place_mm, dtype=float)
    best, least = USUAL_VIEW, np.inf
    for axis in itertools.product((-1.0, 0.0, 1.0), repeat=3):
        # Straight down the upright axis a turntable camera has no up.
        if axis[0] == axis[1] == 0.0:
            continue
        toward = np.array(axis) / np.linalg.norm(axis)
        hit = first_hit(points_mm, faces, place + distance_mm * toward, -toward)
        before_mm = -np.inf if hit is None else float((hit[1] - place) @ toward)
        # A ray that passes the place without meeting it sees its surface edge-on.
        blocked_mm = before_mm if before_mm > -PLANE_MM else EDGE_ON_MM
        cost = blocked_mm + UNUSUAL_MM * (1.0 - float(toward @ USUAL_VIEW))
        if cost < least:
            best, least = toward, cost
    return best


def contact_side(
    points_mm: np.ndarray, faces: np.ndarray, place: SkinPlace, usual: np.ndarray
) -> np.ndarray:
    """Unit direction from a contact toward an eye that sees it beside its object, shape (3,).

    Straight along the normal the object hides the contact, and at grazing angles it is a line: of
    the directions between, nearest to where one looks from anyway, the first that the body does
    not hide. Of a contact that is hidden from everywhere above, the one with the best angle.

    Args:
        points_mm: Vertices of what may stand in the way, shape (N, 3).
        faces: Triangles counter-clockwise from outside, shape (M, 3).
        place: The middle of the contact.
        usual: Unit direction from which the body is looked at anyway, shape (3,).
    """
    turns = 2.0 * np.pi * np.arange(AROUND) / AROUND
    up, turn = (grid.ravel() for grid in np.meshgrid(HEIGHTS, turns))
    flat = np.sqrt(1.0 - up**2)
    ways = np.stack([flat * np.cos(turn), flat * np.sin(turn), up], axis=1)
    ways = np.vstack([usual, ways])
    slant = ways @ place.normal
    missed = np.abs(slant - np.clip(slant, *SLANT_COSINES))
    order = np.argsort(SLANT_SHARE * missed + 1.0 - ways @ usual, kind="stable")
    side = tangent(place.normal)
    other = np.cross(place.normal, side)
    above = place.point_mm + NEAR_MM * place.normal / 2.0
    around = NEAR_MM * np.array([0.0 * side, side, -side, other, -other])
    for way in ways[order]:
        starts = above + around
        if all(first_hit(points_mm, faces, at, way, both_sides=True) is None for at in starts):
            return way
    return ways[order[0]]


def cell_edges(corners_mm: np.ndarray) -> np.ndarray:
    """Ends of the edges of one cell [mm], shape (E, 2, 3), from its corners (8|4|3, 3)."""
    return np.asarray(corners_mm)[np.array(CELL_EDGES[len(corners_mm)])]


def mesh_edges(mesh: VolumeMesh | Skin) -> np.ndarray:
    """Ends of the edges on the outside of a mesh [mm], shape (E, 2, 3), each edge once.

    The outside of a volume mesh are the faces that one cell alone has; a skin is all outside.
    """
    faces = mesh.faces if isinstance(mesh, Skin) else _boundary(np.asarray(mesh.cells))
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges = np.unique(np.sort(ends, axis=1), axis=0)
    return np.asarray(mesh.points_mm)[edges]


def _boundary(cells: np.ndarray) -> np.ndarray:
    """Faces of hexahedra (M, 8) or tetrahedra (M, 4) that no other cell has, (B, 4) or (B, 3)."""
    faces = cells[:, np.array(CELL_SIDES[cells.shape[1]])].reshape(-1, 3 + (cells.shape[1] == 8))
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    return faces[first[count == 1]]


def judged(mesh: VolumeMesh, volume_mm3: float) -> MeshQuality:
    """How good the cells of a volume mesh are, beside the volume of its body [mm3]."""
    return volume_quality(mesh, volume_mm3)


def corner_normals(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Area-weighted unit normals at the vertices, shape (N, 3)."""
    a, b, c = (points_mm[faces[:, i]] for i in range(3))
    normals = np.zeros_like(points_mm)
    for i in range(3):
        np.add.at(normals, faces[:, i], np.cross(b - a, c - a))
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


def standing_pose(place: SkinPlace, lowest_mm: float) -> np.ndarray:
    """x, y, z [mm], qw, qx, qy, qz of an indenter that stands at a place of the skin.

    For the eye only: the solver finds first touch exactly.

    Args:
        place: Where it stands.
        lowest_mm: Extent of the indenter below its body origin.
    """
    tangent_u = tangent(place.normal)
    rotation = np.stack([tangent_u, np.cross(place.normal, tangent_u), place.normal], axis=1)
    return np.r_[place.point_mm + place.normal * lowest_mm, quaternion(rotation)]
