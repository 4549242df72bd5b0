"""Any finger that passes its check is watertight, meshes without inversion and fills a lattice."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from designs.family import family, resolve_shape, sliders
from geometry.volume import checks
from geometry.volume.hexmesh import mesh_membrane
from geometry.volume.lattice import material_points
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers, Meshing
from workbench.core.result.results import Label, Solid


def random_finger(seed: int) -> tuple[dict[str, float], Layers]:
    """Parameters drawn evenly from the sliders until they pass the check."""
    generator = np.random.default_rng(seed)
    while True:
        shape = {s.name: float(generator.uniform(s.minimum, s.maximum)) for s in sliders("finger")}
        layers = Layers(
            support_mm=float(generator.uniform(0.4, 3.0)),
            elastomer_mm=float(generator.uniform(0.8, 6.0)),
        )
        try:
            family("finger").check(resolve_shape("finger", shape), layers)
        except DesignError:
            continue
        return shape, layers


@pytest.mark.parametrize("seed", [0, 1, pytest.param(2, marks=pytest.mark.slow)])
def test_random_fingers_are_sound(build_finger: Callable[..., Any], seed: int) -> None:
    """Closed bodies, all three regions, positive Jacobians, volumes kept."""
    shape, layers = random_finger(seed)
    solid: Solid = build_finger(layers, **shape)
    assert checks.watertight(solid)
    assert set(np.unique(solid.membrane.labels)) == {Label.OUTER, Label.INNER, Label.BASE}
    # The wall has at least two layers and no more than six, to keep the test short.
    hexes = mesh_membrane(solid, Meshing(hex_mm=max(0.6, layers.elastomer_mm / 6))).hexes
    assert checks.hex_least_quality(hexes) > 0.2
    assert checks.hex_volume_ratio(hexes, solid) == pytest.approx(1.0, abs=0.01)
    points = material_points(solid.membrane, 0.8)
    assert checks.lattice_volume_ratio(points, solid.membrane) == pytest.approx(1.0, abs=4e-3)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10, 26))
def test_many_random_fingers_are_watertight(build_finger: Callable[..., Any], seed: int) -> None:
    """Sixteen more, bodies only."""
    shape, layers = random_finger(seed)
    assert checks.watertight(build_finger(layers, **shape))
