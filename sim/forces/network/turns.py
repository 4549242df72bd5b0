"""Turns and mirrors about the sensor's axis, and what they do to fields."""

from __future__ import annotations

import math

import numpy as np

from sim.forces.network.spec import Target

SYMMETRIC = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
"""Places in a matrix of the six of a stress: xx, yy, zz, xy, yz, zx."""


def turn_matrix(turn: int, turns: int) -> np.ndarray:
    """Orthogonal matrix of a turn, shape (3, 3)."""
    return about_axis(2.0 * math.pi * turn / turns, mirrored=bool(turn % 2))


def about_axis(angle_rad: float, *, mirrored: bool) -> np.ndarray:
    """Turn about z, after the mirror in the plane y = 0 where asked, shape (3, 3)."""
    cosine, sine = math.cos(angle_rad), math.sin(angle_rad)
    turned = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return turned @ np.diag([1.0, -1.0, 1.0]) if mirrored else turned


def any_turn(rng: np.random.Generator) -> np.ndarray:
    """Orthogonal matrix of any angle about the sensor's axis, every second one mirrored, (3, 3)."""
    return about_axis(rng.uniform(0.0, 2.0 * math.pi), mirrored=bool(rng.integers(2)))


def value_matrix(matrix: np.ndarray, target: Target) -> np.ndarray:
    """What a turn does to the numbers of a target, shape (C, C): itself, or T S T^t of a stress."""
    if target is not Target.STRESS:
        return matrix
    columns = []
    for i, j in SYMMETRIC:
        unit = np.zeros((3, 3))
        unit[i, j] = unit[j, i] = 1.0
        whole = matrix @ unit @ matrix.T
        columns.append([whole[place] for place in SYMMETRIC])
    return np.array(columns).T
