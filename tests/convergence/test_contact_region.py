"""The region that takes part: large enough for the force, and it follows the patch."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.contact.motion.approach import plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.press import press_membrane
from sim.contact.region.radius import MARGIN_WALLS, region_radius_mm
from sim.contact.studies import specimens
from sim.contact.studies.finger import at_45_degrees
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import Label


@pytest.mark.slow
@pytest.mark.usefixtures("taichi_device")
@pytest.mark.parametrize(
    ("kind", "grid_mm"), [(IndenterKind.SPHERE, 0.7), (IndenterKind.CUBE, 0.5)]
)
def test_chosen_region_gives_the_force_of_a_large_one(kind: IndenterKind, grid_mm: float) -> None:
    """Force within 0.5 % and displacement within 3 % of the depth of a 16 mm region."""
    mesh, points = specimens.finger(grid_mm=grid_mm)
    indenter = Indenter(kind=kind, size_mm=6.0)
    chosen, large = (
        press_membrane(
            mesh,
            points,
            Elastomer(),
            PressCase(
                indenter=indenter,
                press=at_45_degrees(),
                settings=ContactSettings(grid_mm=grid_mm, active_radius_mm=radius_mm),
            ),
        )
        for radius_mm in (0.0, 16.0)
    )
    assert chosen.active_radius_mm < 12.0
    # Measured of the ball 0.3 % and 17 um, with half of the margin 2.2 % and 44 um; two settled
    # frames differ by a few residuals of 1e-3.
    assert chosen.normal_N[-1] == pytest.approx(large.normal_N[-1], rel=5e-3)
    apart_mm = np.abs(chosen.displacement_mm - large.displacement_mm).max()
    assert apart_mm < 0.03


def radius_mm(indenter: Indenter, press: Press, *, fixed_mm: float = 0.0) -> float:
    mesh, _ = specimens.finger(grid_mm=1.0)
    collider = make_collider(indenter, grid_mm=1.0)
    settings = ContactSettings(active_radius_mm=fixed_mm)
    approach = plan_approach(mesh.outer, collider, press)
    return region_radius_mm(mesh, Elastomer(), approach, settings)


def test_region_follows_size_and_shear() -> None:
    """A larger object, and shear, widen the region; a fixed radius is kept."""
    press = at_45_degrees()
    small = radius_mm(Indenter(size_mm=4.0), press)
    assert radius_mm(Indenter(size_mm=20.0), press) > small + 1.0
    sheared = at_45_degrees(shear_mm=(0.0, 3.0))
    assert radius_mm(Indenter(size_mm=4.0), sheared) > small + 2.0
    assert radius_mm(Indenter(), press, fixed_mm=6.0) == 6.0


def test_region_without_touch_is_the_margin() -> None:
    """At depth 0 the patch is empty: 3.1 walls of 2 mm remain."""
    press = at_45_degrees(depth_mm=0.0)
    # The nearest skin vertices lie up to half a millimetre beside the target.
    assert radius_mm(Indenter(), press) == pytest.approx(MARGIN_WALLS * 2.0, abs=0.5)


def test_region_smaller_than_the_contact_is_refused() -> None:
    """A flat end 20 mm wide cannot be solved within 6 mm; value, limit and remedy are told."""
    end = Indenter(kind=IndenterKind.CYLINDER_END, size_mm=20.0)
    with pytest.raises(DesignError, match=r"active radius 6 mm .* need \d+\.\d mm") as raised:
        radius_mm(end, at_45_degrees(), fixed_mm=6.0)
    assert raised.value.at == "contact.active_radius_mm"
    assert "or 0" in raised.value.hint


def backed_radius_mm(backing_MPa: float, fixed_mm: float) -> float:
    """The same finger on 1.5 mm of gel, or of air."""
    mesh, _ = specimens.finger(grid_mm=1.0)
    labels = np.full(len(mesh.inner.faces), Label.INNER | Label.BACKED, dtype=np.uint8)
    inner = dataclasses.replace(mesh.inner, labels=labels)
    mesh = dataclasses.replace(mesh, inner=inner, backing_mm=1.5)
    collider = make_collider(Indenter(size_mm=4.0), grid_mm=1.0)
    settings = ContactSettings(active_radius_mm=fixed_mm)
    approach = plan_approach(mesh.outer, collider, at_45_degrees())
    return region_radius_mm(mesh, Elastomer(backing_MPa=backing_MPa), approach, settings)


def test_a_chosen_radius_must_hold_the_bending_over_gel() -> None:
    """3/4 of the decay of 4 (D / k)^(1/4) = 6.6 mm, beyond the patch: 6 mm is too little."""
    free_mm = backed_radius_mm(0.02, 0.0)
    skin = Elastomer(backing_MPa=0.02)
    decay_mm = 4.0 * (skin.young_MPa * 8.0 / 12.0 / (1.0 - skin.poisson**2) * 75.0) ** 0.25
    least_mm = free_mm - 0.25 * decay_mm
    with pytest.raises(DesignError, match=r"6 mm .* on its gel need \d+\.\d mm") as raised:
        backed_radius_mm(0.02, 6.0)
    assert raised.value.at == "contact.active_radius_mm"
    # The wall is measured to the nearest vertex of a skin with edges of 0.4 mm.
    assert backed_radius_mm(0.02, least_mm + 0.1) == least_mm + 0.1
    with pytest.raises(DesignError, match="gel"):
        backed_radius_mm(0.02, least_mm - 0.1)


def test_a_chosen_radius_over_air_must_hold_the_whole_skin() -> None:
    """Nothing but the rim holds it: 20 mm of a finger 42 mm long are refused, all of it is not."""
    whole_mm = backed_radius_mm(0.0, 0.0)
    assert whole_mm > 40.0
    with pytest.raises(DesignError, match="moves as a whole and needs"):
        backed_radius_mm(0.0, 20.0)
    assert backed_radius_mm(0.0, whole_mm + 0.1) == whole_mm + 0.1
