"""The stage `recipe`: what to weigh, pour, coat, solder and print."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.digest import at_defaults
from workbench.core.base.monitor import Monitor
from workbench.core.design.lighting import LedRing
from workbench.core.design.making import Casting
from workbench.core.result.fabrication import HousingSet, MouldSet, Recipe
from workbench.core.result.results import Solid
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class RecipeInputs:
    """What building a sensor depends on."""

    solid: Solid
    moulds: MouldSet
    housing: HousingSet
    ring: LedRing
    casting: Casting
    young_MPa: float
    density_g_cm3: float
    backing_MPa: float


def inputs(chain: Chain) -> RecipeInputs:
    """The parts, and what is bought for them."""
    design = chain.design
    return RecipeInputs(
        solid=chain.result("build"),
        moulds=chain.result("mould"),
        housing=chain.result("housing"),
        ring=bought(design.optics.ring),
        casting=design.casting,
        young_MPa=design.material.young_MPa,
        density_g_cm3=design.material.density_g_cm3,
        backing_MPa=design.material.backing_MPa,
    )


def bought(ring: LedRing) -> LedRing:
    """A ring as it is bought and soldered: without how bright and how wide it shines."""
    return at_defaults(ring, "power", "powers", "emission_exponent", "cone_deg", "size_mm")


def recipe(given: RecipeInputs, *, monitor: Monitor) -> Recipe:
    """Amounts, steps and the list of parts."""
    from geometry.workshop.recipe import WantedMaterial, make_recipe

    return make_recipe(
        given.solid,
        given.moulds,
        given.housing,
        ring=given.ring,
        casting=given.casting,
        wanted=WantedMaterial(
            young_MPa=given.young_MPa,
            density_g_cm3=given.density_g_cm3,
            backing_MPa=given.backing_MPa,
        ),
    )


STAGE = Stage(
    name="recipe",
    label="Recipe",
    version=3,
    place=16,
    lane="cad",
    run=recipe,
    inputs=inputs,
    in_run=True,
)
