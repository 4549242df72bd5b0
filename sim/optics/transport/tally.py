"""What photons leave behind: sums at nodes or vertices, and the ledger of their power.

A `Tally` holds the tables that say where light is gathered, and the whole numbers it adds up to.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sim.optics.transport.constants import (
    AT_NODES,
    FATES,
    FIXED_POINT,
    LEDGER_SLOTS,
    NO_GATHERING,
    TOWARD_CAMERA,
)
from sim.optics.transport.nodes import Nodes
from sim.optics.transport.scene import Scene
from workbench.core.result.light import AZIMUTHS, SINES


def _none(*shape: int, kind: type = np.float32) -> np.ndarray:
    return np.zeros(shape, dtype=kind)


@dataclass(kw_only=True)
class Tally:
    """Tables to gather by, and sums; those that are not used have size 1."""

    gather: int
    """`NO_GATHERING`, `AT_NODES` or `TOWARD_CAMERA`."""
    face_nodes: np.ndarray = field(default_factory=lambda: _none(1, 3, kind=np.int32))
    face_weights: np.ndarray = field(default_factory=lambda: _none(1, 3, 3))
    frames: np.ndarray = field(default_factory=lambda: _none(1, 3, 3))
    to_camera: np.ndarray = field(default_factory=lambda: _none(1, 3))
    bins: np.ndarray = field(default_factory=lambda: _none(1, 1, 1, 1, kind=np.int64))
    """Perpendicular flux, first and rest, shape (2, N, 3, B), int64."""
    lamps: np.ndarray = field(default_factory=lambda: _none(1, 1, 1, kind=np.int64))
    """Of unscattered light, perpendicular flux times direction, and alone, shape (N, L, 4)."""
    radiance: np.ndarray = field(default_factory=lambda: _none(1, 1, kind=np.int64))
    """Radiance times area, shape (V, 3), int64."""
    ledger: np.ndarray = field(
        default_factory=lambda: _none(len(FATES), LEDGER_SLOTS, kind=np.int64)
    )
    photons: int = 0

    @property
    def balance(self) -> dict[str, float]:
        """Share of the emitted photons' flux that ended in each way."""
        shares = self.ledger.sum(axis=1) / FIXED_POINT / max(self.photons, 1)
        return {name: float(share) for name, share in zip(FATES, shares, strict=True)}


def tally_at_nodes(nodes: Nodes, lights: int) -> Tally:
    """A tally of light by direction at nodes."""
    count, bins = len(nodes.points_mm), AZIMUTHS * (len(SINES) - 1)
    return Tally(
        gather=AT_NODES,
        face_nodes=nodes.face_nodes,
        face_weights=nodes.face_weights,
        frames=nodes.frame,
        bins=_none(2, count, 3, bins, kind=np.int64),
        lamps=_none(count, lights, 4, kind=np.int64),
    )


def tally_toward_camera(scene: Scene, to_camera: np.ndarray) -> Tally:
    """A tally of radiance along unit vectors (V, 3) at the vertices of the skin."""
    return Tally(
        gather=TOWARD_CAMERA,
        to_camera=np.ascontiguousarray(to_camera, dtype=np.float32),
        radiance=_none(scene.skin_points, 3, kind=np.int64),
    )


def ledger_only() -> Tally:
    """A tally that only follows where the power goes."""
    return Tally(gather=NO_GATHERING)
