"""What a change of the design computes anew, told by keys alone: just these stages, no others."""

from __future__ import annotations

import pytest

from workbench.core.design import LightModel
from workbench.pipeline import PressCase, plan
from workbench.project import load_design

FILES = {"recipe", "package"}
SEEN = {"bake", "shoot"}
RINGED = {"housing", "picture", *FILES}


def rerun(field: str, value: object) -> set[str]:
    """Stages whose keys differ after one change of the default finger."""
    design = load_design("finger")
    before, after = plan(design, PressCase()), plan(design.replace(field, value), PressCase())
    return {name for name, call in before.items() if after[name].key != call.key}


@pytest.mark.parametrize(
    ("field", "value", "stages"),
    [
        ("optics.camera.fov_x_deg", 80.0, {"shoot"}),
        ("optics.camera.position_mm", (0.0, 0.0, 1.0), {"shoot", *RINGED}),
        ("optics.light_model", LightModel.LINEAR, SEEN),
        ("optics.ring.colours", ("#ffffff",), {*SEEN, *FILES}),
        ("optics.ring.power", 0.5, SEEN),
        ("optics.ring.emission_exponent", 2.0, SEEN),
        ("optics.ring.radius_mm", 8.5, {*SEEN, *RINGED}),
        ("optics.coating.albedo", 0.5, {"shoot"}),
        ("material.friction", 0.5, {"press", "shoot"}),
        ("material.density_g_cm3", 1.1, FILES),
        ("material.young_MPa", 0.2, {"press", "shoot", *FILES}),
        ("casting.silicone", "Solaris", FILES),
        ("casting.waste_percent", 30.0, FILES),
        ("mould.draft_deg", 1.0, {"mould", "picture", *FILES}),
        ("mould.bed_mm", (200.0, 200.0, 200.0), {"mould", *RINGED}),
        ("housing.wall_mm", 2.5, RINGED),
    ],
)
def test_a_change_reruns_what_reads_it(field: str, value: object, stages: set[str]) -> None:
    """The stages named beside the field, by their keys."""
    assert rerun(field, value) == stages
