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


def corrected_channels(target: Target) -> slice:
    """Channels of what enters that a correction of a target is added to."""
    return FORCE if target is Target.FORCE else slice(0, 3)
