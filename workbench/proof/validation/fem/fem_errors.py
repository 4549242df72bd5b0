"""Total forces of finite elements at their defaults beside the limits on record.

Ball and cone straight on the tip of the finger (`fem_limits`), with and without friction; ball and
flat end at 45 degrees (`finger_record`); each 0.5 and 1 mm deep.
"""

from __future__ import annotations

import itertools

from workbench.core.base.errors import StoreError
from workbench.core.press.indenter import IndenterKind
from workbench.proof.validation.contact.finger_record import FINGER
from workbench.proof.validation.contact.finger_record import limit_N as finger_limit_N
from workbench.proof.validation.fem import fem_limits
from workbench.proof.validation.fem.fem_presses import FRAMES, Case, solved

DEPTHS_MM = (0.5, 1.0)
ON_TIP = tuple(itertools.product(fem_limits.KINDS, fem_limits.FRICTIONS))
ASIDE = (IndenterKind("sphere"), IndenterKind("cylinder_end"))
COUNT = len(ON_TIP) + len(ASIDE)
"""Presses that have a limit."""
Beside = tuple[IndenterKind, list[tuple[float, float]]]
"""Object, and forces and their limits [N], depth by depth."""


def expect_fresh_limits() -> None:
    """Refuse limits that other code made.

    Raises:
        StoreError: With the command that makes them anew.
    """
    for record in (FINGER, fem_limits.RECORD):
        if record.stale():
            raise StoreError(record.stale(), hint=record.command, at=str(record.path))


def beside_limit(number: int, hex_mm: float) -> Beside:
    """Normal forces of a press and their limits at each of `DEPTHS_MM`.

    Args:
        number: Of the press, below `COUNT`.
        hex_mm: Edge of the hexahedra, which are halved under the contact as by default.

    Raises:
        StoreError: If a record cannot be read.
    """
    if number < len(ON_TIP):
        thing, mu = ON_TIP[number]
        kind = fem_limits.KINDS[thing]
        forces_N = [fem_limits.solved_N(thing, mu, hex_mm, depth) for depth in DEPTHS_MM]
        limits_N = [fem_limits.limit_N(thing, mu, depth) for depth in DEPTHS_MM]
    else:
        kind = ASIDE[number - len(ON_TIP)]
        found = solved(Case(kind=kind, hex_mm=hex_mm)).normal_N
        forces_N = [float(found[round(depth * FRAMES) - 1]) for depth in DEPTHS_MM]
        limits_N = [finger_limit_N(kind.value, depth)[0] for depth in DEPTHS_MM]
    return kind, list(zip(forces_N, limits_N, strict=True))
