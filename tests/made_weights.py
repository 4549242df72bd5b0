"""Tiny force networks made on the spot: their last layer gives the same everywhere, if wanted."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sim.forces.network.minkunet import arrays_of, new_network
from sim.forces.network.spec import NetworkSpec, Target
from sim.forces.network.weights import NetworkWeights, Storage
from workbench.core.design.design import SensorDesign
from workbench.pipeline.weight_files import save_weights
from workbench.project.design_toml import design_table

SPEC = NetworkSpec(name="tiny", planes=(4,) * 8, stem_planes=4)


def tiny_weights(
    value: tuple[float, float, float] | None = None,
    target: Target = Target.FORCE,
    card: Mapping[str, Any] | None = None,
) -> NetworkWeights:
    """A network that gives `value` everywhere, or with None one that was never trained."""
    arrays = dict(arrays_of(new_network(SPEC, seed=3)))
    if value is not None:
        arrays["last.weight"] = np.zeros_like(arrays["last.weight"])
        arrays["last.bias"] = np.array(value, np.float32)
    return NetworkWeights(
        spec=SPEC,
        arrays=arrays,
        target=target,
        input_scale_mm=0.5,
        output_scale=(1.0, 1.0, 1.0),
        voxel_per_spacing=0.75,
        spacing_mm=1.0,
        card=card or {},
    )


def card_of(design: SensorDesign, *, hex_mm: float, grid_mm: float = 0.5) -> dict[str, Any]:
    """The data card of a training on a design with the default material, object and press."""
    return {
        "dataset": {"design": design_table(design)},
        "membrane": {},
        "hex_mm": hex_mm,
        "grid_mm": grid_mm,
        "young_MPa": 0.145,
        "poisson": 0.45,
        "friction": 0.3,
        "law": "neo_hookean",
        "indenters": ["sphere", "cube"],
        "size_mm": [6.0],
        "depth_mm": 1.0,
        "shear_mm": 0.5,
        "max_displacement_mm": 1.2,
    }


def write_tiny(folder: Path, weights: NetworkWeights) -> Path:
    """Write weights into a folder; returns the file."""
    return save_weights(folder, weights, storage=Storage.SINGLE)
