"""The gel behind a skin that stands off from its window."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import pytest

from designs.digitac import DigitacShape
from geometry.body.solid import part_from_brep
from geometry.mould.gel import gap_ml, gel_step
from geometry.mould.moulds import make_mould
from geometry.workshop.recipe import WantedMaterial, make_recipe
from workbench.core.design.design import Layers, MouldOptions
from workbench.core.design.lighting import LedRing
from workbench.core.design.making import Casting
from workbench.core.result.fabrication import HousingSet, MouldSet
from workbench.core.result.results import Solid


@pytest.fixture(scope="module")
def digitac(default_solid: Callable[[str], Solid]) -> Solid:
    """The default pad with pins."""
    return default_solid("digitac")


@pytest.fixture(scope="module")
def moulds(digitac: Solid) -> MouldSet:
    """Its mould."""
    return make_mould(digitac, MouldOptions())


def steps(solid: Solid, moulds: MouldSet, backing_MPa: float) -> tuple[str, ...]:
    """The recipe's steps for a gel, or air, behind the skin."""
    return make_recipe(
        solid,
        moulds,
        HousingSet(parts=()),
        ring=LedRing(),
        casting=Casting(),
        wanted=WantedMaterial(young_MPa=0.145, density_g_cm3=1.0, backing_MPa=backing_MPa),
    ).steps


def test_gap_is_what_skin_window_and_cavity_leave(digitac: Solid) -> None:
    """V(inside) - V(window) - V(cavity) by the CAD kernel and the loaf's closed form."""
    layers, shape = Layers(), DigitacShape()
    cavity = shape.loaf(layers.elastomer_mm + shape.gap_mm + layers.support_mm).volume_mm3
    inside, window = (part_from_brep(b).volume for b in (digitac.core_brep, digitac.support_brep))
    # Chords of the window lie up to 0.05 mm off its arcs, 3 % of the gap of 1.7 mm at worst.
    assert 1000.0 * gap_ml(digitac) == pytest.approx(inside - window - cavity, rel=0.01)


def test_gel_of_the_table_is_named(digitac: Solid) -> None:
    """Ecoflex 00-10 has 0.0945 MPa; nothing of the table is as soft as 0.02 MPa."""
    assert "of Ecoflex 00-10:" in gel_step(digitac, 0.1)
    assert "of soft silicone gel of E 0.02 MPa:" in gel_step(digitac, 0.02)


def test_gel_is_filled_in_after_bonding(digitac: Solid, moulds: MouldSet) -> None:
    """With its volume; air needs no step, nor a skin that lies on its window."""
    words = steps(digitac, moulds, 0.02)
    (filled,) = [k for k, step in enumerate(words) if "Fill the gap" in step]
    (bonded,) = [k for k, step in enumerate(words) if "bond the skin" in step]
    assert filled == bonded + 1
    assert f"{gap_ml(digitac):.2f} ml" in words[filled]
    bare = dataclasses.replace(digitac, backing_mm=0.0)
    for none in (steps(digitac, moulds, 0.0), steps(bare, moulds, 0.02)):
        assert not any("gap" in step for step in none)
