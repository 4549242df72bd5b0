"""Lay one skin on another: a rotation and a shift, nothing else.

From each of the 24 ways in which the axes of one can lie along those of the other, boxes centred,
the nearest places of both skins are laid on each other (Besl and McKay, A method for registration
of 3-D shapes, 1992). The best few go on with distances along normals (Chen and Medioni, Object
modelling by registration of multiple range images, 1992), both ways; the best of these is it.
Rotations are proper, so a mirror image stays one, and no size changes.
"""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import numpy as np

from geometry.surface.spread import Spread, spread
from workbench.proof.validation.published.apart import in_cuts
from workbench.proof.validation.published.released import Cut, Skin

FEW, MANY = 400, 3000
"""Places on either skin, first and for the best."""
STEPS, BEST = 12, 4
"""Steps of the first part, and how many of the 24 go on."""
FINE_STEPS = 30
STILL_RAD_MM = 1e-7
"""Turn and shift of a step below which it stands."""
LEAST_SHARE = 1e-6
"""Singular value over the largest below which a motion changes nothing: a body that turns in
itself."""


class Motion(NamedTuple):
    """p -> turn p + shift."""

    turn: np.ndarray
    shift_mm: np.ndarray

    def of(self, points_mm: np.ndarray) -> np.ndarray:
        """Moved places, shape (N, 3)."""
        return points_mm @ self.turn.T + self.shift_mm


def laid_on(ours: Skin, released: Skin) -> Skin:
    """Our skin where it fits the released one best."""
    few = _places(ours, FEW), _places(released, FEW)
    starts = [_nearest(_centred(turn, ours, released), *few) for turn in right_turns()]
    starts.sort(key=lambda motion: _score(motion, *few))
    many = _places(ours, MANY), _places(released, MANY)
    fine = [_along_normals(motion, *many, released.cuts) for motion in starts[:BEST]]
    best = min(fine, key=lambda motion: _score(motion, *many))
    return Skin(points_mm=best.of(ours.points_mm), faces=ours.faces)


def right_turns() -> list[np.ndarray]:
    """The 24 proper rotations that take axes to axes, shape (3, 3) each."""
    found = []
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1.0, -1.0), repeat=3):
            turn = np.eye(3)[list(order)] * np.array(signs)[:, None]
            if np.linalg.det(turn) > 0.0:
                found.append(turn)
    return found


def _places(skin: Skin, count: int) -> Spread:
    return spread(skin.points_mm, skin.faces, count)


def _centred(turn: np.ndarray, ours: Skin, released: Skin) -> Motion:
    """The turn, with the boxes centred on each other."""
    here = ours.points_mm @ turn.T
    middle = [0.5 * (p.min(axis=0) + p.max(axis=0)) for p in (here, released.points_mm)]
    return Motion(turn, middle[1] - middle[0])


def _tree(points_mm: np.ndarray) -> Any:
    from scipy.spatial import KDTree

    return KDTree(points_mm)


def _score(motion: Motion, ours: Spread, released: Spread) -> float:
    """Mean distance of places to the nearest of the other skin's, both ways."""
    moved = motion.of(ours.points_mm)
    ways = ((moved, released.points_mm), (released.points_mm, moved))
    return float(np.mean([_tree(to).query(places)[0].mean() for places, to in ways]))


def _nearest(motion: Motion, ours: Spread, released: Spread) -> Motion:
    tree = _tree(released.points_mm)
    for _ in range(STEPS):
        moved = motion.of(ours.points_mm)
        to = tree.query(moved)[1]
        back = _tree(moved).query(released.points_mm)[1]
        here = np.concatenate([ours.points_mm, ours.points_mm[back]])
        motion = rigid(here, np.concatenate([released.points_mm[to], released.points_mm]))
    return motion


def rigid(here: np.ndarray, there: np.ndarray) -> Motion:
    """The motion that lays places on places, shape (N, 3) both, with the least squares.

    Source: Kabsch, A solution for the best rotation to relate two sets of vectors, 1976.
    """
    middle = here.mean(axis=0), there.mean(axis=0)
    left, _, right = np.linalg.svd((there - middle[1]).T @ (here - middle[0]))
    proper = np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    turn = left @ proper @ right
    return Motion(turn, middle[1] - turn @ middle[0])


def _along_normals(motion: Motion, ours: Spread, released: Spread, cuts: tuple[Cut, ...]) -> Motion:
    from scipy.spatial.transform import Rotation

    tree = _tree(released.points_mm)
    for _ in range(FINE_STEPS):
        moved, normals = motion.of(ours.points_mm), ours.normals @ motion.turn.T
        kept = ~in_cuts(moved, normals, cuts)
        moved, normals = moved[kept], normals[kept]
        to, back = tree.query(moved)[1], _tree(moved).query(released.points_mm)[1]
        places = np.concatenate([moved, moved[back]])
        along = np.concatenate([released.normals[to], normals[back]])
        apart = np.concatenate([released.points_mm[to], released.points_mm]) - places
        # A small turn w and a shift v move a place p by w x p + v.
        slopes = np.hstack([np.cross(places, along), along])
        step = np.linalg.lstsq(slopes, np.einsum("ni,ni->n", apart, along), rcond=LEAST_SHARE)[0]
        turn = Rotation.from_rotvec(step[:3]).as_matrix()
        motion = Motion(turn @ motion.turn, turn @ motion.shift_mm + step[3:])
        if np.abs(step).max() < STILL_RAD_MM:
            break
    return motion
