"""Presses of the default finger by finite elements, each solved once per process."""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass

import numpy as np

from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer, Meshing
from workbench.core.press.fem import DRAFT_MM, HALVINGS, FemSettings
from workbench.core.press.indenter import BALL, Indenter, IndenterKind
from workbench.core.press.motion import release
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField
from workbench.core.result.results import MembraneMesh, Skin
from workbench.pipeline.stages.mesh import MeshInputs, mesh
from workbench.proof.specimens import finger_solid
from workbench.proof.validation.contact.presses import tip_target

FRAMES = 10
MIRROR = np.array([1.0, -1.0, 1.0])


@dataclass(frozen=True, kw_only=True, slots=True)
class Case:
    """One press of 1 mm into the tip at 45 degrees."""

    kind: IndenterKind = BALL
    shear_mm: tuple[float, float] = (0.0, 0.0)
    twist_deg: float = 0.0
    azimuth_deg: float = 0.0
    released: bool = False
    hex_mm: float = DRAFT_MM
    halvings: int = HALVINGS
    radius_mm: float = 12.0
    increment_mm: float = 0.1
    friction: float = 0.3
    mirrored: bool = False
    """Whether the membrane is the finger's mirror image in the plane y = 0."""


@functools.cache
def finger(hex_mm: float) -> MembraneMesh:
    """The default finger in hexahedra of an edge."""
    given = MeshInputs(solid=finger_solid(), meshing=Meshing(hex_mm=hex_mm), paired=True)
    return mesh(given, monitor=silent)


@functools.cache
def mirrored_finger(hex_mm: float) -> MembraneMesh:
    """Its mirror image in the plane y = 0, with the same numbers.

    The mesh of the finger itself is symmetric to a few micrometres only.
    """
    found = finger(hex_mm)
    hexes = found.hexes
    if hexes is not None:
        turned = [1, 0, 3, 2, 5, 4, 7, 6]
        hexes = dataclasses.replace(
            hexes,
            points_mm=hexes.points_mm * MIRROR,
            cells=np.ascontiguousarray(hexes.cells[:, turned]),
            groups=np.ascontiguousarray(hexes.groups[:, turned]),
        )
    skins = {name: _mirrored(getattr(found, name)) for name in ("outer", "inner", "cavity")}
    return dataclasses.replace(found, hexes=hexes, **skins)


def _mirrored(skin: Skin) -> Skin:
    return dataclasses.replace(
        skin,
        points_mm=skin.points_mm * MIRROR,
        normals=skin.normals * MIRROR,
        faces=np.ascontiguousarray(skin.faces[:, [0, 2, 1]]),
    )


@functools.cache
def solved(case: Case) -> ForceField:
    """The forces of a case, in 10 frames of press and 10 of shear or twist."""
    from sim.fem.press import solve_press

    strokes = (release(frames=5),) if case.released else ()
    press = Press(
        target_mm=tip_target(45.0, case.azimuth_deg),
        depth_mm=1.0,
        frames=FRAMES,
        shear_mm=case.shear_mm,
        twist_deg=case.twist_deg,
        strokes=strokes,
    )
    settings = FemSettings(
        hex_mm=case.hex_mm,
        halvings=case.halvings,
        radius_mm=case.radius_mm,
        increment_mm=case.increment_mm,
        error=False,
    )
    material = Elastomer(friction=case.friction)
    membrane = (mirrored_finger if case.mirrored else finger)(case.hex_mm)
    return solve_press(
        membrane, material, PressCase(indenter=Indenter(kind=case.kind), press=press, fem=settings)
    )
