"""The presses that a skin's hardening is fitted to, and the fit itself.

A ball, a flat end and an edged block of 6 mm, pressed half the wall deep and sheared: what the
contact solver finds for them beside what the condensed skin says of the same poses.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim.condensed.fast_contact import FastContact
from sim.condensed.hardening import PlayedPress, fit, sharpness
from sim.contact.objects.collider import Collider, make_collider
from workbench.core.design.design import Elastomer
from workbench.core.objects.kind import Shape, kinds
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import Press
from workbench.core.result.condensed import CondensedSkin, Hardening
from workbench.core.result.sensing import Contact

KINDS = tuple(
    IndenterKind(next(name for name, kind in kinds().items() if kind.shape is shape))
    for shape in (Shape.SPHERE, Shape.CYLINDER_Z, Shape.CUBE)
)
"""A ball, a flat end, an edged block."""
SIZE_MM = 6.0
DEPTH_WALLS, LEAST_MM, MOST_MM = 0.5, 0.4, 1.5
"""Depth of the presses in walls, and within what it stays [mm]."""
FRAMES = 6
SHEAR = 0.5
"""Shear after it, in depths."""
SAMPLES_MM = 0.25
"""Cell by which objects known by samples are sampled [mm]."""
NEAR_MM = 9.0
"""Radius about the target within which nodes can be touched or move what is."""


def lessons(target_mm: tuple[float, float, float], wall_mm: float) -> list[tuple[Indenter, Press]]:
    """Objects and their presses on a wall of so much elastomer."""
    depth_mm = float(np.clip(DEPTH_WALLS * wall_mm, LEAST_MM, MOST_MM))
    path = Press(
        target_mm=target_mm,
        depth_mm=depth_mm,
        frames=FRAMES,
        shear_mm=(round(SHEAR * depth_mm, 3), 0.0),
    )
    return [(Indenter(kind=kind, size_mm=SIZE_MM), path) for kind in KINDS]


def learnt(
    skin: CondensedSkin,
    material: Elastomer,
    presses: Sequence[tuple[Indenter, Contact]],
) -> Hardening:
    """The law that fits presses of the contact solver; the device must be open."""
    fast = FastContact(skin, Hardening(), material)
    return fit([played(fast, indenter, contact) for indenter, contact in presses])


def played(fast: FastContact, indenter: Indenter, contact: Contact) -> PlayedPress:
    """A press of the contact solver, pose by pose, by fast contact."""
    thing = collider_of(indenter)
    poses = contact.indenter_pose
    fast.reset(1)
    # From just above the skin, as the press began.
    fast.step(thing, before(poses)[None])
    frames = []
    for pose in poses:
        fast.step(thing, pose[None])
        frames.append(fast.played(0))
    return PlayedPress(
        name=indenter.kind.value,
        frames=frames,
        reaction_N=contact.reaction_N,
        normal=contact.normal,
        sharpness=sharpness(thing.least_radius_mm, float(np.median(fast.skin.wall_mm))),
    )


def before(poses: np.ndarray) -> np.ndarray:
    """The pose a frame before the first of several, (K, 7), on the same way: shape (7,)."""
    found = poses[0].copy()
    if len(poses) > 1:
        found[:3] = 2.0 * poses[0, :3] - poses[1, :3]
    return found


def collider_of(indenter: Indenter) -> Collider:
    """A rigid object for fast contact."""
    return make_collider(indenter, grid_mm=SAMPLES_MM)
