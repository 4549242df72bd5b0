"""Marking parts of a labelled surface: actuators, pins, backed faces.

A region is where a function is positive. With `imprint`, triangles are first cut along the zero
set, linearly along each edge and once for both neighbours, so the surface stays closed and the
boundary is exact for planes and good to the square of the edge for curved boundaries.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core.base.errors import MeshingError
from workbench.core.result.marks import Field, Region
from workbench.core.result.results import Label, LabelledSurface

NEAR = 1e-3
"""Share of an edge: a boundary closer than this to a vertex passes through the vertex."""


def mark_regions(surface: LabelledSurface, regions: Sequence[Region]) -> LabelledSurface:
    """The surface with the regions' labels and numbers added.

    Raises:
        MeshingError: If a region has no face; a mark that vanishes must not pass unseen.
    """
    for region in regions:
        for border in (region.borders or (region.inside,)) if region.imprint else ():
            surface = imprint(surface, border, within=region.within)
    labels, numbers = surface.labels.copy(), surface.numbers.copy()
    centre = surface.points_mm[surface.faces].mean(axis=1)
    for region in regions:
        members = np.flatnonzero(surface.has(region.within))
        members = members[region.inside(centre[members]) > 0.0]
        if not len(members):
            raise MeshingError(
                f"the region {region.label.name} {region.number} has no face",
                hint="change the last shape parameter a little",
                at="shape",
            )
        labels[members] |= np.uint8(region.label)
        if region.label is not Label.BACKED:
            numbers[members] = region.number
    return LabelledSurface(
        points_mm=surface.points_mm, faces=surface.faces, labels=labels, numbers=numbers
    )


def imprint(surface: LabelledSurface, border: Field, *, within: Label) -> LabelledSurface:
    """The surface with its triangles cut along a border.

    Every edge of a face within OUTER or INNER that the border crosses gets one new vertex.
    """
    faces = surface.faces.astype(np.int64)
    value = np.asarray(border(surface.points_mm), dtype=np.float64)
    start, stop = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    low, high = np.minimum(start, stop), np.maximum(start, stop)
    share = value[low] / np.where(value[low] == value[high], 1.0, value[low] - value[high])
    crossed = (value[low] > 0.0) != (value[high] > 0.0)
    crossed &= (share > NEAR) & (share < 1.0 - NEAR)
    # Only edges of a face on that side are cut, but then for both of their faces.
    key = low * len(surface.points_mm) + high
    wanted = np.repeat(surface.has(within), 3) & crossed
    cut, place = np.unique(key[wanted], return_index=True)
    ends = np.column_stack([low[wanted][place], high[wanted][place]])
    along = share[wanted][place][:, None]
    added = (1.0 - along) * surface.points_mm[ends[:, 0]] + along * surface.points_mm[ends[:, 1]]
    spot = np.searchsorted(cut, key)
    found = cut[np.minimum(spot, len(cut) - 1)] == key if len(cut) else np.zeros(len(key), bool)
    middle = np.where(found, len(surface.points_mm) + spot, -1).reshape(-1, 3)
    pieces, owner = _split(faces, middle)
    return LabelledSurface(
        points_mm=np.concatenate([surface.points_mm, added]),
        faces=pieces.astype(np.int32),
        labels=surface.labels[owner],
        numbers=surface.numbers[owner],
    )


def _split(faces: np.ndarray, middle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles cut at the middles of their edges (-1: uncut), and the face each came from.

    Edge k of a face runs from its corner k to corner k + 1. Turned so that the cuts come first,
    a face has the corners a, b, c and the middles ab (and bc, and ca).
    """
    count = (middle >= 0).sum(axis=1)
    pieces = [faces[count == 0]]
    owner = [np.flatnonzero(count == 0)]
    patterns = {
        1: ((0, 3, 2), (3, 1, 2)),
        2: ((3, 1, 4), (0, 3, 4), (0, 4, 2)),
        3: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    }
    for cuts, pattern in patterns.items():
        cut = np.flatnonzero(count == cuts)
        if not len(cut):
            continue
        # One cut: start there. Two: start at the first of the two in a row. Three: anywhere.
        missing = np.argmin(middle[cut] >= 0, axis=1)
        turn = {1: np.argmax(middle[cut] >= 0, axis=1), 2: (missing + 1) % 3, 3: 0 * missing}[cuts]
        order = (turn[:, None] + np.arange(3)) % 3
        corners = np.hstack(
            [
                np.take_along_axis(faces[cut], order, axis=1),
                np.take_along_axis(middle[cut], order, axis=1),
            ]
        )
        for piece in pattern:
            pieces.append(corners[:, piece])
            owner.append(cut)
    return np.concatenate(pieces), np.concatenate(owner)
