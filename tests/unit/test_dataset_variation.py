"""What a recipe draws for each case: ranges, built sensors, and the paper's task sets."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

import numpy as np
import pytest

from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.optics import Optics
from workbench.learning.dataset.cases import Split, case_of_row, case_row, cases_of
from workbench.learning.dataset.looks import built
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.recipes import load_recipe, recipe_from_toml, recipe_to_toml
from workbench.learning.dataset.sights import sights_of
from workbench.learning.dataset.variation import Drawn, Looks, Vary, draw

ALL = Vary(
    size_mm=(3.0, 12.0),
    spin_deg=(-180.0, 180.0),
    twist_deg=(-10.0, 10.0),
    friction=(0.2, 0.6),
    young_MPa=(0.1, 0.2),
    looks=Looks(count=8),
)


def test_draws_fill_their_ranges_evenly() -> None:
    """Of 2,000 draws each tenth of a range holds 200 +- 5 standard deviations (67)."""
    found = [draw(ALL, seed=3, number=k) for k in range(2000)]
    for name in ("size_mm", "spin_deg", "twist_deg", "friction", "young_MPa"):
        low, high = getattr(ALL, name)
        shares = (np.array([getattr(one, name) for one in found]) - low) / (high - low)
        assert shares.min() >= 0.0 and shares.max() <= 1.0
        assert np.abs(np.histogram(shares, 10, (0.0, 1.0))[0] - 200).max() < 67
    assert {one.look for one in found} == set(range(8))


def test_a_range_more_changes_no_other_draw() -> None:
    """A recipe without twist draws the sizes that it draws with it."""
    fewer = dataclasses.replace(ALL, twist_deg=None, young_MPa=None)
    both = [(draw(ALL, seed=1, number=k), draw(fewer, seed=1, number=k)) for k in range(50)]
    assert all((a.size_mm, a.friction, a.look) == (b.size_mm, b.friction, b.look) for a, b in both)
    assert all(b.twist_deg is None for _, b in both)


def test_a_larger_set_begins_with_the_smaller_one() -> None:
    """The first 100 of 1,002 cases are the 100 cases."""
    whole = load_recipe("objects")
    first = cases_of(dataclasses.replace(whole, cases=100))
    assert cases_of(whole)[:100] == first
    assert len({case.id for case in cases_of(whole)}) == 1002


@pytest.mark.parametrize(("name", "samples"), [("objects", 8016), ("safety", 2548)])
def test_task_sets_have_the_papers_sizes(name: str, samples: int) -> None:
    """8,016 images of 12 objects and 2,548 on the pad; split 3:1:1, each object in each."""
    cases = cases_of(load_recipe(name))
    assert sum(case.frames for case in cases) == samples
    share = {split: sum(case.split is split for case in cases) / len(cases) for split in Split}
    assert share[Split.UNSEEN] == 0.0
    assert abs(share[Split.TRAIN] - 0.6) < 0.03 and abs(share[Split.TEST] - 0.2) < 0.03
    for split in (Split.TRAIN, Split.VALIDATION, Split.TEST):
        kinds = {case.indenter for case in cases if case.split is split}
        assert kinds == set(load_recipe(name).indenters)


def test_a_case_reads_back_from_its_file() -> None:
    """JSON keeps all that was drawn; cases of before drew nothing."""
    case = cases_of(load_recipe("varied"))[7]
    row = json.loads(json.dumps(case_row(case)))
    assert case_of_row(row) == case and case.drawn.size_mm is not None
    assert case.frames == case.press_frames + case.shear_frames + 5
    plain = json.loads(json.dumps(case_row(cases_of(load_recipe("small"))[0])))
    del plain["drawn"], plain["twist_frames"]
    assert case_of_row(plain).drawn == Drawn()


def test_what_was_drawn_reaches_object_and_elastomer() -> None:
    """Size, turn about the way of the press, friction and stiffness; edges as round as can be."""
    recipe = Recipe(vary=ALL, turn_deg=(10.0, 0.0, 170.0))
    drawn = Drawn(size_mm=3.0, spin_deg=20.0, friction=0.5, young_MPa=0.2)
    thing = recipe.indenter(recipe.indenters[0], drawn)
    assert thing.size_mm == 3.0 and thing.turn_deg == (10.0, 0.0, -170.0)
    assert thing.edge_radius_mm == pytest.approx(0.42)
    material = recipe.material(drawn)
    assert (material.friction, material.young_MPa) == (0.5, 0.2)
    assert recipe.material(Drawn()) == recipe.design.material


def test_recipes_with_ranges_read_back_from_their_file() -> None:
    """Text and back; equal keys."""
    recipe = load_recipe("varied")
    again = recipe_from_toml(recipe_to_toml(recipe))
    assert again.key == recipe.key and again.vary == recipe.vary


@pytest.mark.parametrize(
    ("vary", "at"),
    [
        ({"size_mm": (12.0, 3.0)}, "recipe.vary.size_mm"),
        ({"friction": (0.2, 9.0)}, "recipe.vary.friction"),
        ({"young_MPa": (0.0, 0.1)}, "recipe.vary.young_MPa"),
    ],
)
def test_a_wrong_range_is_refused(vary: dict[str, Any], at: str) -> None:
    """With the field, its value, its limits."""
    with pytest.raises(DesignError) as refused:
        Vary(**vary)
    assert refused.value.at == at


def test_a_size_that_an_object_cannot_have_is_refused() -> None:
    """An object of 150 mm, before anything is built."""
    with pytest.raises(DesignError):
        recipe_from_toml('design = "geltip"\n[vary]\nsize_mm = [3.0, 150.0]\n')


def test_built_sensors_are_off_by_no_more_than_allowed() -> None:
    """Powers within 15 %, places within .3 and .5 mm, and no two alike."""
    looks, own = Looks(count=50), Optics()
    found = [built(own, looks, seed=0, number=k) for k in range(50)]
    assert len({one.camera for one in found}) == 50
    for one in found:
        assert len(one.ring.powers) == own.ring.count
        assert all(0.85 <= power <= 1.15 for power in one.ring.powers)
        assert abs(one.ring.radius_mm - own.ring.radius_mm) <= 0.3
        moved = np.subtract(one.camera.position_mm, own.camera.position_mm)
        assert np.abs(moved).max() <= 0.5 and one.camera.position_mm[2] >= 0.0
        # Three turns of at most a degree each.
        assert abs(one.camera.wxyz[0]) >= math.cos(math.radians(3.0**0.5) / 2.0)
    assert built(own, looks, seed=0, number=3) == found[3]


@pytest.mark.parametrize("lens", [LensModel.PINHOLE, LensModel.EQUIDISTANT])
def test_a_longer_focal_length_sees_less(lens: LensModel) -> None:
    """Half the width over f is tan(w / 2) of a pinhole and w / 2 of a fisheye."""
    own = Optics(camera=Camera(lens=lens, fov_x_deg=100.0))
    looks = Looks(count=1, focal_share=0.03)
    for number in range(20):
        wide = built(own, looks, seed=0, number=number).camera.fov_x_deg
        half = math.radians(wide) / 2.0
        of = math.radians(50.0)
        ratio = math.tan(of) / math.tan(half) if lens is LensModel.PINHOLE else of / half
        assert 0.97 - 1e-6 <= ratio <= 1.03 + 1e-6


def test_images_keep_the_cameras_proportion() -> None:
    """320 of 640 x 480 pixels are 320 x 240; one sight for each built sensor."""
    sights = sights_of(load_recipe("objects"))
    assert len(sights) == 8
    camera = sights[0].optics.camera
    own = load_recipe("objects").design.optics.camera
    assert (camera.width_px, camera.height_px) == (320, round(320 * own.height_px / own.width_px))
    assert len({sight.calls["bake"].key for sight in sights}) == 8
    assert len({sight.calls["mesh"].key for sight in sights}) == 1
