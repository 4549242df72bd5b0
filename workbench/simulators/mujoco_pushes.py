"""Forces of ours in a MuJoCo simulation, in place of its own contact."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from workbench.simulators.mujoco_module import MjData, MjModel
from workbench.simulators.mujoco_names import fixed_below

PAIR_BITS = 16
"""A pair of bodies that may not touch is (smaller << 16) + larger in `exclude_signature`."""


def switch_contact_off(model: MjModel, body: int, others: Iterable[int]) -> None:
    """Keep MuJoCo from pushing a body, and what is fixed to it, and others apart.

    A model that excludes all the pairs stays as it is. Else all geoms of the body touch nothing any
    more: a compiled model takes no further pairs.
    """
    ours = fixed_below(model, body)
    known = set(model.exclude_signature.tolist())
    pairs = {(min(a, b) << PAIR_BITS) + max(a, b) for a in ours for b in others}
    if pairs <= known:
        return
    for geom in np.flatnonzero(np.isin(model.geom_bodyid, list(ours))):
        model.geom_contype[geom] = model.geom_conaffinity[geom] = 0


class Pushes:
    """A force between two bodies that a simulation keeps until it is taken back."""

    def __init__(self, data: MjData) -> None:
        self.data = data
        self._given: list[tuple[int, np.ndarray]] = []

    def forget(self) -> None:
        """After the simulation was reset, which took all forces away."""
        self._given = []

    def put(self, bodies: tuple[int, int], wrench: np.ndarray, place_m: np.ndarray) -> None:
        """Push the first body, and the second as much the other way, instead of before.

        Args:
            bodies: Numbers of both.
            wrench: Force [N] and moment about `place_m` [N m] on the first, world axes, shape (6,).
            place_m: In the world, shape (3,).
        """
        for body, given in self._given:
            self.data.xfrc_applied[body] -= given
        self._given = []
        for body, sign in zip(bodies, (1.0, -1.0), strict=True):
            # MuJoCo takes moments about the centre of mass.
            arm_m = place_m - self.data.xipos[body]
            given = sign * wrench
            given[3:] += np.cross(arm_m, given[:3])
            self.data.xfrc_applied[body] += given
            self._given.append((body, given))
