"""Curves on a skin: where a function has one value, and where a plane cuts it.

A function that is linear on each triangle takes a value on straight pieces, which are joined from
triangle to triangle over the edges they cross. The distance to a plane gives the section that the
published light field follows from the light to the target; the distance from the tip gives circles.
Source: SimTac, "Offline light field generation". A vertex that lies on the curve counts as a hair
above it, so that curves pass between vertices only.
"""

from __future__ import annotations

import numpy as np

from workbench.core.result.results import Skin


def level_curves(skin: Skin, values: np.ndarray, level: float) -> list[np.ndarray]:
    """Curves on which vertex values, shape (V,), have a level, each (K, 3) [mm].

    A closed curve ends with its first point. Triangles with a value that is not finite have none.
    """
    above = values >= level
    faces = skin.faces[np.isfinite(values[skin.faces]).all(axis=1)]
    high = above[faces]
    crossed = faces[high.any(axis=1) & ~high.all(axis=1)]
    if not len(crossed):
        return []
    edges = np.stack([crossed, np.roll(crossed, -1, axis=1)], axis=2)
    crosses = above[edges[:, :, 0]] != above[edges[:, :, 1]]
    pairs = np.sort(edges[crosses], axis=1)
    unique, number = np.unique(pairs, axis=0, return_inverse=True)
    start, end = unique.T
    share = (level - values[start]) / (values[end] - values[start])
    points = skin.points_mm[start] + share[:, None] * (skin.points_mm[end] - skin.points_mm[start])
    return [points[chain] for chain in _chains(number.reshape(-1, 2))]


def plane_section(skin: Skin, through_mm: np.ndarray, normal: np.ndarray) -> np.ndarray | None:
    """The curve nearest to a point, shape (K, 3), of those in which a plane through it cuts."""
    height = (skin.points_mm - through_mm) @ normal
    curves = level_curves(skin, height, 0.0)
    if not curves:
        return None
    return min(curves, key=lambda curve: _nearest(curve, through_mm)[1])


def tangent_toward(
    curve: np.ndarray, target_mm: np.ndarray, source_mm: np.ndarray, *, step_mm: float
) -> np.ndarray | None:
    """Unit tangent at the target of the shorter way along the curve to where the source is nearest.

    The tangent is the chord between the points a step before and after the target.

    Returns:
        Shape (3,), or None where the curve ends within a step of the target, or the source is
        nearest to the target itself.
    """
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))])
    total = float(length[-1])
    closed = bool(np.array_equal(curve[0], curve[-1]))
    here = float(length[_nearest(curve, target_mm)[0]])
    there = float(length[_nearest(curve, source_mm)[0]])
    ends = np.array([here - step_mm, here + step_mm])
    if not closed and (ends[0] < 0.0 or ends[1] > total):
        return None
    ends = ends % total if closed else ends
    before, after = (
        np.array([np.interp(at, length, curve[:, axis]) for axis in range(3)]) for at in ends
    )
    onward = there - here
    if closed:
        onward = (onward + 0.5 * total) % total - 0.5 * total
    if onward == 0.0:
        return None
    chord = (after - before) * np.sign(onward)
    return chord / np.linalg.norm(chord)


def _nearest(curve: np.ndarray, point: np.ndarray) -> tuple[int, float]:
    """Number of the curve's point nearest to a point, and its distance [mm]."""
    distance = np.linalg.norm(curve - point, axis=1)
    nearest = int(np.argmin(distance))
    return nearest, float(distance[nearest])


def _chains(pieces: np.ndarray) -> list[list[int]]:
    """Points in the order of each curve, from the two points of each piece, shape (P, 2)."""
    at: dict[int, list[int]] = {}
    for piece, ends in enumerate(pieces.tolist()):
        for end in ends:
            at.setdefault(end, []).append(piece)
    left = set(range(len(pieces)))
    # Open curves begin where only one piece ends; what is left then are closed ones.
    borders = [end for end, touching in at.items() if len(touching) == 1]
    chains = []
    for first in [*borders, *(int(end) for end in pieces[:, 0])]:
        chain = [first]
        while True:
            piece = next((piece for piece in at[chain[-1]] if piece in left), None)
            if piece is None:
                break
            left.remove(piece)
            one, other = pieces[piece].tolist()
            chain.append(other if one == chain[-1] else one)
        if len(chain) > 1:
            chains.append(chain)
    return chains
