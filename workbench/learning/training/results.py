"""What a training ends with: the weights as they are stored, measured, with the scores in the card.

Scores are those of the file: matrices are rounded to float16 first, then measured in float32.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from sim.forces.network.weights import NetworkWeights, Storage, weights_from_bytes, weights_to_bytes
from workbench.learning.dataset.cases import Split
from workbench.learning.training.presses import Presses, RestSkin

Predict = Callable[[np.ndarray], np.ndarray]


def final_weights(
    presses: Presses, weights: NetworkWeights, *, device: str, batch: int
) -> tuple[NetworkWeights, dict[str, Any]]:
    """The weights as a file holds them, with scores in the card, and the scores.

    Raises:
        StoreError: If a weight is not finite.
        DeviceError: If the device runs out of memory.
    """
    rounded = weights_from_bytes(*weights_to_bytes(weights, storage=Storage.HALF))
    predicts = [single_predictor(rounded, skin, device) for skin in presses.skins]
    scores = {
        split.value: score(presses, rounded, states, predicts, batch)
        for split in Split
        if split is not Split.TRAIN and (states := presses.of_split(split))
    }
    return dataclasses.replace(rounded, card={**rounded.card, "scores": scores}), scores


def score(
    presses: Presses,
    weights: NetworkWeights,
    states: Sequence[int],
    predicts: Sequence[Predict],
    batch: int,
) -> dict[str, Any]:
    """Mean absolute errors over all vertices, channels and samples, in the target's unit.

    Args:
        presses: The data.
        weights: What predicts, for its target.
        states: Samples to measure on, at least one.
        predicts: Of each skin, fields from what enters the network.
        batch: Samples at a time.
    """
    target = weights.target
    sums = np.zeros(2)
    for skin, of_skin in presses.by_skin(states).items():
        for first in range(0, len(of_skin), batch):
            own = of_skin[first : first + batch]
            fields = presses.fields(target, own, skin=skin, takes_force=weights.takes_force)
            away = np.abs(predicts[skin](fields.inputs) - fields.targets)
            sums[0] += away.mean(dtype=np.float64) * len(own)
            sums[1] += fields.zero_mae * len(own)
    raw = presses.raw_errors(target, states)
    return {
        "cases": len({presses.states[number].case for number in states}),
        "samples": len(states),
        "mae": float(sums[0]) / len(states),
        "zero_mae": float(sums[1]) / len(states),
        "mpm_mae": None if raw is None else float(raw.mean()),
    }


def single_predictor(weights: NetworkWeights, skin: RestSkin, device: str) -> Predict:
    """The network on a skin of the data, in float32.

    Raises:
        DeviceError: If the device has no room for it.
    """
    from sim.forces.network.steady import steady_predictor

    return steady_predictor(weights, skin.points_mm, skin.faces, device=device).predict


def batches(values: np.ndarray, size: int) -> Iterator[np.ndarray]:
    """Parts of so many along the first axis."""
    for first in range(0, len(values), size):
        yield values[first : first + size]
