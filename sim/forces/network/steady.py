"""The network for results that are kept or judged: in float32, and not worth compiling."""

from __future__ import annotations

import numpy as np

from sim.forces.network.acceleration import Acceleration
from sim.forces.network.patches import PatchPredictor
from sim.forces.network.predictor import Precision, Predictor
from sim.forces.network.weights import NetworkWeights

SteadyPredictor = Predictor | PatchPredictor


def steady_predictor(
    weights: NetworkWeights, points_mm: np.ndarray, faces: np.ndarray, *, device: str
) -> SteadyPredictor:
    """What predicts with these weights, on the whole skin or on patches as they were trained.

    Args:
        weights: Of the trained network.
        points_mm: Points of the skin at rest [mm], shape (V, 3).
        faces: Triangles between them, shape (F, 3).
        device: `cpu` or `cuda`.

    Raises:
        DesignError: As `Predictor`.
        DeviceError: As `Predictor`.
        StoreError: As `Predictor`.
    """
    points_mm, faces = np.asarray(points_mm), np.asarray(faces)
    if weights.patch_spacings:
        return PatchPredictor(weights, points_mm, faces=faces, device=device)
    return Predictor(
        weights,
        points_mm,
        faces=faces,
        device=device,
        precision=Precision.SINGLE,
        acceleration=Acceleration.EAGER,
    )
