"""Fast contact: many presses of one rigid object on a condensed skin, side by side, pose by pose.

Equal presses are equal to the last bit, alone or in a batch: each is solved by itself, in a fixed
order.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import taichi as ti

from geometry.surface.surface import vertex_areas_mm2
from sim.condensed import bundles, frame_kernels, solve_kernel
from sim.condensed.hardening import PlayedFrame, sharpness
from sim.condensed.spots import spots_of
from sim.contact.objects.collider import Collider
from sim.optics.light.device_arrays import computes_on_gpu, empty, on_device
from workbench.core.base.errors import SolveError
from workbench.core.design.design import Elastomer
from workbench.core.result.condensed import CondensedSkin, Hardening

LANES = 128
"""Threads of a press on a GPU; on a processor one."""
MOST = 600
"""Candidates beyond which a press is refused: its compliance takes 13 MB."""
REMEMBERED = ("force", "settled", "anchor", "held", "poses", "known")
SPARE = 1.25
"""Room for so many times the candidates there are, so that a press that grows finds it made."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Touch:
    """What B presses feel in one frame; forces act on the object, in the sensor's frame."""

    force_N: np.ndarray
    """Shape (B, 3), float32."""
    moment_Nmm: np.ndarray
    """About the object's origin, shape (B, 3)."""
    displacement_mm: np.ndarray
    """Of the skin's nodes, shape (B, N, 3)."""
    pressure_MPa: np.ndarray
    """At the nodes, shape (B, N)."""
    sliding: np.ndarray
    """Share of the normal force on nodes that slide, shape (B,)."""
    deepest: np.ndarray
    """Largest indentation over the wall, shape (B,)."""
    settled_mm: np.ndarray
    """Change of the last round [mm], shape (B,)."""
    friction_ratio: np.ndarray
    """Largest tangential over normal force of a node as solved, shape (B,)."""
    touching: np.ndarray
    """Nodes that touch, shape (B,), int64."""


class FastContact:
    """A condensed skin on the compute device, which the process must have opened."""

    def __init__(self, skin: CondensedSkin, law: Hardening, material: Elastomer) -> None:
        self.skin, self.law, self.material = skin, law, material
        spots = spots_of(skin.points_mm, skin.faces)
        self._spots = spots.most
        rows = skin.compliance
        own = own_mm_N(skin)
        areas = vertex_areas_mm2(skin.points_mm, skin.faces)
        self._skin = bundles.Skin(
            points=on_device(skin.points_mm, vector=3),
            normals=on_device(skin.normals, vector=3),
            walls=on_device(skin.wall_mm),
            areas=on_device(areas),
            own_mm_N=on_device(own),
            row_starts=on_device(rows.starts.astype(np.int32)),
            row_nodes=on_device(rows.neighbours),
            row_blocks=on_device(rows.blocks_mm_N.ravel()),
            spot_starts=on_device(spots.starts),
            spot_others=on_device(spots.others.ravel()),
            spot_areas=on_device(spots.areas_mm2),
        )
        self._lanes = LANES if computes_on_gpu() else 1
        self._presses = self._most = 0
        self._thing: tuple[Collider, Any] | None = None
        self.reset(1)

    def reset(self, presses: int) -> None:
        """So many presses that have touched nothing."""
        if presses != self._presses:
            self._allot(presses)
        for array in (self._past.known, self._past.held):
            array.fill(0)
        for array in (self._past.settled, self._past.force):
            array.fill(0.0)

    def step(self, collider: Collider, poses: np.ndarray) -> Touch:
        """Move the object of each press to its pose and find what is felt there; as `advance`."""
        self.advance(collider, poses)
        return self._touch()

    def advance(self, collider: Collider, poses: np.ndarray) -> None:
        """Move the object of each press to its pose; what is felt stays on the device.

        Args:
            collider: The object.
            poses: x, y, z [mm], qw, qx, qy, qz of each press, shape (B, 7); the number of the last
                `reset`.

        Raises:
            SolveError: If a press touches too much of the skin at once.
        """
        count, nodes = self._presses, len(self.skin.points_mm)
        thing = self._object(collider)
        at = self._poses
        at.from_numpy(np.ascontiguousarray(poses, dtype=np.float32).ravel())
        frame_kernels.mark(count, at, self._skin, thing, self._past, self._marks)
        frame_kernels.count_marks(count, nodes, self._marks, self._choice.counts)
        self._grow(int(self._choice.counts.to_numpy().max()))
        rules, work, past, choice = self._rules, self._work, self._past, self._choice
        frame_kernels.choose(count, at, self._skin, thing, past, self._marks, choice, work, rules)
        frame_kernels.gather(count, self._skin, choice, work, rules)
        solve_kernel.solve(
            count, at, self._skin, thing, past, choice, work, self._felt, rules, self._lanes
        )
        frame_kernels.spread(count, self._skin, choice, work, past, self._felt, rules, self._lanes)
        frame_kernels.feel(count, at, self._skin, thing, past, choice, work, self._felt, rules)

    @property
    def felt(self) -> Any:
        """What the last frame gave, a `bundles.Felt` on the device."""
        return self._felt

    @property
    def presses(self) -> int:
        """How many presses there are side by side."""
        return self._presses

    def state(self) -> dict[str, np.ndarray]:
        """What all presses remember, as arrays."""
        return {name: getattr(self._past, name).to_numpy() for name in REMEMBERED}

    def restore(self, state: dict[str, np.ndarray]) -> None:
        """Go back to a `state`.

        Raises:
            SolveError: If it is that of another skin.
        """
        presses, left = divmod(len(state["held"]), len(self.skin.points_mm))
        if left or not presses:
            raise SolveError(
                f"the state holds {len(state['held'])} nodes, no multiple of the skin's "
                f"{len(self.skin.points_mm)}",
                hint="restore the state of a sensor of the same design",
                at="state",
            )
        self.reset(presses)
        for name in REMEMBERED:
            getattr(self._past, name).from_numpy(np.ascontiguousarray(state[name]))

    def played(self, press: int) -> PlayedFrame:
        """Forces of a press's last frame as solved, not yet hardened."""
        nodes, most = len(self.skin.points_mm), self._most
        held = self._past.held.to_numpy()[press * nodes : (press + 1) * nodes]
        slots = self._slots.to_numpy()[press * nodes : (press + 1) * nodes]
        on = np.flatnonzero(held)
        at = press * most + slots[on]
        ways = self._work.ways.to_numpy()[at].astype(np.float64)
        force = self._work.pushes.to_numpy().reshape(-1, 3)[at].astype(np.float64)
        moved = self._work.moves.to_numpy().reshape(-1, 3)[at].astype(np.float64)
        inward = -self.skin.normals[on]
        along = np.einsum("ni,ni->n", force, inward)[:, None]
        s = np.einsum("ni,ni->n", moved, inward) / self.skin.wall_mm[on]
        return PlayedFrame(
            s=np.maximum(s, 0.0),
            deep_N=along * ways,
            side_N=turned_back(force - along * inward, inward, ways),
            slides=held[on] == bundles.SLIDES,
        )

    def _touch(self) -> Touch:
        nodes = len(self.skin.points_mm)
        totals = self._felt.totals.to_numpy().reshape(-1, bundles.TOTALS)
        return Touch(
            force_N=totals[:, bundles.FORCE : bundles.FORCE + 3],
            moment_Nmm=totals[:, bundles.MOMENT : bundles.MOMENT + 3],
            displacement_mm=self._felt.displacement.to_numpy().reshape(-1, nodes, 3),
            pressure_MPa=self._felt.pressure.to_numpy().reshape(-1, nodes),
            sliding=totals[:, bundles.SLIDING],
            deepest=totals[:, bundles.DEEPEST],
            settled_mm=totals[:, bundles.MOVED],
            friction_ratio=totals[:, bundles.RATIO],
            touching=totals[:, bundles.TOUCHING].astype(np.int64),
        )

    def _object(self, collider: Collider) -> Any:
        if self._thing is None or self._thing[0] is not collider:
            wall_mm = float(np.median(self.skin.wall_mm))
            made = bundles.Object(
                shape=int(collider.shape),
                sizes=on_device(collider.seated_size),
                coefficients=on_device(collider.samples.ravel()),
                sample_counts=on_device(np.array(collider.samples.shape, dtype=np.int32)),
                seats=on_device(collider.seat_mm),
                sharpness=sharpness(collider.least_radius_mm, wall_mm),
                reach=collider.reach_mm,
            )
            self._thing = (collider, made)
        return self._thing[1]

    def _allot(self, presses: int) -> None:
        """Arrays of so many presses."""
        self._presses, nodes = presses, len(self.skin.points_mm)
        size = presses * nodes
        vectors = [empty(ti.f32, size, vector=3) for _ in range(6)]
        self._poses, self._marks = empty(ti.f32, 7 * presses), empty(ti.i32, size)
        self._past = bundles.Memory(
            force=vectors[0],
            settled=vectors[1],
            anchor=vectors[2],
            held=empty(ti.i32, size),
            poses=empty(ti.f32, 7 * presses),
            known=empty(ti.i32, presses),
        )
        self._felt = bundles.Felt(
            displacement=vectors[3],
            full=vectors[4],
            away=empty(ti.f32, size),
            pressure=empty(ti.f32, size),
            traction=vectors[5],
            totals=empty(ti.f32, bundles.TOTALS * presses),
        )
        self._slots, self._counts = empty(ti.i32, size), empty(ti.i32, presses)
        self._most = 0
        self._grow(1)

    def _grow(self, candidates: int) -> None:
        """Room for so many candidates a press."""
        if candidates <= self._most:
            return
        if candidates > MOST:
            raise SolveError(
                f"the object comes near {candidates} nodes of the skin at once; the limit of fast "
                f"contact is {MOST}",
                hint="press less deep or with a smaller object, or use the contact solver",
                at="press",
            )
        self._most = most = min(int(SPARE * candidates) + 8, MOST)
        count = self._presses * most
        self._choice = bundles.Choice(
            candidates=empty(ti.i32, count), slots=self._slots, counts=self._counts
        )
        self._work = bundles.Work(
            columns=empty(ti.f32, 9 * count * most),
            pushes=empty(ti.f32, 3 * count),
            moves=empty(ti.f32, 3 * count),
            starts=empty(ti.f32, 3 * count),
            ways=empty(ti.f32, count, vector=3),
            gaps=empty(ti.f32, count * self._spots),
            slips=empty(ti.f32, count, vector=3),
            slid=empty(ti.i32, count),
        )
        law = self.law
        self._rules = bundles.Rules(
            friction=self.material.friction,
            sliding_friction=self.material.sliding_friction,
            most=most,
            spots=self._spots,
            normal_a=law.normal[0],
            normal_b=law.normal[1],
            normal_c=law.normal[2],
            tangential_a=law.tangential[0],
            tangential_b=law.tangential[1],
            tangential_c=law.tangential[2],
            deepest=law.deepest,
        )


def own_mm_N(skin: CondensedSkin) -> np.ndarray:
    """Displacement of each node along its normal by a unit force along it [mm/N], (N,)."""
    rows = skin.compliance
    pushed = np.repeat(np.arange(len(rows.nodes)), np.diff(rows.starts))
    found = np.zeros(len(rows.nodes))
    own = np.flatnonzero(rows.neighbours == pushed)
    normals = skin.normals[pushed[own]]
    found[pushed[own]] = np.einsum("ni,nij,nj->n", normals, rows.blocks_mm_N[own], normals)
    return found


def turned_back(vectors: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """The twin of `functions.turned` for rows, all (N, 3)."""
    both = before + after
    share = np.einsum("ni,ni->n", both, vectors) / (1.0 + np.einsum("ni,ni->n", before, after))
    along = np.einsum("ni,ni->n", before, vectors)
    return vectors - share[:, None] * both + 2.0 * along[:, None] * after
