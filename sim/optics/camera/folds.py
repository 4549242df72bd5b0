"""Where one point of the skin is seen in several pixels, or a ray map jumps.

With X(x, y) the place that the ray of pixel (x, y) meets, the image is the right way round where
d . (X_x x X_y) > 0; where a ridge of the wall turns it over, the same skin shows three times, and
projecting a point finds only one of the three. Where neighbouring rays cross different walls, or
turn by more than walls bend them, the map is no map between them.
"""

from __future__ import annotations

import numpy as np

JUMP = 0.15
"""Change of direction or foot between neighbouring pixels that is a discontinuity [rad, and mm per
mm of the camera's distance to the skin]; smooth walls stay below 0.02 at 320 pixels across."""


def folds(
    hit: np.ndarray, direction: np.ndarray, foot: np.ndarray, walls: np.ndarray
) -> np.ndarray:
    """Pixels beside which the map jumps, or turns over, shape (H, W), bool.

    Args:
        hit: Where rays meet the undeformed skin [mm], shape (H, W, 3), NaN for a miss.
        direction: Their unit directions, shape (H, W, 3).
        foot: Their points nearest to the camera, relative to it [mm], shape (H, W, 3).
        walls: Walls that they crossed, -1 after total reflection, shape (H, W).
    """
    bad: np.ndarray = walls < 0
    for axis in (0, 1):
        size = np.maximum(np.nanmedian(np.linalg.norm(hit, axis=2)), 1.0)
        turn = np.linalg.norm(np.diff(direction, axis=axis), axis=2)
        move = np.linalg.norm(np.diff(foot, axis=axis), axis=2) / size
        jump = (np.diff(walls, axis=axis) != 0) | (turn > JUMP) | (move > JUMP)
        if axis == 0:
            bad[1:] |= jump
            bad[:-1] |= jump
        else:
            bad[:, 1:] |= jump
            bad[:, :-1] |= jump
    # Along one ray the sign does not depend on the distance's slope, so X may leave the skin.
    step_x, step_y = np.gradient(hit, axis=1), np.gradient(hit, axis=0)
    area = np.einsum("hwi,hwi->hw", direction, np.cross(step_x, step_y))
    with np.errstate(invalid="ignore"):
        return np.asarray(bad | (area <= 0.0))


def spread(bad: np.ndarray, face: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """All pixels that see, or nearly see, a triangle that bad pixels see: (H, W), bool.

    What is folded shows several times; each of its images is cast.
    """
    if not bad.any():
        return bad
    marked = np.zeros(faces.max() + 1, dtype=bool)
    marked[faces[np.unique(face[bad & (face >= 0)])].ravel()] = True
    again = np.asarray(marked[faces].any(axis=1))
    return _grown(bad | ((face >= 0) & again[face]))


def _grown(mask: np.ndarray) -> np.ndarray:
    """The mask and the pixels beside it."""
    grown = mask.copy()
    grown[1:] |= mask[:-1]
    grown[:-1] |= mask[1:]
    grown[:, 1:] |= mask[:, :-1]
    grown[:, :-1] |= mask[:, 1:]
    return grown
