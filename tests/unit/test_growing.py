"""Fast contact that finds its skin tile by tile, beside the same skin known as a whole."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sim.condensed.general_law import RECORD, general_law
from sim.condensed.lessons import collider_of
from sim.condensed.placing import part_near, placed_near
from sim.condensed.tiles import tiles
from tests.synthetic_skin import REACH_MM, WALL_MM, flat_skin
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.core.result.condensed import CondensedSkin, Hardening, SkinColumns
from workbench.core.result.results import Skin

EDGE, SPACING_MM = 25, 0.6
LAW = Hardening(normal=(0.3, 1.0, 0.0))


@pytest.fixture
def skin(taichi_device: str) -> CondensedSkin:
    return flat_skin(EDGE, SPACING_MM)


class Known:
    """Finds tiles in a skin that is known, and notes which."""

    def __init__(self, skin: CondensedSkin) -> None:
        self.skin = skin
        self.tiles = tiles(skin.points_mm)
        self.asked: list[int] = []

    def columns(self, tile: int) -> SkinColumns:
        self.asked.append(tile)
        rows = self.skin.compliance
        nodes = self.tiles[tile]
        parts = [slice(rows.starts[node], rows.starts[node + 1]) for node in nodes]
        blocks = np.concatenate([rows.blocks_mm_N[part] for part in parts])
        return SkinColumns(
            nodes=nodes.astype(np.int32),
            starts=np.append(0, np.cumsum([part.stop - part.start for part in parts])),
            neighbours=np.concatenate([rows.neighbours[part] for part in parts]),
            # A row says how its node moves, a column how the others do.
            blocks_mm_N=np.swapaxes(blocks, 1, 2),
        )


def growing(known: Known) -> Any:
    from sim.condensed.growing import GrowingContact

    points, faces = known.skin.points_mm, known.skin.faces
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    outer = Skin(points_mm=points, faces=faces, normals=up)
    inner = Skin(points_mm=points - [0.0, 0.0, WALL_MM], faces=faces, normals=up)
    mesh: Any = SimpleNamespace(outer=outer, inner=inner)
    return GrowingContact(mesh, REACH_MM / 2.5, LAW, Elastomer(friction=0.3), known.columns)


def way(x_mm: float) -> np.ndarray:
    """A ball of 6 mm that comes down at x and is dragged 2 mm along it."""
    down = [[x_mm, 0.1, 3.05 - depth] for depth in (0.0, 0.3, 0.6)]
    aside = [[x_mm + shift, 0.1, 2.45] for shift in (0.5, 1.0, 1.5, 2.0)]
    return np.array([[*place, 1.0, 0.0, 0.0, 0.0] for place in (*down, *aside)])


def test_forces_are_those_of_the_whole_skin_and_only_touched_tiles_are_asked_for(
    skin: CondensedSkin,
) -> None:
    """Over a border between tiles, with friction: what stuck goes on sticking as the skin grows."""
    from sim.condensed.fast_contact import FastContact

    known = Known(skin)
    part, whole = growing(known), FastContact(skin, LAW, Elastomer(friction=0.3))
    thing = collider_of(Indenter(size_mm=6.0))
    asked = []
    for pose in way(0.0):
        some, all_of_it = part.step(thing, pose[None]), whole.step(thing, pose[None])
        asked.append(len(known.asked))
        scale = max(np.abs(all_of_it.force_N).max(), 0.1)
        assert np.abs(some.force_N - all_of_it.force_N).max() < 1e-4 * scale
        assert np.abs(some.displacement_mm - all_of_it.displacement_mm).max() < 1e-3
    assert 0 < asked[0] < asked[-1] < part.tiles == len(known.tiles)
    assert len(set(known.asked)) == len(known.asked) == part.known, "none is found twice"
    for tile in known.asked:
        near = np.abs(skin.points_mm[known.tiles[tile], :2] - [1.0, 0.1]).min(axis=0)
        assert near[0] < 4.0 and near[1] < 3.0, "no tile far from the way"


def test_a_ball_in_the_air_feels_nothing_and_a_state_outlives_the_tiles(
    skin: CondensedSkin,
) -> None:
    """One tile is enough for air; a state of an untouched skin is that of one at rest."""
    known = Known(skin)
    part = growing(known)
    thing = collider_of(Indenter(size_mm=6.0))
    fresh = part.state()
    part.reset(2)
    above = np.tile(way(0.0)[0], (2, 1))
    above[:, 2] += 5.0
    assert not part.step(thing, above).force_N.any()
    assert len(known.asked) == 1
    for pose in way(-3.0)[:3]:
        pressed = part.step(thing, np.stack([pose, above[0]]))
    assert pressed.force_N[0, 2] > 0.1 and not pressed.force_N[1].any()
    kept = part.state()
    part.reset(2)
    part.restore(kept)
    again = part.step(thing, np.stack([way(-3.0)[2], above[0]]))
    assert np.allclose(again.force_N, pressed.force_N, atol=2e-3 * pressed.force_N[0, 2])
    part.restore(fresh)
    assert part.presses == 2


def test_an_object_is_placed_as_on_the_whole_skin(skin: CondensedSkin) -> None:
    """On a plane a ball touches its radius above the target; what is far away is left out."""
    up = np.tile([0.0, 0.0, 1.0], (len(skin.points_mm), 1))
    plane = Skin(points_mm=skin.points_mm, faces=skin.faces, normals=up)
    thing = collider_of(Indenter(size_mm=2.0))
    approach = placed_near(plane, thing, Press(target_mm=(1.0, -2.0, 0.0), depth_mm=0.5, frames=1))
    assert approach.touch_mm == pytest.approx(1.0, abs=1e-3)
    assert np.allclose(approach.target_mm, [1.0, -2.0, 0.0])
    near = part_near(plane, np.zeros(3), 2.0)
    assert np.linalg.norm(near.points_mm[near.faces], axis=2).min(axis=1).max() < 2.0
    assert len(near.faces) < len(plane.faces)
    assert part_near(plane, np.array([0.0, 0.0, 99.0]), 2.0) is plane


def test_the_general_law_hardens_and_says_what_it_was_off_by() -> None:
    """Stiffer the deeper it is pressed, and an error for each kind of press."""
    law = general_law()
    s = np.linspace(0.0, law.deepest, 9)
    factor = 1.0 + law.normal[0] * s + law.normal[1] * s * s
    assert (np.diff(factor) > 0.0).all() and factor[-1] > 1.3
    assert law.errors is not None and 0.0 < max(law.errors.values()) < 0.25
    assert set(RECORD.figures()["left_out"]) == {"geltip", "pad", "trunk", "paw"}
