"""What enters a network: the contact solver's displacement, and its force where the network asks.

The force of a network that corrects the solver is what the solver says plus what the network adds,
so it begins at the solver's answer instead of at zero, and keeps what its points know finer than
the voxels. Statics is linear in E under prescribed displacements: where the gel differs from the
one of the training in E alone, the solver's force is divided by the ratio before it enters.
"""

from __future__ import annotations

import numpy as np

from sim.forces.network.spec import Target
from sim.forces.network.weights import NetworkWeights
from workbench.core.base.check import expect
from workbench.core.base.errors import SolveError

FORCE = slice(3, 6)
"""Channels of the force among those that enter; the displacement comes first."""


def given_field(
    weights: NetworkWeights,
    displacement_mm: np.ndarray,
    force_N: np.ndarray,
    *,
    factor: float = 1.0,
) -> np.ndarray:
    """What `Predictor.predict` takes, shape (..., 3) or (..., 6), float32.

    Args:
        weights: Of the network.
        displacement_mm: Displacement by the contact solver [mm], shape (..., 3).
        force_N: Contact force by the contact solver [N], shape (..., 3).
        factor: Young's modulus over that of the training.
    """
    if not weights.takes_force:
        return displacement_mm
    force = np.asarray(force_N, np.float32) / np.float32(factor)
    return np.concatenate([np.asarray(displacement_mm, np.float32), force], axis=-1)


def finite_batch(given: np.ndarray, *, points: int, channels: int) -> np.ndarray:
    """What enters a network for several samples, shape (B, V, I), of one or several.

    Raises:
        SolveError: If a number is not finite.
    """
    batch = given if given.ndim == 3 else given[None]
    expect(batch, f"B {points} {channels}", name="given")
    if not np.isfinite(batch).all():
        bad = np.count_nonzero(~np.isfinite(batch))
        raise SolveError(
            f"{bad} of {batch.size} numbers given to the network are not finite",
            hint="compute the press again",
            at="given",
        )
    return batch


def corrected_channels(target: Target) -> slice:
    """Channels of what enters that a correction of a target is added to."""
    return FORCE if target is Target.FORCE else slice(0, 3)
