"""What a change of the design computes anew, told by keys alone: just these stages, no others."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import pytest

from geometry.surface.primitives import rounded_box
from tests.made_weights import card_of, tiny_weights, write_tiny
from workbench.core.base.errors import DesignError
from workbench.core.design.lighting import LightModel
from workbench.core.press.fem import DRAFT_MM, FemSettings
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.press.motion import Mover
from workbench.core.press.press import ContactSettings, Method, Press
from workbench.core.press.press_case import PressCase
from workbench.core.press.soft_body import SoftBody
from workbench.core.press.texture import Pattern, Texture
from workbench.live.live_press import live_design
from workbench.pipeline import shipped
from workbench.planning.plan import needed, plan
from workbench.project.named_designs import load_design

FILES = {"recipe", "package"}
SEEN = {"bake", "table", "shoot", "maps"}
LOOKED = {"table", "shoot", "maps"}
SOLVED = {"fem", "forces"}
CONDENSED = {"condensed", "hardening"}
DEFORMED = {"press", "shoot", "learned", *SOLVED}
RINGED = {"housing", "picture", *FILES}


@pytest.fixture(autouse=True)
def weights(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A tiny network in place of the shipped ones, so that there is a stage `learned`."""
    monkeypatch.setattr(shipped, "FOLDER", tmp_path)
    write_tiny(tmp_path, tiny_weights(card=card_of(load_design("finger"), hex_mm=0.9)))


def rerun(field: str, value: object) -> set[str]:
    """Stages whose keys differ after one change of the default finger."""
    design = load_design("finger")
    before, after = plan(design, PressCase()), plan(design.replace(field, value), PressCase())
    return {name for name, call in before.items() if after[name].key != call.key}


@pytest.mark.parametrize(
    ("field", "value", "stages"),
    [
        ("optics.camera.fov_x_deg", 80.0, {"shoot", "maps"}),
        ("optics.camera.position_mm", (0.0, 0.0, 1.0), {*LOOKED, *RINGED}),
        ("optics.light_model", LightModel.TABLE, SEEN),
        ("optics.ring.colours", ("#ffffff",), {*SEEN, *FILES}),
        ("optics.ring.power", 0.5, SEEN),
        ("optics.ring.emission_exponent", 2.0, SEEN),
        ("optics.ring.radius_mm", 8.5, {*SEEN, *RINGED}),
        ("optics.coating.albedo", 0.5, SEEN),
        ("material.friction", 0.5, {"hardening", *DEFORMED}),
        ("material.density_g_cm3", 1.1, FILES),
        ("material.young_MPa", 0.2, {"maps", *CONDENSED, *DEFORMED, *FILES}),
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


def test_finite_elements_have_a_mesh_of_their_own() -> None:
    """The design's mesh says only where forces are shown; a finer FEM mesh leaves the press."""
    design = load_design("finger")
    before = plan(design, PressCase())
    coarser = plan(design.replace("meshing.hex_mm", 0.8), PressCase())
    assert coarser["fem"].key == before["fem"].key
    assert coarser["forces"].key != before["forces"].key
    assert coarser["learned"].key != before["learned"].key
    draft = plan(design, PressCase(fem=FemSettings(hex_mm=DRAFT_MM)))
    assert {name for name, call in before.items() if draft[name].key != call.key} == SOLVED


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
    assert call.ref in plan(design, case)["press"].values
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


FINE = Indenter(texture=Texture(pattern=Pattern.WAVES, height_mm=0.03, pitch_mm=0.5))


def test_images_read_an_object_only_for_its_texture() -> None:
    """Smooth objects leave their key; of a textured one detail, and the switch, are in it."""
    design = load_design("finger")
    plain = design.replace("optics.detail", False)
    assert plan(design, PressCase())["shoot"].key == plan(plain, PressCase())["shoot"].key
    dotted = PressCase(indenter=DOTTED)
    shown, hidden = (plan(d, dotted) for d in (design, plain))
    assert {name for name, call in shown.items() if hidden[name].key != call.key} == {"shoot"}
    assert [i for i in shown["shoot"].values if isinstance(i, Indenter)] == [
        dataclasses.replace(DOTTED, edge_radius_mm=Indenter().edge_radius_mm)
    ]
    assert not [i for i in hidden["shoot"].values if isinstance(i, Indenter)]


@pytest.mark.parametrize(
    ("design_field", "case", "says"),
    [
        (("optics.detail", False), PressCase(indenter=FINE), "optics.detail is off"),
        (
            ("optics.detail", True),
            PressCase(indenter=dataclasses.replace(FINE, soft=SoftBody())),
            "no detail is shown of a soft object",
        ),
        (
            ("optics.detail", True),
            PressCase(indenter=FINE, settings=ContactSettings(method=Method.PARTICLES)),
            "particles finds no pressure",
        ),
        (
            ("optics.light_model", LightModel.PHOTONS),
            PressCase(indenter=FINE),
            "the light model photons shows no detail",
        ),
    ],
)
def test_a_texture_that_nothing_shows_is_refused(
    design_field: tuple[str, object], case: PressCase, says: str
) -> None:
    """0.5 mm wide, contact holds 0.8 mm: a press goes on only where images show the rest."""
    design = load_design("finger")
    assert "object" in plan(design, PressCase(indenter=FINE))
    with pytest.raises(DesignError, match=r"contact resolves 0\.80 mm") as caught:
        plan(design.replace(*design_field), case)
    assert says in caught.value.message
    assert "raise the pitch to 0.80 mm or lower contact.grid_mm" in caught.value.hint
    close = dataclasses.replace(case.settings, grid_mm=0.25)
    plan(design.replace(*design_field), dataclasses.replace(case, settings=close))


def test_live_presses_bake_instead_of_tracing_every_frame() -> None:
    """A reference of 10^9 photons a frame is shown live by a bake of the usual 4 million."""
    traced = load_design("finger").replace("optics.light_model", LightModel.PHOTONS)
    shown = live_design(traced.replace("optics.baking.photons", 10**9)).optics
    assert shown.light_model is LightModel.HYBRID
    assert shown.baking.photons == 4_000_000
