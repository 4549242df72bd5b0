"""The trained networks that come with the workbench: a newcomer has learned forces at once."""

from __future__ import annotations

from pathlib import Path

from sim.forces.network.spec import Target
from sim.forces.network.weights import SUFFIX
from workbench.core.base.errors import StoreError

FOLDER = Path(__file__).parent / "shipped_weights"
RETRAIN = "workbench train make DATA --preset small --target {target} --out DIR"
"""The command that makes such weights."""


def shipped_weights(target: Target) -> Path:
    """The file of the shipped network for a target.

    Raises:
        StoreError: If none is shipped.
    """
    found = sorted(FOLDER.glob(f"*-{target.value}-*{SUFFIX}"))
    if not found:
        raise StoreError(
            f"no trained network for {target.value} comes with this version",
            hint=f"train one: {RETRAIN.format(target=target.value)}",
            at="learned.weights",
        )
    return found[0]


def is_shipped(target: Target) -> bool:
    """Whether there is one."""
    return any(FOLDER.glob(f"*-{target.value}-*{SUFFIX}"))
