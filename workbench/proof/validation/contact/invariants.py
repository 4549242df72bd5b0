"""Contact: equilibrium of uniform strain, objectivity, mirrors, repeatability, devices."""

from __future__ import annotations

import numpy as np

from workbench.proof.row import Row, bounded
from workbench.proof.validation.contact import cuda_reference, repeat
from workbench.proof.validation.contact.presses import finger_press, on_device

PATCH_LIMIT = 1e-6
"""Sums of 27 cells in single precision, 6e-8 each."""
TURN_LIMIT = 1e-5
MIRROR_LIMIT = 1e-4
DEVICE_LIMIT = 1e-3
TWIN_LIMIT = 1e-13


def rows() -> list[Row]:
    """All rows of what holds exactly."""
    return [*_solid(), _mirror(), _threads(), _devices()]


def _solid() -> list[Row]:
    from sim.contact.studies import invariance

    def patch(name: str) -> float:
        found = invariance.patch_forces()
        return float(np.abs(getattr(found, name)[found.interior]).max()) / found.cell_N

    def turned(name: str) -> float:
        forces_N = getattr(invariance.turned_forces(), name)
        reaction_N = float(np.linalg.norm(finger_press().reaction_N[-1]))
        return float(np.linalg.norm(forces_N)) / reaction_N

    strain = f"{100 * np.abs(invariance.STRETCH).max():g} %"
    turn = f"block turned by {invariance.TURN_DEG:g} degrees: norm of all nodal forces over the "
    return [
        bounded(
            "patch_test",
            f"block under a uniform gradient of up to {strain}: largest force on an interior node "
            f"over the largest force of a cell, {name}",
            on_device(lambda field=field: patch(field)),
            unit="1",
            limit=limit,
        )
        for name, field, limit in (
            ("kernel, single precision", "kernel_N", PATCH_LIMIT),
            ("twin, double precision", "twin_N", TWIN_LIMIT),
        )
    ] + [
        bounded(
            "rigid_rotation",
            f"{turn}reaction of a 1 mm press, {name}",
            on_device(lambda field=field: turned(field)),
            unit="1",
            limit=limit,
        )
        for name, field, limit in (
            ("kernel, single precision", "kernel_N", TURN_LIMIT),
            ("twin, double precision", "twin_N", TWIN_LIMIT),
        )
    ]


def _mirror() -> Row:
    from sim.contact.studies import invariance

    return bounded(
        "mirror_symmetry",
        f"finger at 45 degrees and its mirror image in x, settled to {invariance.TOLERANCE:g}: "
        "difference of the mirrored forces over the force",
        on_device(invariance.mirror_error),
        unit="1",
        limit=MIRROR_LIMIT,
    )


def _threads() -> Row:
    return bounded(
        "determinism",
        "differing bytes of displacement and reaction of the same press with 1 and 2 CPU threads, "
        "each in a process of its own",
        repeat.differing_bytes,
        unit="byte",
        limit=0,
    )


def _devices() -> Row:
    return bounded(
        "cpu_gpu",
        f"{cuda_reference.how()}: largest relative difference of the forces",
        cuda_reference.difference,
        unit="1",
        limit=DEVICE_LIMIT,
        record=cuda_reference.used(),
    )
