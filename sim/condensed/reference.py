"""Fast contact in plain NumPy: the twin of the kernels, node by node, for one press.

Both change together; tests compare them.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from geometry.surface.surface import vertex_areas_mm2
from sim.condensed.fast_contact import own_mm_N
from sim.condensed.frame_kernels import BLEND_MM, MARGIN, STIFFENED
from sim.condensed.functions import LEAST_ALONG, TILT
from sim.condensed.solve_kernel import (
    NEWTON,
    ROUNDS,
    SETTLED_MM,
    SOFTNESS,
    SPOT,
    STILL_MM,
    SWEEPS_A_ROUND,
    TANGENTIAL,
)
from sim.condensed.spots import Spots, spots_of
from sim.contact.objects.collider import Collider
from workbench.core.result.condensed import CondensedSkin


@dataclass
class Past:
    """What a press remembers of its last frame."""

    force_N: np.ndarray
    settled_mm: np.ndarray
    anchor_mm: np.ndarray
    """In the object's frame."""
    held: np.ndarray
    """Which nodes touched, bool."""
    pose: tuple[np.ndarray, np.ndarray] | None = None
    """Origin and rotation."""


@dataclass
class PlainContact:
    """A condensed skin, pressed pose by pose."""

    skin: CondensedSkin
    friction: float
    past: Past = field(init=False)
    spots: Spots = field(init=False)

    def __post_init__(self) -> None:
        count = len(self.skin.points_mm)
        self.spots = spots_of(self.skin.points_mm, self.skin.faces)
        self._own, self._areas = (
            own_mm_N(self.skin),
            vertex_areas_mm2(self.skin.points_mm, self.skin.faces),
        )
        self.past = Past(
            force_N=np.zeros((count, 3)),
            settled_mm=np.zeros((count, 3)),
            anchor_mm=np.zeros((count, 3)),
            held=np.zeros(count, dtype=bool),
        )

    def step(
        self, collider: Collider, origin_mm: np.ndarray, rotation: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Forces on the nodes as solved [N] and displacement of all nodes [mm], both (N, 3).

        What is remembered of the forces is in the frames of the nodes.
        """
        skin, past = self.skin, self.past
        pose = (origin_mm, rotation)
        at_rest, _ = _distance(collider, skin.points_mm, pose)
        left, _ = _distance(collider, skin.points_mm + past.settled_mm, pose)
        nodes = np.flatnonzero((at_rest < MARGIN) & ((left < MARGIN) | past.held))
        bare, whole = self._compliance(nodes)
        force, slid, slips = self._forces(collider, pose, nodes, bare[nodes])
        push = force.ravel()
        settled = np.einsum("niF,F->ni", bare.reshape(-1, 3, push.size), push)
        full = np.einsum("niF,F->ni", whole.reshape(-1, 3, push.size), push)
        on = nodes[(force != 0.0).any(axis=1)]
        away = np.full(len(skin.points_mm), BLEND_MM)
        for node in on:
            distance = np.linalg.norm(skin.points_mm - skin.points_mm[node], axis=1)
            away = np.minimum(away, np.where(self._moved_by(node), distance, BLEND_MM))
        share = (away / BLEND_MM)[:, None]
        self._remember(nodes, force, settled, slid, slips, pose)
        found = past.force_N.copy()
        for node, way in zip(nodes, self._ways, strict=True):
            found[node] = _turned(found[node], -skin.normals[node], way)
        return found, (1.0 - share) * settled + share * full

    def _moved_by(self, node: int) -> np.ndarray:
        rows = self.skin.compliance
        found = np.zeros(len(self.skin.points_mm), dtype=bool)
        found[rows.neighbours[rows.starts[node] : rows.starts[node + 1]]] = True
        return found

    def _compliance(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Displacement of all nodes by forces on some, decoupled and whole: (N, 3, m, 3) each."""
        skin, rows = self.skin, self.skin.compliance
        whole = np.zeros((len(skin.points_mm), 3, len(nodes), 3))
        bare = np.zeros_like(whole)
        for number, node in enumerate(nodes):
            for pair in range(rows.starts[node], rows.starts[node + 1]):
                other = rows.neighbours[pair]
                block = rows.blocks_mm_N[pair].T.astype(np.float64)
                moved, pushed = skin.normals[other], skin.normals[node]
                normal = (moved + pushed) / max(np.linalg.norm(moved + pushed), 1e-6)
                whole[other, :, number] = block
                across = block - np.outer(moved, moved @ block)
                bare[other, :, number] = (
                    across
                    - np.outer(across @ pushed, pushed)
                    + (normal @ block @ normal) * np.outer(normal, normal)
                )
        return bare, whole

    def _forces(
        self,
        collider: Collider,
        pose: tuple[np.ndarray, np.ndarray],
        nodes: np.ndarray,
        bare: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Forces (m, 3), which slid (m,), and the ways from the anchors at rest (m, 3)."""
        count = len(nodes)
        G = bare.reshape(3 * count, 3 * count).copy()
        normals = self.skin.normals[nodes]
        for k in range(count):
            own = slice(3 * k, 3 * k + 3)
            G[own, own] -= STIFFENED * self._own[nodes[k]] * np.outer(normals[k], normals[k])
        force = self.past.force_N[nodes].copy()
        slips = self.skin.points_mm[nodes] - self._anchors(collider, pose, nodes)
        slid = np.zeros(count, dtype=bool)
        moves = (G @ force.ravel()).reshape(-1, 3)
        for _ in range(ROUNDS):
            gaps, ways = self._look(collider, pose, nodes, moves)
            starts = moves.copy()
            for _ in range(SWEEPS_A_ROUND):
                change = 0.0
                for k in range(count):
                    own = slice(3 * k, 3 * k + 3)
                    drift = self._drift(nodes, k, moves - starts)
                    new, slid[k] = self._pushed(
                        int(nodes[k]),
                        G[own, own],
                        force[k],
                        slips[k] + moves[k],
                        (gaps[k] + ways[k] @ drift, ways[k]),
                    )
                    step = new - force[k]
                    moves += (G[:, own] @ step).reshape(-1, 3)
                    force[k] = new
                    change = max(change, float(np.abs(step).max() * np.trace(G[own, own])))
                if change <= STILL_MM:
                    break
            if np.abs(moves - starts).max(initial=0.0) <= SETTLED_MM:
                break
        self._ways, self._moves = ways, moves
        return force, slid, slips

    def _anchors(
        self, collider: Collider, pose: tuple[np.ndarray, np.ndarray], nodes: np.ndarray
    ) -> np.ndarray:
        """Where each candidate is tied to [mm], shape (m, 3)."""
        past, rest, (origin, rotation) = self.past, self.skin.points_mm[nodes], pose
        tied = past.anchor_mm[nodes] @ rotation.T + origin
        if past.pose is None:
            fresh = rest
        else:
            left = rest + past.settled_mm[nodes]
            before, turn = past.pose
            carried = (left - before) @ turn @ rotation.T + origin
            gap, _ = _distance(collider, left, past.pose)
            deep, _ = _distance(collider, rest, pose)
            opened = np.maximum(gap, 0.0)
            share = opened / np.maximum(opened - np.minimum(deep, -1e-6), 1e-6)
            fresh = carried + share[:, None] * (left - carried)
        return np.where(past.held[nodes, None], tied, fresh)

    def _look(
        self,
        collider: Collider,
        pose: tuple[np.ndarray, np.ndarray],
        nodes: np.ndarray,
        moves: np.ndarray,
    ) -> tuple[list[np.ndarray], np.ndarray]:
        """Gaps of the spots of each candidate, and the direction it is pushed in, (m, 3)."""
        skin = self.skin
        now = skin.points_mm + self.past.settled_mm
        now[nodes] = skin.points_mm[nodes] + moves
        gaps, ways = [], np.zeros((len(nodes), 3))
        for k, node in enumerate(nodes):
            spots = slice(self.spots.starts[node], self.spots.starts[node + 1])
            others = now[self.spots.others[spots]].sum(axis=1)
            places = SPOT * now[node] + 0.5 * (1.0 - SPOT) * others
            gap, way = _clamped(*_distance(collider, places, pose), -skin.normals[node])
            gaps.append(gap)
            weight = self.spots.areas_mm2[spots] * np.exp(-np.maximum(gap, 0.0) / 0.05)
            total = weight @ way
            if np.linalg.norm(total) <= 1e-12:
                own = _distance(collider, now[node][None], pose)
                total = _clamped(*own, -skin.normals[node])[1][0]
            ways[k] = total / np.linalg.norm(total)
        return gaps, ways

    def _drift(self, nodes: np.ndarray, k: int, moved: np.ndarray) -> np.ndarray:
        """How far the spots of a candidate move, all alike, when candidates do, (m, 3)."""
        spots = slice(self.spots.starts[nodes[k]], self.spots.starts[nodes[k] + 1])
        others = self.spots.others[spots].ravel()
        places = np.searchsorted(nodes, others)
        known = (places < len(nodes)) & (nodes[np.minimum(places, len(nodes) - 1)] == others)
        beside = moved[places[known]].sum(axis=0) / len(others)
        return SPOT * moved[k] + (1.0 - SPOT) * beside

    def _pushed(
        self,
        node: int,
        own: np.ndarray,
        force: np.ndarray,
        slip: np.ndarray,
        seen: tuple[np.ndarray, np.ndarray],
    ) -> tuple[np.ndarray, bool]:
        """The force that settles a node, the others as they are, and whether it slides."""
        gaps, way = seen
        inward = -self.skin.normals[node]
        areas = self.spots.areas_mm2[self.spots.starts[node] : self.spots.starts[node + 1]]
        response = own @ inward
        stiff, before = way @ response, force @ inward
        softness = SOFTNESS * self._own[node] * self._areas[node]
        after = before
        for _ in range(NEWTON):
            opened = gaps + stiff * (after - before)
            over = opened < 0.0
            residual = softness * after + areas[over] @ opened[over]
            after = max(after - residual / (softness + stiff * areas[over].sum()), 0.0)
        if self.friction == 0.0 or after == 0.0:
            return after * inward, False
        slip = slip + response * (after - before)
        slip = slip - (slip @ way) * way
        soft = TANGENTIAL * (np.trace(own) - inward @ response)
        side = _turned(force - before * inward, inward, way) - slip / soft
        size, most_N = np.linalg.norm(side), self.friction * after
        if size > most_N:
            return after * inward + _turned(side, way, inward) * most_N / size, True
        return after * inward + _turned(side, way, inward), False

    def _remember(
        self,
        nodes: np.ndarray,
        force: np.ndarray,
        settled: np.ndarray,
        slid: np.ndarray,
        slips: np.ndarray,
        pose: tuple[np.ndarray, np.ndarray],
    ) -> None:
        past, rest, (origin, rotation) = self.past, self.skin.points_mm[nodes], pose
        touches = np.einsum("mi,mi->m", force, self.skin.normals[nodes]) < 0.0
        place = np.where(slid[:, None], rest + self._moves, rest - slips)
        past.force_N[:], past.held[:] = 0.0, False
        past.force_N[nodes[touches]] = force[touches]
        past.held[nodes[touches]] = True
        past.anchor_mm[nodes] = (place - origin) @ rotation
        past.settled_mm, past.pose = settled, pose


def _turned(vector: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """A vector turned as the unit vector `before` is to come to `after`, by Rodrigues' formula."""
    axis, cosine = np.cross(before, after), before @ after
    return cosine * vector + np.cross(axis, vector) + (axis @ vector) / (1.0 + cosine) * axis


def _distance(
    collider: Collider, places_mm: np.ndarray, pose: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Distance [mm] and its unit gradient at places of the sensor's frame, (P,) and (P, 3)."""
    origin, rotation = pose
    away, gradient = collider.distance((places_mm - origin) @ rotation)
    way = gradient @ rotation.T
    return away, way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9)


def _clamped(
    away: np.ndarray, way: np.ndarray, inward: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Distances along directions at most `TILT` off the inward normal, and those."""
    cosine = way @ inward
    side = way - cosine[:, None] * inward
    length = np.linalg.norm(side, axis=1)
    turned = np.cos(TILT) * inward + np.sin(TILT) * side / np.maximum(length, 1e-12)[:, None]
    along = np.einsum("pi,pi->p", way, turned)
    use = (length > np.sin(TILT)) & (along > LEAST_ALONG)
    return np.where(use, away / np.where(use, along, 1.0), away), np.where(
        use[:, None], turned, way
    )
