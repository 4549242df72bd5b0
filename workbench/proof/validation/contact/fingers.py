"""Contact: the finger at 45 degrees beside finite elements, its regions and its balance.

The finite elements (`finger_record`) are a patch of 9 mm held all around, pressed in ten steps, and
extrapolated to edge 0; so are the grids here, by F(h) = F0 + c h^p through three of them, p
observed: the finite elements fall, material points rise.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workbench.core.press.press import ContactSettings, Extent
from workbench.core.result.sensing import Contact
from workbench.proof.row import Row, bounded, compared
from workbench.proof.validation.contact.finger_record import (
    FINGER,
    ball_N,
    frictionless_N,
    sheared_N,
)
from workbench.proof.validation.contact.presses import NAME, finger_press, on_device
from workbench.view.press_figures import force_balance

PATCH_MM = 9.0
"""Radius of the patch of both."""
SHALLOW_MM = 0.5
GRIDS_MM = (0.5, 0.36, 0.26)
LIMIT = 0.04
DEFAULT_LIMIT = 0.06
SHEAR_LIMIT = 0.04
WIDE_MM = 20.0
REGIONS = {9.0: 5e-3, 12.0: 1e-3}
"""Largest error of the force by radius of the region [mm]."""
PENETRATION_CELLS = 0.01
MOMENT_LIMIT = 0.01
SETTLED_LIMIT = 5e-3
"""What the default tolerance may cost in force."""
TIGHT = 1e-4
BALANCE_LIMIT = 5e-3


def rows() -> list[Row]:
    """All rows of the finger."""
    return [*_grids(), *_regions(), _sheared(), *_state()]


def _grids() -> list[Row]:
    from sim.contact.studies import finger
    from sim.contact.studies.refinement import extrapolate

    case = f"{NAME}; patch of {PATCH_MM:g} mm, ten steps"
    reference = "FEM at edge 0, on record; null: frictionless FEM on its finest mesh"

    def at(grid_mm: float, depth_mm: float = 1.0) -> float:
        return finger.finger_45(grid_mm=grid_mm, active_radius_mm=PATCH_MM, depth_mm=depth_mm)

    def limit_N() -> float:
        return extrapolate(GRIDS_MM, tuple(at(grid_mm) for grid_mm in GRIDS_MM)).value

    found = [
        compared(
            "finger_45",
            f"{case}, {grid_mm:g} mm grid; {reference}",
            on_device(lambda grid_mm=grid_mm: at(grid_mm)),
            ball_N,
            unit="N",
            limit=DEFAULT_LIMIT,
            null=frictionless_N,
            record=FINGER,
        )
        for grid_mm in GRIDS_MM
    ]
    grids = "/".join(f"{grid_mm:g}" for grid_mm in GRIDS_MM)
    found.append(
        compared(
            "published_mode",
            f"{case}, {GRIDS_MM[0]:g} mm grid: this engine beside FEM as above; null: "
            "the published method, object made of points, on the same points and steps",
            on_device(lambda: at(GRIDS_MM[0])),
            ball_N,
            unit="N",
            limit=DEFAULT_LIMIT,
            record=FINGER,
            null=on_device(lambda: finger.published_45(active_radius_mm=PATCH_MM)),
        )
    )
    found.append(
        compared(
            "finger_45",
            f"{case}, extrapolated from grids of {grids} mm; {reference}",
            on_device(limit_N),
            ball_N,
            unit="N",
            limit=LIMIT,
            null=frictionless_N,
            record=FINGER,
        )
    )
    found.append(
        compared(
            "finger_45",
            f"{NAME.rpartition(',')[0]}, {SHALLOW_MM:g} mm deep; patch of {PATCH_MM:g} mm, ten "
            f"steps to 1 mm, {GRIDS_MM[0]:g} mm grid; reference: FEM at edge 0, on record; null: "
            "the force at 1 mm by the power 3/2 of the depth",
            on_device(lambda: at(GRIDS_MM[0], SHALLOW_MM)),
            lambda: ball_N(SHALLOW_MM),
            unit="N",
            limit=DEFAULT_LIMIT,
            null=lambda: ball_N() * SHALLOW_MM**1.5,
            record=FINGER,
        )
    )
    return found


def _regions() -> list[Row]:
    from sim.contact.studies import finger

    def full_N() -> float:
        return float(finger.press_45(extent=Extent.FULL, frames=1).normal_N[-1])

    return [
        compared(
            "region_error",
            f"region of {radius_mm:g} mm: force of a 1 mm press in one step against the whole "
            "membrane",
            on_device(
                lambda radius_mm=radius_mm: finger.finger_45(active_radius_mm=radius_mm, frames=1)
            ),
            on_device(full_N),
            unit="N",
            limit=limit,
        )
        for radius_mm, limit in REGIONS.items()
    ]


def _sheared() -> Row:
    from sim.contact.studies import finger

    return compared(
        "sheared_sphere",
        "1 mm deep, then 0.5 mm along V, five steps each, 0.5 mm grid; reference: FEM on the "
        "finest mesh on record; null: mu times the normal force, everything slipping",
        on_device(lambda: -float(finger.finger_45_sheared()[2])),
        sheared_N,
        unit="N",
        limit=SHEAR_LIMIT,
        record=FINGER,
        null=on_device(lambda: 0.3 * float(finger.finger_45_sheared()[0])),
    )


def _state() -> list[Row]:
    """Overlap, balance and residual of the default finger, built by the CAD kernel."""
    from sim.contact.studies import finger

    penalty = ContactSettings().penalty
    steps = "ten steps of 0.1 mm"

    def of_all(measure: Callable[[Contact], float]) -> Callable[[], float]:
        return on_device(lambda: max(measure(finger.press_45()), measure(finger_press())))

    return [
        bounded(
            "penetration",
            f"{NAME}; one step, and {steps}; penalty {penalty:g} E/dx",
            of_all(lambda contact: float(contact.penetration_mm.max()) / contact.grid_mm),
            unit="cell",
            limit=PENETRATION_CELLS,
        ),
        bounded(
            "force_balance",
            f"{NAME}; 12 mm region: reaction against support and left-out elastomer",
            of_all(force_balance),
            unit="1",
            limit=BALANCE_LIMIT,
        ),
        bounded(
            "force_balance",
            f"{NAME}; {WIDE_MM:g} mm region: reaction against the support alone",
            on_device(_wide_balance),
            unit="1",
            limit=BALANCE_LIMIT,
        ),
        bounded(
            "moment_balance",
            f"{NAME}; {WIDE_MM:g} mm region: moments of reaction and support about the origin, "
            "over the reaction's",
            on_device(_wide_moments),
            unit="1",
            limit=MOMENT_LIMIT,
        ),
        compared(
            "residual",
            f"{NAME}, one step: the force at the default tolerance beside one settled to {TIGHT:g}",
            on_device(lambda: _one_step_N(ContactSettings().tolerance)),
            on_device(lambda: _one_step_N(TIGHT)),
            unit="N",
            limit=SETTLED_LIMIT,
        ),
    ]


def _one_step_N(tolerance: float) -> float:
    from sim.contact.studies import finger

    return float(finger.press_45(frames=1, tolerance=tolerance).normal_N[-1])


def _wide_moments() -> float:
    from sim.contact.studies import finger

    contact = finger.press_45(active_radius_mm=WIDE_MM, frames=1)
    place_mm, reaction_N = contact.indenter_pose[-1, :3], contact.reaction_N[-1]
    moment_Nmm = contact.moment_Nmm[-1] + np.cross(place_mm, reaction_N)
    missing_Nmm = moment_Nmm - contact.support_moment_Nmm[-1]
    return float(np.linalg.norm(missing_Nmm) / np.linalg.norm(moment_Nmm))


def _wide_balance() -> float:
    from sim.contact.studies import finger

    contact = finger.press_45(active_radius_mm=WIDE_MM, frames=1)
    reaction_N, support_N = contact.reaction_N[-1], contact.support_N[-1]
    return float(np.linalg.norm(reaction_N - support_N) / np.linalg.norm(reaction_N))
