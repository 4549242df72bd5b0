"""Where gate, vents and holes for trapped air go, on shapes whose answer is known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from geometry.body import csg
from geometry.body.csg_mesh import arrays, evaluate
from geometry.mould.cast import Cast, make_cast
from geometry.mould.channels import make_channels
from geometry.mould.trapped import pockets
from workbench.core.design.design import MouldOptions
from workbench.core.result.results import Solid

TURN = np.radians(10.0)
LEANING = np.array(
    [[1.0, 0.0, np.tan(TURN), 6.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]], dtype=float
)
"""A shear along X, shape (3, 4): level faces stay level, walls overhang."""


@pytest.fixture(scope="module")
def pad(default_solid: Callable[[str], Solid]) -> Solid:
    """The default pad: its flat inner face is bonded to the window."""
    return default_solid("pad")


@pytest.fixture(scope="module")
def digitac(default_solid: Callable[[str], Solid]) -> Solid:
    """The default pad with 31 pins."""
    return default_solid("digitac")


def as_core(node: csg.Node) -> Cast:
    """A cast whose core this is, in a block of 40 x 40 x 30 mm."""
    points, faces = arrays(evaluate(node))
    block, sides = arrays(evaluate(csg.Box(low_mm=(-20, -20, 0), high_mm=(20, 20, 30))))
    outer = csg.Body(points_mm=block, faces=sides)
    core = csg.Body(points_mm=points, faces=faces)
    return Cast(outer=outer, core=core, base_mm=0.0, sensing=outer, loops_mm=())


@pytest.mark.parametrize("narrowing", [-0.3, 0.0, 0.3])
def test_air_in_a_leaning_hole_is_let_out_in_the_middle_of_its_floor(narrowing: float) -> None:
    """The floor at height 12, whose middle is at (6 + 12 tan 10, 0); whether walls overhang or not.

    The hole is as deep as the core is high above its floor: 8 mm.
    """
    hole = csg.Cone(low_radius_mm=1.0, high_radius_mm=1.0 - narrowing, low_mm=12.0, high_mm=21.0)
    leaning = csg.Placed(body=hole, matrix=LEANING)
    found = pockets(as_core(csg.without(csg.cylinder(15.0, 0.0, 20.0), [leaning])))
    middle = [6.0 + 12.0 * np.tan(TURN), 0.0, 12.0]
    assert found.places_mm == pytest.approx(np.array([middle]), abs=1e-6)
    assert found.height_mm.tolist() == pytest.approx([8.0])


def test_air_in_a_groove_is_let_out_on_its_floor() -> None:
    """A ring's middle is on the post inside it: the hole goes 4 to 6 mm from it instead."""
    groove = csg.without(csg.cylinder(6.0, 12.0, 21.0), [csg.cylinder(4.0, 11.0, 22.0)])
    found = pockets(as_core(csg.without(csg.cylinder(15.0, 0.0, 20.0), [groove])))
    assert found.height_mm.tolist() == pytest.approx([8.0])
    assert 4.0 < np.hypot(*found.places_mm[0, :2]) < 6.0


@pytest.mark.parametrize("draft_deg", [0.0, 0.5, 3.0])
def test_every_pin_is_vented_in_the_middle_of_its_tip(digitac: Solid, draft_deg: float) -> None:
    """28 holes on the axes of 28 pins, which the draft moves toward the middle by tan(draft) h."""
    options = MouldOptions(shrink_percent=0.0, draft_deg=draft_deg)
    channels = make_channels(make_cast(digitac, options), 3)
    assert len(digitac.tips_mm) == len(channels.pockets_mm) == 28
    assert len(channels.trapped_mm) == 0
    apart = channels.pockets_mm[:, None, :2] - digitac.tips_mm[None, :, :2]
    off_mm = np.linalg.norm(apart, axis=2).min(axis=1)
    height_mm = channels.pockets_mm[:, 2].max()
    # The middle of a tip of 31 facets is on its axis to rounding; a drafted core's axis is found
    # to a micrometre.
    assert off_mm.max() <= np.tan(np.radians(draft_deg)) * height_mm + 1e-3


def test_gate_and_vents_of_a_pad_stand_2_mm_inside_its_edge(pad: Solid) -> None:
    """At (0, 10 - 2), (-10 + 2, 0), (0, -10 + 2) and (10 - 2, 0) of 20 x 20 mm."""
    channels = make_channels(make_cast(pad, MouldOptions(shrink_percent=0.0)), 3)
    assert channels.gate_mm == pytest.approx([0.0, 8.0], abs=1e-6)
    assert channels.throat_mm == pytest.approx(0.9 * 2.0)
    wanted = np.array([[-8.0, 0.0], [0.0, -8.0], [8.0, 0.0]])
    assert channels.vents_mm == pytest.approx(wanted, abs=1e-6)


def test_gate_and_vents_of_a_pad_move_as_little_as_its_outline(pad: Solid) -> None:
    """1 % of shrinkage moves an outline of 10 x 10 mm by at most 0.16 mm, and them no more."""
    one, other = (
        make_channels(make_cast(pad, MouldOptions(shrink_percent=percent)), 4)
        for percent in (0.0, 1.0)
    )
    assert np.abs(other.gate_mm - one.gate_mm).max() < 0.16
    assert np.abs(other.vents_mm - one.vents_mm).max() < 0.16


@pytest.mark.parametrize(
    ("wall_mm", "throat_mm", "vent_mm"), [(1.0, 0.45, 0.4), (4.0, 1.8, 0.8), (6.0, 2.0, 0.8)]
)
def test_gate_and_vents_are_as_wide_as_the_wall_that_they_end_in_allows(
    wall_mm: float, throat_mm: float, vent_mm: float
) -> None:
    """In a tube midway is half a wall of room: radii 0.9 and 0.8 of it, up to 2 and 0.8 mm."""
    solids = [csg.cylinder(10.0 + wall_mm, 0.0, 25.0), csg.cylinder(10.0, 0.0, 20.0)]
    outer, core = (
        csg.Body(points_mm=points, faces=faces)
        for points, faces in (arrays(evaluate(solid)) for solid in solids)
    )
    turn = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    cast = Cast(
        outer=outer,
        core=core,
        base_mm=0.0,
        sensing=outer,
        loops_mm=((10.0 + wall_mm) * circle, 10.0 * circle),
    )
    channels = make_channels(cast, 3)
    # Of points 0.4 mm apart along both outlines the middle is known to a hundredth of the room.
    assert channels.throat_mm == pytest.approx(throat_mm, rel=0.01)
    assert channels.vent_mm == pytest.approx(vent_mm, rel=0.01)
    middle_mm = 10.0 + wall_mm / 2.0
    places_mm = np.vstack([channels.gate_mm, channels.vents_mm])
    assert np.linalg.norm(places_mm, axis=1) == pytest.approx(np.full(4, middle_mm), abs=0.05)
