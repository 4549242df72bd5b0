"""One case of the robustness matrix of the finite elements, solved and put into numbers."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from workbench.core.base.digest import digest
from workbench.core.base.errors import SolveError, WorkbenchError
from workbench.core.press.fem import FemSettings
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField
from workbench.pipeline.devices import open_device, solver_device
from workbench.proof.validation.fem.fem_cases import (
    DEPTH_MM,
    FAMILIES,
    FRAMES,
    OBJECTS,
    SHEAR_MM,
    TWIST_DEG,
    MatrixCase,
    material,
    membrane,
    object_of,
    press_of,
)

STEPS_AT = (FRAMES - 1, FRAMES + 4, FRAMES + 11)
"""Frames whose forces are recorded: the end of the press, of the first shear and of the second;
the last frame before the release is recorded too."""
LAST_BEFORE_RELEASE = -11


def solve_case(case: MatrixCase) -> dict[str, Any]:
    """Solve one case; never raises a WorkbenchError."""
    begun = time.process_time()
    result: ForceField | None = None
    try:
        _prepared(case)
        begun = time.process_time()
        result, why = _solved(case), ""
    except SolveError as error:
        result, why = error.partial, error.message
    except WorkbenchError as error:
        why = error.message
    return _told(case, result, why, time.process_time() - begun)


def _prepared(case: MatrixCase) -> None:
    """What a process does once for all its cases, and no case is charged with."""
    # The distance of a mesh is found by Taichi.
    open_device()
    press_of(case)
    membrane(case.family, case.hex_mm)


def _solved(case: MatrixCase) -> ForceField:
    from sim.fem.press import solve_press

    mesh = membrane(case.family, case.hex_mm)
    return solve_press(
        mesh,
        material(),
        PressCase(indenter=object_of(case.thing), press=press_of(case), fem=case.settings),
        device=solver_device(),
    )


def _told(case: MatrixCase, result: ForceField | None, why: str, cpu_s: float) -> dict[str, Any]:
    """What is kept of a case, for JSON."""
    outcome: dict[str, Any] = {"ok": False, "why": why, "cpu_s": round(cpu_s, 2), "frames": 0}
    if result is None:
        return outcome
    mu = material().friction
    chosen = [k for k in STEPS_AT if k < len(result.residual)]
    if not why:
        chosen.append(len(result.residual) + LAST_BEFORE_RELEASE)
    outcome["frames"] = len(result.residual)
    outcome["worst_residual"] = float(result.residual.max())
    outcome["worst_cone"] = float(result.friction_ratio.max()) / mu - 1.0
    outcome["worst_balance"] = float(result.balance.max())
    outcome["left_mm"] = float(np.abs(result.displacement_mm[-1]).max())
    outcome["increments"] = int(result.increments.sum())
    outcome["steps"] = int(result.steps.sum())
    outcome["solver"] = result.solver
    outcome["reaction_N"] = result.reaction_N[chosen].tolist()
    within = outcome["worst_residual"] <= case.settings.tolerance and outcome["worst_cone"] <= 1e-9
    outcome["ok"] = bool(not why and result.converged.all() and within)
    if not why and not outcome["ok"]:
        outcome["why"] = "a frame is beyond the tolerance or the friction cone"
    return outcome


def conditions(hex_mm: float = FemSettings().hex_mm) -> str:
    """Digest of the settings, material and paths that a record belongs to."""
    paths = [FRAMES, DEPTH_MM, SHEAR_MM, TWIST_DEG, list(OBJECTS), list(FAMILIES)]
    return digest([FemSettings(hex_mm=hex_mm), material(), paths])
