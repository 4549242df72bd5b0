"""The contact solver in small and sharp contacts beside limits of the axisymmetric solver.

A lattice that is moved by half a cell must not change the force.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.sensing import Contact
from workbench.proof.row import Row, bounded, compared
from workbench.proof.validation.contact.presses import GRID_MM, on_device, tip_target
from workbench.proof.validation.fem.fem_limits import limit_N

FRAMES = 10
FRICTIONS = (0.0, 0.3)
TIP_LIMITS = {0.2: 0.08, 0.3: 0.05, 0.5: 0.05, 1.0: 0.05}
"""By depth [mm]."""
RING_MM, TUBE_MM = 2.5, 1.0
HALF_ANGLE_DEG, APEX_MM = 60.0, 0.45
CONE_RIM_MM = 3.0
AROUND, ACROSS = 256, 96
"""Facets of the made objects: they lie at most .0006 mm inside the round ones."""
SHIFTS_MM = ((0.0, 0.0, 0.0), (0.25, 0.25, 0.0), (0.125, 0.125, 0.06))
SHIFTED_FRAMES, SHIFTED_FROM = 3, 1
"""Frames of .1 mm; those after the first are compared."""
SHIFT_LIMIT = 0.03
"""Before cells were halved under it, the cone read 48 % more at .2 mm and 23 % more at .3."""


def rows() -> list[Row]:
    """All rows of tips."""
    return [*_tips(), _shifted()]


def _tips() -> Iterator[Row]:
    titles = {
        "torus": f"ring of {RING_MM:g} mm, tube {TUBE_MM:g} mm",
        "wide_cone": f"cone of {2 * HALF_ANGLE_DEG:g} degrees, apex {APEX_MM:g} mm",
    }
    for thing, title in titles.items():
        for friction in FRICTIONS:
            for depth_mm, limit in TIP_LIMITS.items():
                yield compared(
                    "mpm_limit",
                    f"{title}, on the tip of the finger, {depth_mm:g} mm deep, friction "
                    f"{friction:g}: contact solver, grid {GRID_MM:g} mm",
                    on_device(functools.partial(_tip_N, thing, friction, depth_mm)),
                    limit_N(thing, friction, depth_mm),
                    unit="N",
                    limit=limit,
                )


def _shifted() -> Row:
    return bounded(
        "lattice_shift",
        "cone of 90 degrees on the tip, .2 and .3 mm deep: largest change of the force on lattices "
        "moved by up to half a cell",
        on_device(_shift_error),
        unit="1",
        limit=SHIFT_LIMIT,
        sense="max",
    )


def _tip_N(thing: str, friction: float, depth_mm: float) -> float:
    return float(_tip(thing, friction).normal_N[round(depth_mm * FRAMES) - 1])


@functools.cache
def _tip(thing: str, friction: float) -> Contact:
    """A press of 1 mm into the tip of the finger with exact skins."""
    indenter = _ring() if thing == "torus" else _wide_cone()
    return _pressed(indenter, friction, frames=FRAMES)


def _pressed(
    indenter: Indenter,
    friction: float,
    *,
    frames: int,
    shift_mm: tuple[float, float, float] = SHIFTS_MM[0],
) -> Contact:
    """So many frames of .1 mm."""
    from sim.contact.press import press_membrane
    from sim.contact.studies.specimens import finger

    mesh, points = finger(grid_mm=GRID_MM, shift_mm=shift_mm)
    x_mm, y_mm, z_mm = np.add(tip_target(0.0, 0.0), shift_mm).tolist()
    path = Press(target_mm=(x_mm, y_mm, z_mm), depth_mm=frames / FRAMES, frames=frames)
    settings = ContactSettings(grid_mm=GRID_MM)
    case = PressCase(indenter=indenter, press=path, settings=settings)
    return press_membrane(mesh, points, Elastomer(friction=friction), case)


def _shift_error() -> float:
    cone = Indenter(kind=IndenterKind("cone"))
    forces_N = np.array(
        [_pressed(cone, 0.0, frames=SHIFTED_FRAMES, shift_mm=each).normal_N for each in SHIFTS_MM]
    )
    changes = forces_N / forces_N[0] - 1.0
    return float(np.abs(changes[:, SHIFTED_FROM:]).max())


def _ring() -> Indenter:
    import trimesh

    made = trimesh.creation.torus(RING_MM, TUBE_MM, major_sections=AROUND, minor_sections=ACROSS)
    return _indenter(made, 2.0 * (RING_MM + TUBE_MM))


def _wide_cone() -> Indenter:
    import trimesh

    angle = math.radians(HALF_ANGLE_DEG)
    turn = np.linspace(0.0, 0.5 * math.pi - angle, ACROSS // 4)
    apex = APEX_MM * np.stack([np.sin(turn), 1.0 - np.cos(turn)], axis=1)
    rise_mm = (CONE_RIM_MM - apex[-1, 0]) / math.tan(angle)
    flank = np.linspace(apex[-1], [CONE_RIM_MM, apex[-1, 1] + rise_mm], ACROSS // 4)[1:]
    section = np.concatenate([apex, flank, [[0.0, flank[-1, 1]]]])
    section -= [0.0, 0.5 * flank[-1, 1]]
    return _indenter(trimesh.creation.revolve(section, sections=AROUND), 2.0 * CONE_RIM_MM)


def _indenter(made: Any, size_mm: float) -> Indenter:
    points_mm, faces = np.asarray(made.vertices, float), np.asarray(made.faces, np.int32)
    mesh = IndenterMesh(points_mm=points_mm, faces=faces)
    return Indenter(kind=IndenterKind("mesh"), size_mm=size_mm, mesh=mesh)
