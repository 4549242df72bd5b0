"""Where the parts of a sensor and its mould stand in the exploded view.

Two groups side by side, as in Fig. 9e of SimTac: the mould, its outer parts drawn apart and the
core below; and the sensor as a stack, from the top membrane, support, LED ring holder, base and
camera mount, with the sliders beside the base. The mould is turned about Z until it opens across
the drawing, so that the far cavity shows whichever way the best split lies. Only places are chosen
here; nothing is drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from geometry.drawing.rendering import screen_axes
from workbench.core.result.fabrication import FabricationPart, HousingSet, MouldSet
from workbench.core.result.results import Solid

OPENING_DEG = 55.0
"""Azimuth from the eye to the pull direction of the mould's first part."""
APART_SHARE = 0.3
"""How far a part of the mould is drawn out, over the largest extent of its footprint."""
GAP_SHARE = 0.26
"""Gap of the stack over the largest extent of the membrane's footprint."""
GROUP_GAP_SHARE = 0.4
"""Gap between the groups over the same extent."""
STACK = ("membrane", "support", "led_ring_holder", "housing_base", "camera_mount")
"""Parts of the sensor from the top."""


class Place(NamedTuple):
    """A part where it is drawn."""

    name: str
    points_mm: np.ndarray
    """Shape (N, 3)."""
    faces: np.ndarray
    """Shape (M, 3)."""


def exploded(solid: Solid, moulds: MouldSet, housing: HousingSet, eye: np.ndarray) -> list[Place]:
    """All parts, mould first, for a drawing seen from direction `eye`."""
    width_mm = float(np.ptp(solid.membrane.points_mm[:, :2], axis=0).max())
    right, up = screen_axes(eye)
    groups = [_mould(moulds, eye), _stack(solid, housing, width_mm)]
    places, edge_mm = [], 0.0
    for group in groups:
        points = np.concatenate([place.points_mm for place in group])
        across, height = points @ right, points @ up
        # Up is not Z, but a shift along Z by this much moves the group's middle to the line.
        lift_mm = -(height.min() + height.max()) / 2.0 / up[2]
        move = (edge_mm - across.min()) * right + np.array([0.0, 0.0, lift_mm])
        places += [place._replace(points_mm=place.points_mm + move) for place in group]
        edge_mm += float(np.ptp(across)) + GROUP_GAP_SHARE * width_mm
    return places


def _mould(moulds: MouldSet, eye: np.ndarray) -> list[Place]:
    wanted = np.arctan2(eye[1], eye[0]) + np.radians(OPENING_DEG)
    turn = wanted - np.radians(moulds.split_azimuth_deg)
    rotation = np.array(
        [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1.0]]
    )
    outer = [part for part in moulds.parts if not part.pull[2]]
    points = np.concatenate([part.points_mm for part in outer or moulds.parts])
    apart_mm = APART_SHARE * float(np.ptp(points[:, :2], axis=0).max())
    floor_mm, places = float(points[:, 2].min()), []
    for part in moulds.parts:
        pull = np.asarray(part.pull, dtype=np.float64)
        move = apart_mm * pull
        if pull[2]:
            drop_mm = part.points_mm[:, 2].max() - floor_mm + apart_mm
            move = np.array([0.0, 0.0, -drop_mm])
        places.append(Place(part.name, (part.points_mm + move) @ rotation.T, part.faces))
    return places


def _stack(solid: Solid, housing: HousingSet, width_mm: float) -> list[Place]:
    gap_mm, top_mm, foot_mm = GAP_SHARE * width_mm, 0.0, 0.0
    skin = solid.membrane
    known = {part.name: (part.points_mm, part.faces) for part in housing.parts}
    known["membrane"] = (skin.points_mm, skin.faces)
    places = []
    for name in (name for name in STACK if name in known):
        points, faces = known[name]
        drop = np.array([0.0, 0.0, top_mm - float(points[:, 2].max())])
        places.append(Place(name, points + drop, faces))
        top_mm = float(places[-1].points_mm[:, 2].min()) - gap_mm
        foot_mm = float(drop[2]) if name == "housing_base" else foot_mm
    return places + _beside(housing.parts, foot_mm)


def _beside(parts: Sequence[FabricationPart], foot_mm: float) -> list[Place]:
    """Parts that are not of the stack: drawn out sideways at the height of the base."""
    return [
        Place(
            part.name, part.points_mm + np.asarray(part.explode) + [0.0, 0.0, foot_mm], part.faces
        )
        for part in parts
        if part.name not in STACK
    ]
