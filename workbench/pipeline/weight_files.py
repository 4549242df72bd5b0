"""Weights of force networks into files, whole or not at all. The network reads them."""

from __future__ import annotations

from pathlib import Path

from sim.forces.network.weights import NetworkWeights, Storage, weights_to_bytes
from workbench.system.whole_files import write_atomically


def save_weights(folder: Path, weights: NetworkWeights, *, storage: Storage) -> Path:
    """Write weights under the name that their content gives them.

    Args:
        folder: Where to; it is made if it is not there.
        weights: What to write.
        storage: Type of the matrices in the file: half for weights that are shipped.

    Raises:
        StoreError: If a weight is not finite, or the disk is full or read-only.
    """
    name, content = weights_to_bytes(weights, storage=storage)
    write_atomically(folder / name, content)
    return folder / name
