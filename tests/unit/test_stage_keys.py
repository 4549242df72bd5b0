"""What a change of the design computes anew, told by keys alone: just these stages, no others."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest

from geometry.primitives import rounded_box
from workbench.core.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.lighting import LightModel
from workbench.core.motion import Mover
from workbench.core.press import ContactSettings, Press
from workbench.core.soft_body import SoftBody
from workbench.core.texture import Pattern, Texture
from workbench.pipeline import PressCase, needed, plan
from workbench.project import load_design

FILES = {"recipe", "package"}
SEEN = {"bake", "shoot", "maps"}
DEFORMED = {"press", "shoot"}
RINGED = {"housing", "picture", *FILES}


def rerun(field: str, value: object) -> set[str]:
    """Stages whose keys differ after one change of the default finger."""
    design = load_design("finger")
    before, after = plan(design, PressCase()), plan(design.replace(field, value), PressCase())
    return {name for name, call in before.items() if after[name].key != call.key}


@pytest.mark.parametrize(
    ("field", "value", "stages"),
    [
        ("optics.camera.fov_x_deg", 80.0, {"shoot", "maps"}),
        ("optics.camera.position_mm", (0.0, 0.0, 1.0), {"shoot", "maps", *RINGED}),
        ("optics.light_model", LightModel.LINEAR, SEEN),
        ("optics.ring.colours", ("#ffffff",), {*SEEN, *FILES}),
        ("optics.ring.power", 0.5, SEEN),
        ("optics.ring.emission_exponent", 2.0, SEEN),
        ("optics.ring.radius_mm", 8.5, {*SEEN, *RINGED}),
        ("optics.coating.albedo", 0.5, {"shoot", "maps"}),
        ("material.friction", 0.5, {"press", "shoot"}),
        ("material.density_g_cm3", 1.1, FILES),
        ("material.young_MPa", 0.2, {"press", "shoot", "maps", *FILES}),
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


def box(**fields: Any) -> Indenter:
    """An object of triangles."""
    points, faces = rounded_box(2.0, 0.5)
    given = IndenterMesh(points_mm=points, faces=faces)
    return Indenter(kind=IndenterKind.MESH, mesh=given, **fields)


DOTTED = Indenter(texture=Texture(pattern=Pattern.DOTS))
CUBE = dataclasses.replace(DOTTED, kind=IndenterKind.CUBE)


def test_an_object_of_triangles_is_sampled_once_for_all_its_presses() -> None:
    """Depth, target and material leave its key; rounding and grid change it, and the press."""
    design = load_design("finger")
    case = PressCase(indenter=box())
    call = plan(design, case)["object"]
    deeper = PressCase(indenter=box(), press=Press(depth_mm=1.5))
    assert plan(design, deeper)["object"].key == call.key
    assert plan(design.replace("material.young_MPa", 0.2), case)["object"].key == call.key
    rounded = plan(design, PressCase(indenter=box(mesh_rounding_mm=0.5)))
    finer = plan(design, PressCase(indenter=box(), settings=ContactSettings(grid_mm=0.4)))
    keys = {calls["object"].key for calls in (plan(design, case), rounded, finer)}
    assert len(keys) == 3
    assert call.ref in plan(design, case)["press"].inputs
    names = needed(plan(design, case), ("shoot",))
    assert names == ["build", "mesh", "lattice", "bake", "object", "press", "shoot"]


@pytest.mark.parametrize(
    ("before", "after", "stages"),
    [
        (box(), box(soft=SoftBody()), DEFORMED),
        (box(soft=SoftBody()), box(soft=SoftBody(young_MPa=0.3)), DEFORMED),
        (box(), box(edge_radius_mm=0.2), DEFORMED),
        (DOTTED, dataclasses.replace(DOTTED, soft=SoftBody()), DEFORMED),
        (DOTTED, dataclasses.replace(DOTTED, edge_radius_mm=0.2), DEFORMED),
        (DOTTED, dataclasses.replace(DOTTED, size_mm=7.0), {"object", *DEFORMED}),
        (CUBE, dataclasses.replace(CUBE, edge_radius_mm=0.2), {"object", *DEFORMED}),
    ],
)
def test_an_object_is_sampled_anew_for_its_shape_only(
    before: Indenter, after: Indenter, stages: set[str]
) -> None:
    """Softness, and an edge radius where there are no such edges, leave the sampled distance."""
    design = load_design("finger")
    first = plan(design, PressCase(indenter=before))
    second = plan(design, PressCase(indenter=after))
    assert {name for name, call in first.items() if second[name].key != call.key} == stages


def test_who_moves_is_part_of_a_press() -> None:
    """The result holds the poses of a moving sensor, with a trajectory and without."""
    design = load_design("finger")
    sensor = PressCase(press=Press(mover=Mover.SENSOR))
    before, after = plan(design, PressCase()), plan(design, sensor)
    assert {name for name, call in before.items() if after[name].key != call.key} == DEFORMED


def test_only_what_takes_long_to_sample_has_a_stage_of_its_own() -> None:
    """A ball has none, a ball with a pattern has one."""
    design = load_design("finger")
    assert "object" not in plan(design, PressCase())
    dots = Texture(pattern=Pattern.DOTS)
    assert "object" in plan(design, PressCase(indenter=Indenter(texture=dots)))
