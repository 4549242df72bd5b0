"""What weights do not know of a press is said, one sentence each; the rest is silent."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from sim.forces.acquaintance import NEEDED, Acquaintance, Membrane, acquaintance
from sim.forces.network.spec import Target
from workbench.core.design.design import Elastomer, Law
from workbench.core.design.inclusion import Inclusion
from workbench.core.press.actuation import Actuation
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.motion import hold, press_stroke, release, slide, twist
from workbench.core.press.press import ContactSettings, Method, Press
from workbench.core.press.press_case import PressCase
from workbench.core.press.soft_body import SoftBody
from workbench.core.press.texture import Pattern, Texture
from workbench.core.press.trajectory import Trajectory

DENSE_MM = np.array([[0.0, 0.0, 0.0], [20.0, 20.0, 40.0]] * 2)
BOX_MM = np.array([[0.0, 0.0, 0.0], [20.0, 20.0, 40.0]])
CARD: dict[str, Any] = {
    "membrane": {"vertices": 2, "bounds_mm": BOX_MM.tolist()},
    "young_MPa": 0.145,
    "poisson": 0.45,
    "friction": 0.3,
    "law": "neo_hookean",
    "indenters": ["sphere", "cube"],
    "size_mm": 6.0,
    "edge_radius_mm": 0.45,
    "depth_mm": 1.0,
    "shear_mm": 0.5,
    "grid_mm": 0.5,
    "max_displacement_mm": 1.2,
}
KNOWN: dict[str, Any] = {
    "card": CARD,
    "target": Target.FORCE,
    "membrane": Membrane(differences=()),
    "material": Elastomer(),
}


def judged(**changed: Any) -> Acquaintance:
    """The verdict on the known press with some parts of it changed."""
    parts = {field.name for field in dataclasses.fields(PressCase)} & set(changed)
    case = PressCase(**{name: changed.pop(name) for name in parts})
    return acquaintance(**KNOWN | changed, case=case)


def test_what_was_trained_on_is_known() -> None:
    """Membrane, material, object, path and solver as in the card, at their limits."""
    assert judged() == Acquaintance()
    sheared = Press(depth_mm=1.0, strokes=(slide(0.5, -0.5), hold()))
    assert judged(press=sheared, largest_mm=1.2) == Acquaintance()
    assert judged(indenter=Indenter(kind=IndenterKind.CUBE)) == Acquaintance()
    # A ball has no edges to be rounded otherwise.
    assert judged(indenter=Indenter(edge_radius_mm=0.1)) == Acquaintance()


DRIVEN = Actuation(move_mm=(0.0, 0.0, 1.0))
ROW = (0.0, 10.0, 46.0, 1.0, 0.0, 0.0, 0.0)
TIMED = Trajectory(times_s=(0.0, 1.0), poses=(ROW, ROW))


@pytest.mark.parametrize(
    ("part", "value", "says"),
    [
        ("membrane", Membrane(differences=("wall is 1 mm",)), "wall is 1 mm"),
        ("membrane", Membrane(differences=None, points_mm=DENSE_MM), "has 4 points, trained on 2"),
        ("material", Elastomer(poisson=0.49), "Poisson's ratio is 0.49, trained at 0.45"),
        ("material", Elastomer(friction=0.5), "friction is 0.5, trained at 0.3"),
        ("material", Elastomer(law=Law.LINEAR), "law is linear, trained with neo_hookean"),
        ("material", Elastomer(inclusions=(Inclusion(),)), "parts of another elastomer"),
        ("indenter", Indenter(kind=IndenterKind.TORUS), "training never showed: torus"),
        ("indenter", Indenter(size_mm=4.0), "the object is 4 mm wide, trained on 6 mm"),
        (
            "indenter",
            Indenter(kind=IndenterKind.CUBE, edge_radius_mm=0.1),
            "edges are rounded by 0.1 mm, trained on 0.45 mm",
        ),
        ("indenter", Indenter(soft=SoftBody()), "the object is soft"),
        ("indenter", Indenter(texture=Texture(pattern=Pattern.DOTS)), "has a texture"),
        ("press", Press(depth_mm=1.5), "the press is 1.5 mm deep, trained to 1 mm"),
        ("press", Press(strokes=(press_stroke(0.2),)), "the press is 1.2 mm deep"),
        ("press", Press(shear_mm=(0.0, -0.8)), "goes 0.8 mm aside, trained to 0.5 mm"),
        ("press", Press(strokes=(slide(0.4, 0), slide(0.4, 0))), "goes 0.8 mm aside"),
        ("press", Press(twist_deg=10.0), "strokes that training never showed: twist"),
        ("press", Press(strokes=(twist(5.0), release())), "never showed: release, twist"),
        ("press", Press(actuations=(DRIVEN,)), "regions of the membrane are driven"),
        ("press", Press(trajectory=TIMED), "a trajectory"),
        ("settings", ContactSettings(grid_mm=1.0), "grid is 1 mm, trained on 0.5 mm"),
        ("settings", ContactSettings(method=Method.PARTICLES), "method is particles"),
        ("largest_mm", 1.5, "the skin moves by 1.50 mm, in training by 1.20 mm at most"),
    ],
)
def test_each_thing_that_differs_is_one_sentence(part: str, value: Any, says: str) -> None:
    """It names what is there and what was trained, and nothing else is complained of."""
    found = judged(**{part: value})
    assert len(found.reasons) == 1 and says in found.reasons[0]
    assert found.factor == 1.0 and found.note == ""


def test_another_box_is_told_by_its_size() -> None:
    """20 x 20 x 40 mm in training; here a corner is 2 mm farther, whatever the design says."""
    for differences in (None, ()):
        found = judged(membrane=Membrane(differences=differences, points_mm=BOX_MM * [1.1, 1, 1]))
        assert found.reasons == (
            "the membrane is another: 22.0 x 20.0 x 40.0 mm, "
            "trained on one of 20.0 x 20.0 x 40.0 mm",
        )
        assert not judged(membrane=Membrane(differences=differences, points_mm=BOX_MM)).reasons
    # What the design says is plainer than the box.
    told = Membrane(differences=("wall is 1 mm",), points_mm=BOX_MM * 2.0)
    assert judged(membrane=told).reasons == ("wall is 1 mm",)


def test_one_of_several_sizes_is_known() -> None:
    """Data sets of 4 and of 6 mm: both are known, 5 mm is not."""
    card = {**CARD, "size_mm": [4.0, 6.0]}
    assert not judged(card=card, indenter=Indenter(size_mm=4.0)).reasons
    (reason,) = judged(card=card, indenter=Indenter(size_mm=5.0)).reasons
    assert reason == "the object is 5 mm wide, trained on 4, 6 mm"


def test_another_stiffness_scales_forces_and_is_no_reason_for_doubt() -> None:
    """Statics is linear in E: three times as stiff, three times the force, said in a note."""
    found = judged(material=Elastomer(young_MPa=0.435))
    assert found.reasons == ()
    assert found.factor == pytest.approx(3.0)
    assert "E is 0.435 MPa, trained at 0.145 MPa" in found.note and "scaled by 3" in found.note


def test_displacements_do_not_scale_with_stiffness() -> None:
    """The same displacements whatever E is: nothing to multiply, nothing to say; forces that enter
    are divided all the same."""
    stiff = Elastomer(young_MPa=0.435)
    found = judged(material=stiff, target=Target.DISPLACEMENT)
    assert (found.reasons, found.factor, found.note) == ((), 1.0, "")
    assert found.young_ratio == pytest.approx(3.0)


@pytest.mark.parametrize("target", [Target.FORCE, Target.DISPLACEMENT])
def test_gel_behind_the_skin_takes_the_exactness(target: Target) -> None:
    """Its modulus stays when E changes; with air behind the skin all is in proportion again."""
    membrane = Membrane(differences=(), gel=True)
    stiff = Elastomer(young_MPa=0.29)
    (reason,) = judged(material=stiff, membrane=membrane, target=target).reasons
    assert "the gel behind the skin does not change with it" in reason
    air = dataclasses.replace(stiff, backing_MPa=0.0)
    assert judged(material=air, membrane=membrane, target=target).reasons == ()


def test_a_card_that_says_nothing_is_told_of() -> None:
    """All that is missing is named; nothing is judged by it."""
    (reason,) = judged(card={}).reasons
    assert all(name in reason for name in NEEDED)
    (reason,) = judged(card={**CARD, "friction": None}).reasons
    assert reason == "the data card of the weights does not say: friction"
