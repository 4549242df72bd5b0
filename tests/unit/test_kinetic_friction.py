"""Kinetic friction where it is not solved: refused with a remedy, or told as unknown; as typed."""

from __future__ import annotations

import numpy as np
import pytest

from sim.forces.acquaintance import _of_material
from ui.panels.shape.material import _read, _write
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Elastomer


def test_networks_of_one_coefficient_do_not_know_two() -> None:
    """Trained at .3: .3 and .2 is another skin, .3 alone is not; trained with both, both are."""
    two = Elastomer(friction=0.3, kinetic_friction=0.2)
    assert list(_of_material({"friction": 0.3}, Elastomer())) == []
    assert list(_of_material({"friction": 0.3}, two)) == ["kinetic friction is 0.2, trained at 0.3"]
    assert list(_of_material({"friction": 0.3, "kinetic_friction": 0.2}, two)) == []


def test_the_field_of_the_page_takes_a_number_or_nothing() -> None:
    """Empty is the static coefficient; words are refused with what was typed."""
    assert _read(" ") is None
    assert _read("0.25") == pytest.approx(0.25)
    assert [_write(value) for value in (None, 0.25)] == ["", "0.25"]
    with pytest.raises(DesignError, match="'rough', which is not a number") as caught:
        _read("rough")
    assert caught.value.at == "material.kinetic_friction"


def test_the_method_of_particles_refuses_it() -> None:
    """It has no friction law at all, so a second coefficient would be a lie."""
    from sim.contact.particles.press import press_particles
    from sim.contact.studies.specimens import flat_block
    from workbench.core.press.press_case import PressCase

    mesh, points = flat_block(width_mm=4.0, height_mm=2.0, grid_mm=1.0, skin_mm=1.0)
    with pytest.raises(DesignError, match="cannot take kinetic friction"):
        press_particles(mesh, points, Elastomer(kinetic_friction=0.2), PressCase())


def test_a_deck_refuses_it() -> None:
    """Other programs take one coefficient."""
    from sim.fem.decks.mesh import Element
    from sim.fem.studies.blocks import flat_membrane
    from workbench.core.design.design import SensorDesign
    from workbench.core.press.press_case import PressCase
    from workbench.project.state import State
    from workbench.report.fem_case import make_deck_case

    material = Elastomer(kinetic_friction=0.2)
    state = State(design=SensorDesign(material=material), case=PressCase())
    with pytest.raises(DesignError, match=r"0\.2 below 0\.3"):
        make_deck_case(flat_membrane(), state, next(iter(Element)))


def test_samples_keep_the_share_that_slides() -> None:
    """To and from the parts of a file, and 0 of samples of before."""
    from workbench.learning.dataset.sample import Solved, _packed, _unpacked

    solved = Solved(
        displacement_mm=np.ones((2, 3), np.float32),
        contact_force_N=np.ones((2, 3), np.float32),
        sliding=np.array([True, False]),
        reaction_N=np.ones(3),
        tangential_N=1.0,
        residual=0.0,
        balance=0.0,
        converged=True,
        seconds=1.0,
        sliding_share=0.25,
    )
    head, arrays = _packed(solved)
    named = {f"mpm.{name}": values for name, values in arrays.items()}
    assert _unpacked(head, named, "mpm", 2).sliding_share == 0.25
    head.pop("sliding_share")
    assert _unpacked(head, named, "mpm", 2).sliding_share == 0.0


def test_drawn_friction_takes_the_kinetic_along() -> None:
    """.4 and .2 drawn at .3: .3 and .15, never a kinetic above the static."""
    from workbench.core.design.design import SensorDesign
    from workbench.learning.dataset.recipe import Recipe
    from workbench.learning.dataset.variation import Drawn

    material = Elastomer(friction=0.4, kinetic_friction=0.2)
    recipe = Recipe(design=SensorDesign(material=material))
    drawn = recipe.material(Drawn(friction=0.3))
    assert (drawn.friction, drawn.kinetic_friction) == (0.3, pytest.approx(0.15))
    assert recipe.material(Drawn()) == material
