"""Which cases a recipe holds: counts by closed form, order, splits and names."""

from __future__ import annotations

import dataclasses
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest

from workbench.core.base.errors import DesignError
from workbench.core.press.indenter import SEEN, UNSEEN, IndenterKind
from workbench.core.result.results import Skin
from workbench.learning.dataset.algorithms import finger_algorithm
from workbench.learning.dataset.cases import Split, cases_of, count_cases, positions_of
from workbench.learning.dataset.positions import Pattern, finger_positions, spread_positions
from workbench.learning.dataset.recipe import table_key
from workbench.learning.dataset.recipes import (
    RECIPES,
    load_recipe,
    recipe_from_toml,
    recipe_to_toml,
)
from workbench.project.named_designs import load_design


def flat_skin(half_mm: float, spacing_mm: float) -> Skin:
    """A square sheet of triangles at z = 0."""
    side = np.arange(-half_mm, half_mm + spacing_mm / 2, spacing_mm)
    n = len(side)
    x, y = np.meshgrid(side, side, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(n * n)])
    corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    lower = np.column_stack([corner, corner + n, corner + n + 1])
    upper = np.column_stack([corner, corner + n + 1, corner + 1])
    up = np.tile([0.0, 0.0, 1.0], (n * n, 1))
    faces = np.concatenate([lower, upper]).astype(np.int32)
    return Skin(points_mm=points, faces=faces, normals=up)


def test_the_finger_has_85_positions_with_the_surface_normals() -> None:
    """1 apex + 4 x 9 on the tip + 4 x 12 on the base = 85; |p - c| = 15 mm on the hemisphere."""
    places = positions_of(load_recipe("paper_finger"))
    assert len(places) == 1 + 4 * 9 + 4 * 12 == 85
    assert len({p.name for p in places}) == 85
    for place in places:
        x, y, z = place.target_mm
        polar = np.radians(place.labels["polar_deg"])
        height = place.labels["height_mm"]
        assert np.isclose(np.hypot(x, y), 15.0 * np.sin(polar), atol=1e-6)
        assert np.isclose(z, 27.0 + 15.0 * np.cos(polar) - height, atol=1e-6)


def test_a_blunt_tip_is_met_where_its_normal_has_the_angle() -> None:
    """On (x/R)^2 + (z/h)^2 = 1 the normal is along (x / R^2, z / h^2): its angle is the polar."""
    design = load_design("geltip").replace("shape.tip_ratio", 0.6)
    for place in finger_positions(design):
        x, y, z = place.target_mm
        if z > 27.0:
            across, along = np.hypot(x, y) / 15.0**2, (z - 27.0) / 9.0**2
            angle = np.degrees(np.arctan2(across, along))
            assert np.isclose(angle, place.labels["polar_deg"], atol=1e-6)


def test_the_whole_of_algorithm_1_has_the_papers_states() -> None:
    """85 x 14 x 10 = 11,900 pressed and 85 x 14 x 10 x 8 x 5 = 476,000 sheared states."""
    recipe = load_recipe("paper_finger")
    assert count_cases(recipe, 85) == 85 * 14 * 10 * 8
    pair_cases = 10 * 8
    one = dataclasses.replace(recipe, indenters=(IndenterKind.SPHERE,))
    cases = cases_of(one)
    assert len(cases) == 85 * pair_cases
    new_states = sum(case.frames - case.first_new for case in cases)
    assert new_states * 14 == 11_900 + 476_000


def test_cases_are_the_presses_of_algorithm_1() -> None:
    """The sheared presses of `algorithms`, each once for an object, in another order."""
    recipe = dataclasses.replace(load_recipe("paper_finger"), indenters=(IndenterKind.SPHERE,))
    mine = [dataclasses.astuple(case.press) for case in cases_of(recipe)]
    theirs = [dataclasses.astuple(v.press) for v in finger_algorithm() if v.direction is not None]
    assert len(mine) == len(theirs)
    assert set(map(repr, mine)) == set(map(repr, theirs))


def test_algorithm_2_has_4200_samples_of_350_cases() -> None:
    """25 places x 14 objects x 12 depths = 4,200, one press of 12 frames each."""
    cases = cases_of(load_recipe("paper_pad"))
    assert len(cases) == 25 * 14 == 350
    assert sum(case.frames for case in cases) == 4200
    assert all(case.first_new == 0 and not case.press.strokes for case in cases)


def test_ids_are_unique_and_stable() -> None:
    """Names of folders: changing them would orphan data sets, so some are written down here."""
    cases = cases_of(dataclasses.replace(load_recipe("paper_finger"), cases=2000))
    ids = [case.id for case in cases]
    assert len(set(ids)) == len(ids)
    assert all(set(name) <= set("abcdefghijklmnopqrstuvwxyz0123456789_.-") for name in ids)
    small = [case.id for case in cases_of(load_recipe("small"))]
    assert small == [case.id for case in cases_of(load_recipe("small"))]
    assert small[0].startswith("cross_") and small[0].endswith(tuple("01234567"))


def test_a_longer_list_begins_with_a_shorter_one() -> None:
    """Cases are dealt in one order: the first 30 of 84 are the 30 of a recipe of 30."""
    recipe = load_recipe("small")
    assert cases_of(dataclasses.replace(recipe, cases=30)) == cases_of(recipe)[:30]
    assert dataclasses.replace(recipe, cases=30).key == recipe.key


@pytest.mark.parametrize("kinds", [SEEN + UNSEEN, SEEN, SEEN[:3], SEEN[:1]])
def test_any_beginning_is_balanced(kinds: tuple[IndenterKind, ...]) -> None:
    """Objects and positions come equally often to within one, and pairs before repetitions."""
    recipe = dataclasses.replace(load_recipe("small"), indenters=kinds, cases=0)
    cases = cases_of(recipe)
    assert len(cases) == 85 * len(kinds) * 8 == len({case.id for case in cases})
    for count in (len(kinds) * 7, 200, 85 * len(kinds)):
        first = cases[:count]
        for of in ("indenter", "pair"):
            uses = Counter(getattr(case, of) for case in first)
            assert max(uses.values()) - min(uses.values()) <= 1
        places = Counter(case.position.name for case in first)
        least = min(places.values()) if len(places) == 85 else 0
        assert max(places.values()) - least <= 1
    assert len({case.pair for case in cases[: 85 * len(kinds)]}) == 85 * len(kinds)
    ways = Counter(case.shear for case in cases[:160])
    assert set(ways) == set(range(8))


def test_no_pair_of_position_and_object_is_in_two_splits() -> None:
    """All ways of pressing one place with one object are in one split, unseen objects apart."""
    cases = cases_of(dataclasses.replace(load_recipe("small"), cases=0))
    home: dict[str, Split] = {}
    for case in cases:
        assert home.setdefault(case.pair, case.split) is case.split
        assert (case.indenter in UNSEEN) == (case.split is Split.UNSEEN)
    pairs = Counter(home.values())
    # 850 seen pairs in whole blocks of five.
    assert pairs == {
        Split.TRAIN: 510,
        Split.VALIDATION: 170,
        Split.TEST: 170,
        Split.UNSEEN: 4 * 85,
    }


def test_a_recipe_says_which_share_is_for_training() -> None:
    """Eight, one and one of ten: of 850 seen pairs 680, 85 and 85, in any whole ten as well."""
    recipe = dataclasses.replace(load_recipe("small"), cases=850, indenters=SEEN, shares=(8, 1, 1))
    splits = [case.split for case in cases_of(recipe)]
    expected = {Split.TRAIN: 8, Split.VALIDATION: 1, Split.TEST: 1}
    assert Counter(splits[:10]) == expected
    assert Counter(splits) == {split: 85 * share for split, share in expected.items()}
    assert recipe.key != dataclasses.replace(recipe, shares=(3, 1, 1)).key


def test_repeated_approaches_are_known() -> None:
    """Of eight shears of one pair the first has all states new, the others the shear alone."""
    recipe = dataclasses.replace(load_recipe("small"), cases=0)
    cases = [case for case in cases_of(recipe) if case.pair == "sphere_tip40_az090"]
    assert [case.first_new for case in cases] == [0] + [10] * 7


def test_frames_go_down_and_then_aside_by_a_tenth_each() -> None:
    """Depth .1 to 1 mm, then shear .1 to .5 mm along U, V or both."""
    recipe = dataclasses.replace(load_recipe("small"), cases=0)
    by_way = {case.shear: case for case in cases_of(recipe)}
    ends = {way: case.shear_mm for way, case in by_way.items()}
    assert ends == {
        0: (0.5, 0.0),
        1: (0.5, 0.5),
        2: (0.0, 0.5),
        3: (-0.5, 0.5),
        4: (-0.5, 0.0),
        5: (-0.5, -0.5),
        6: (0.0, -0.5),
        7: (0.5, -0.5),
    }
    case = by_way[1]
    assert case.frames == case.press.frame_count == 15
    depths = [case.depth_at(frame) for frame in range(15)]
    assert np.allclose(depths, [*np.arange(1, 11) / 10, *[1.0] * 5])
    shears = [case.shear_at(frame)[1] for frame in range(15)]
    assert np.allclose(shears, [*[0.0] * 10, *np.arange(1, 6) / 10])


def test_spread_points_are_far_apart_and_off_the_rim() -> None:
    """On a 20 mm square with a 3 mm margin: 14 mm inside, 5 points are 4 corners and the middle."""
    places = spread_positions(flat_skin(10.0, 0.5), 60, seed=3, margin_mm=3.0)
    points = np.array([place.target_mm for place in places])
    assert np.abs(points).max() <= 7.0
    gaps = np.linalg.norm(points[:, None] - points, axis=2) + 99.0 * np.eye(60)
    # Each new point is as far from those before as from none later.
    least = [gaps[k, :k].min() for k in range(1, 60)]
    assert all(later <= before + 1e-9 for before, later in pairwise(least))
    # 60 discs of diameter d cover at most .91 of the area they can reach, (14 + d)^2.
    assert gaps.min() > 1.2
    longer = spread_positions(flat_skin(10.0, 0.5), 70, seed=3, margin_mm=3.0)
    assert [p.target_mm for p in longer[:60]] == [p.target_mm for p in places]
    with pytest.raises(DesignError, match="vertices of the skin lie 9 mm from its rim"):
        spread_positions(flat_skin(10.0, 0.5), 60, seed=3, margin_mm=9.0)


@pytest.mark.parametrize("name", RECIPES)
def test_recipes_come_back_from_toml(name: str) -> None:
    """The same recipe, and the same key from its plain table."""
    recipe = load_recipe(name)
    assert recipe_from_toml(recipe_to_toml(recipe)) == recipe
    assert recipe.key == table_key(recipe.table)


def test_the_key_follows_what_a_sample_depends_on() -> None:
    """Neither the name of the design nor the number of cases; the mesh and the wall do."""
    recipe = load_recipe("small")
    renamed = dataclasses.replace(recipe.design, name="other")
    assert dataclasses.replace(recipe, design=renamed).key == recipe.key
    assert dataclasses.replace(recipe, hex_mm=0.9).key != recipe.key
    thicker = recipe.design.replace("layers.elastomer_mm", 2.1)
    assert dataclasses.replace(recipe, design=thicker).key != recipe.key


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('design = "geltip"\ndepth_mm = 0.95\n', "9.5 steps of 0.1 mm"),
        ('design = "geltip"\nshear_directions = 5\n', "5 shear directions"),
        ('design = "geltip"\nindenters = ["ball"]\n', "ball"),
        ('design = "geltip"\nindenters = []\n', "none"),
        ('design = "geltip"\nshares = [0, 1, 1]\n', "for training"),
        ('design = "geltip"\ndeep_mm = 1.0\n', "deep_mm"),
        ("hex_mm = 0.9\n", "names no design"),
        ("design = \n", "not valid TOML"),
    ],
)
def test_bad_recipes_are_refused(text: str, words: str) -> None:
    """What is wrong is named, with its value."""
    with pytest.raises(DesignError) as caught:
        recipe_from_toml(text)
    assert words in caught.value.message
    assert caught.value.hint


def test_patterns_are_for_their_families() -> None:
    """The finger's paths do not exist on a pad, nor on a finger that is too short for them."""
    recipe = load_recipe("paper_pad")
    with pytest.raises(DesignError, match="this design is of the family 'pad'"):
        cases_of(dataclasses.replace(recipe, pattern=Pattern.FINGER))
    short = load_design("geltip").replace("shape.cylinder_mm", 11.0)
    with pytest.raises(DesignError, match="11 mm long"):
        finger_positions(short)
