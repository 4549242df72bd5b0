"""Blocks of hexahedra in numpy: irregular, graded towards a corner, and as a flat membrane."""

from __future__ import annotations

import numpy as np

from sim.fem.submodel import boundary
from workbench.core.result.results import Label, MembraneMesh, Skin, VolumeMesh

SEED = 7
"""Of the irregular block: the same nodes every time."""


def block(*axes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A block with nodes at every x, y and z of three increasing lists [mm].

    Returns:
        Nodes, shape (N, 3), and cells in VTK order, shape (M, 8).
    """
    points_mm = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(points_mm)).reshape([len(axis) for axis in axes])
    near, far = slice(None, -1), slice(1, None)
    around = ((near, near), (far, near), (far, far), (near, far))
    corners = [number[x, y, z].ravel() for z in (near, far) for x, y in around]
    return points_mm, np.stack(corners, axis=1)


def irregular_block(*, cells: int = 3, shift: float = 0.15) -> tuple[np.ndarray, np.ndarray]:
    """A unit cube whose inner nodes are shifted at random by a share of a cell's edge.

    Returns:
        Nodes, shape (N, 3), and cells, shape (M, 8).
    """
    points_mm, hexes = block(*[np.linspace(0.0, 1.0, cells + 1)] * 3)
    moved = np.random.default_rng(SEED).uniform(-shift, shift, points_mm.shape) / cells
    inside = ~np.isin(np.arange(len(points_mm)), boundary(hexes))
    return points_mm + moved * inside[:, None], hexes


def graded(fine_mm: float, edge_mm: float, length_mm: float, growth: float) -> np.ndarray:
    """Places from 0 to a length: steps of `edge_mm` as far as `fine_mm`, then growing ones."""
    count = max(1, round(fine_mm / edge_mm))
    places = [edge_mm * k for k in range(count + 1)]
    step = edge_mm
    while places[-1] < length_mm:
        step *= growth
        places.append(places[-1] + step)
    places[-1] = length_mm
    # A last step that became a sliver is merged with the one before.
    if len(places) > 2 and places[-1] - places[-2] < 0.5 * (places[-2] - places[-3]):
        del places[-2]
    return np.array(places)


def flat_membrane(
    *,
    width_mm: float = 8.0,
    length_mm: float | None = None,
    height_mm: float = 2.0,
    edge_mm: float = 1.0,
    layers: int = 2,
    gap_mm: float = 0.0,
) -> MembraneMesh:
    """A pad with its inner face at z = 0, bonded there or a gap away from its support.

    Its length along Y is its width where none is given; every side is divided evenly, in edges of
    about `edge_mm`.

    Above a gap the outermost row of inner faces stays bonded, as a clamped rim.
    """
    length_mm = width_mm if length_mm is None else length_mm
    sides = [
        np.linspace(-0.5 * side_mm, 0.5 * side_mm, max(1, round(side_mm / edge_mm)) + 1)
        for side_mm in (width_mm, length_mm)
    ]
    points_mm, cells = block(*sides, np.linspace(0.0, height_mm, layers + 1))
    quads = boundary(cells)
    outer = _skin(points_mm, quads, height_mm)
    inner = _skin(points_mm, quads, 0.0, backed=gap_mm > 0.0)
    hexes = VolumeMesh(
        points_mm=points_mm,
        cells=cells.astype(np.int32),
        labels=np.zeros(len(points_mm), np.uint8),
        quality=np.ones(len(cells), np.float32),
        layers=layers,
        volume_mm3=width_mm * length_mm * height_mm,
    )
    return MembraneMesh(hexes=hexes, outer=outer, inner=inner, cavity=inner, backing_mm=gap_mm)


def _skin(points_mm: np.ndarray, quads: np.ndarray, z_mm: float, *, backed: bool = False) -> Skin:
    """The triangles of the faces at one height; both skins' normals point along +Z."""
    flat = quads[(points_mm[quads][..., 2] == z_mm).all(axis=1)]
    nodes, number = np.unique(flat, return_inverse=True)
    number = number.reshape(flat.shape)
    if z_mm == 0.0:
        number = number[:, ::-1]
    faces = np.concatenate([number[:, [0, 1, 2]], number[:, [0, 2, 3]]]).astype(np.int32)
    labels = np.zeros(len(faces), np.uint8)
    if backed:
        within = np.abs(points_mm[nodes][faces][..., :2]).max(axis=(1, 2))
        labels[within < within.max()] = Label.BACKED
    normals = np.tile([0.0, 0.0, 1.0], (len(nodes), 1))
    return Skin(points_mm=points_mm[nodes], faces=faces, normals=normals, labels=labels)
