"""Fast contact on a skin whose compliance is found where it is touched, tile by tile.

What is pressed is known from both sides, as on a whole skin, so forces are the same. What moves
beside it is told by the pushed nodes alone until its own tile is known: the mean of both, which a
whole skin has, differs by little.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sim.condensed.assemble import bare, known
from sim.condensed.fast_contact import FastContact, Touch
from sim.condensed.frame_kernels import MARGIN
from sim.condensed.tiles import reach_mm, tiles
from sim.contact.objects.collider import Collider
from workbench.core.base.poses import rotations
from workbench.core.design.design import Elastomer
from workbench.core.result.condensed import Hardening, SkinColumns
from workbench.core.result.results import MembraneMesh, Skin

NEAR_MM = MARGIN + 0.05
"""Distance at which a node counts as touched: that of `mark`, and more than its single precision
errs by [mm]."""


class GrowingContact:
    """As `FastContact`; a frame that touches tiles for the first time takes as long as they do."""

    def __init__(
        self,
        mesh: MembraneMesh,
        wall_mm: float,
        law: Hardening,
        material: Elastomer,
        columns: Callable[[int], SkinColumns],
    ) -> None:
        """A skin of which nothing is known.

        Args:
            mesh: Its outer vertices are the nodes.
            wall_mm: Elastomer of the design [mm].
            law: How it hardens.
            material: Its friction.
            columns: Finds the columns of a tile by its number.
        """
        self.law, self.material = law, material
        self._outer = mesh.outer
        self.skin = bare(mesh, reach_mm(wall_mm))
        """With the compliance that is known."""
        self._columns = columns
        self._tile_of = np.empty(len(mesh.outer.points_mm), dtype=np.int64)
        for number, nodes in enumerate(tiles(mesh.outer.points_mm)):
            self._tile_of[nodes] = number
        self._parts: dict[int, SkinColumns] = {}
        self._fast: FastContact | None = None
        self._presses = 1

    @property
    def nodes(self) -> Skin:
        """The outer skin at rest, a vertex for each node."""
        return self._outer

    @property
    def tiles(self) -> int:
        """How many there are."""
        return int(self._tile_of.max()) + 1

    @property
    def known(self) -> int:
        """How many of them have been touched."""
        return len(self._parts)

    @property
    def presses(self) -> int:
        """How many presses there are side by side."""
        return self._presses

    def reset(self, presses: int) -> None:
        """So many presses that have touched nothing."""
        self._presses = presses
        if self._fast is not None:
            self._fast.reset(presses)

    def step(self, collider: Collider, poses: np.ndarray) -> Touch:
        """As `FastContact.step`; first finds the compliance of what is touched anew.

        Raises:
            SolveError: As there, and if the finite elements of a tile fail.
        """
        return self._ready(collider, poses).step(collider, poses)

    def advance(self, collider: Collider, poses: np.ndarray) -> None:
        """As `FastContact.advance`; raises as `step`."""
        self._ready(collider, poses).advance(collider, poses)

    @property
    def felt(self) -> Any:
        """As `FastContact.felt`, once something has been touched."""
        assert self._fast is not None
        return self._fast.felt

    def _ready(self, collider: Collider, poses: np.ndarray) -> FastContact:
        missing = sorted(self.touched(collider, poses) - self._parts.keys())
        # All of them or none: one that fails must not leave others that the device never gets.
        self._parts |= {tile: self._columns(tile) for tile in missing}
        if missing or self._fast is None:
            self._renew()
        assert self._fast is not None
        return self._fast

    def touched(self, collider: Collider, poses: np.ndarray) -> set[int]:
        """Tiles with nodes that an object may touch at poses, (B, 7); at least one."""
        points_mm = self._outer.points_mm
        found: set[int] = set()
        for pose, rotation in zip(poses, rotations(poses[:, 3:]), strict=True):
            offsets = points_mm - pose[:3]
            near = np.flatnonzero(np.linalg.norm(offsets, axis=1) < collider.reach_mm + NEAR_MM)
            away_mm = collider.distance(offsets[near] @ rotation)[0]
            found.update(self._tile_of[near[away_mm < NEAR_MM]].tolist())
        if not found and not self._parts:
            # Something must be known before a frame in the air can be told.
            apart = np.linalg.norm(points_mm - poses[0, :3], axis=1)
            found.add(int(self._tile_of[apart.argmin()]))
        return found

    def _renew(self) -> None:
        """Take what is known now to the device; all presses go on."""
        before = self._fast
        self.skin = known(self.skin, list(self._parts.values()))
        self._fast = FastContact(self.skin, self.law, self.material)
        self._fast.reset(self._presses)
        if before is not None:
            self._fast.restore(before.state())

    def state(self) -> dict[str, np.ndarray]:
        """What all presses remember, as arrays; none of a skin that was never touched."""
        return {} if self._fast is None else self._fast.state()

    def restore(self, state: dict[str, np.ndarray]) -> None:
        """Go back to a `state`; raises as `FastContact.restore`."""
        if self._fast is None:
            # Of the same skin before its first touch, or of a session before this one.
            self._parts.setdefault(0, self._columns(0))
            self._renew()
        assert self._fast is not None
        if state:
            self._fast.restore(state)
            self._presses = self._fast.presses
        else:
            self._fast.reset(self._presses)
