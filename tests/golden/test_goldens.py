"""A tiny golden per stage: when the output changes, the stage's version must change with it.

`WORKBENCH_UPDATE_GOLDENS=1 pytest tests/golden` writes the numbers anew.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from workbench.core.base.codec import pack
from workbench.core.design.camera import Camera
from workbench.core.design.design import Meshing, SensorDesign
from workbench.core.design.lighting import Baking, LedRing
from workbench.core.design.optics import Coating, Optics
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, evaluate, plan, results
from workbench.planning.stage_table import STAGES

FILE = Path(__file__).parent / "stages.json"
DESIGN = SensorDesign(
    shape={"outer_radius_mm": 8.0, "cylinder_mm": 8.0},
    meshing=Meshing(hex_mm=0.8),
    optics=Optics(
        camera=Camera(width_px=64, height_px=48),
        ring=LedRing(radius_mm=3.0),
        # The coating of the recorded numbers, which is no longer that of a new design.
        coating=Coating(albedo=0.6, specular=0.04, roughness=0.35),
        baking=Baking(photons=200_000, nodes=1000),
    ),
)
CASE = PressCase(
    press=Press(target_mm=(0.0, 0.0, 16.0), depth_mm=0.5, frames=1),
    # At the default tolerance rounding decides, by the make of the processor, in which step a press
    # ends: a mean stress then moves by 3e-3, a mean energy by 1e-2.
    settings=ContactSettings(grid_mm=0.8, active_radius_mm=6.0, tolerance=2e-5),
)
STAGES_WITH_NUMBERS = tuple("build mesh lattice bake table press shoot maps mould".split())
RELATIVE = 2e-3
"""Libraries and compilers move the last digits; a changed method moves more."""
SKIPPED = ("brep", "device", "seconds", "substeps", "residual", "kinetic", "moment")
"""Text of the CAD kernel, names, what depends on when the relaxation stops, and moments, which are
zero by symmetry here: of a press on the very tip only rounding is left."""


def summary(value: Any) -> dict[str, list[float]]:
    """Size, mean and mean magnitude of every numeric array of a result."""
    arrays, _ = pack(value)
    numbers = {}
    for name, array in sorted(arrays.items()):
        if any(word in name for word in SKIPPED):
            continue
        finite = np.asarray(array, np.float64)
        finite = finite[np.isfinite(finite)]
        mean = float(finite.mean()) if finite.size else 0.0
        size = float(np.abs(finite).mean()) if finite.size else 0.0
        numbers[name] = [float(array.size), mean, size]
    return numbers


@pytest.mark.parametrize("stage", STAGES_WITH_NUMBERS)
def test_golden_is_that_of_the_version(stage: str) -> None:
    """A bumped version without a renewed golden is seen at once, not only by the slow test."""
    assert json.loads(FILE.read_text())[stage]["version"] == STAGES[stage].version


@pytest.fixture(scope="module")
def computed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Summaries of all stages of a small coarse finger."""
    store = Store(tmp_path_factory.mktemp("golden"))
    for _ in evaluate(DESIGN, CASE, InlineRunner(store), wanted=STAGES_WITH_NUMBERS):
        pass
    found = results(store, plan(DESIGN, CASE), STAGES_WITH_NUMBERS)
    numbers = {
        name: {"version": STAGES[name].version, "numbers": summary(value)}
        for name, value in found.items()
    }
    if os.environ.get("WORKBENCH_UPDATE_GOLDENS"):
        FILE.write_text(json.dumps(numbers, indent=1) + "\n")
    return numbers


@pytest.mark.slow
@pytest.mark.parametrize("stage", STAGES_WITH_NUMBERS)
def test_output_changes_only_with_the_version(computed: dict[str, Any], stage: str) -> None:
    """The summary equals the recorded one, or the version was bumped and the golden renewed."""
    golden = json.loads(FILE.read_text())[stage]
    message = f"output of {stage} changed: bump its version and update the goldens, or fix it"
    assert computed[stage]["version"] == golden["version"], "update the goldens of a new version"
    now, then = computed[stage]["numbers"], golden["numbers"]
    assert now.keys() == then.keys(), message
    for name, (size, mean, magnitude) in now.items():
        assert size == pytest.approx(then[name][0], rel=RELATIVE), f"{message}: {name}"
        scale = max(abs(then[name][2]), 1e-12)
        assert abs(mean - then[name][1]) <= RELATIVE * scale, f"{message}: {name}"
        assert abs(magnitude - then[name][2]) <= RELATIVE * scale, f"{message}: {name}"
