"""How a mould is opened: what is in the way of rigid parts, and what the skin must stretch."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import numpy as np
import pytest

from geometry.body import csg
from geometry.body.csg_mesh import arrays, evaluate
from geometry.mould.cast import Cast
from geometry.mould.core_release import bend_strain
from geometry.mould.demoulding import core_way, hardship
from geometry.mould.mould_checks import motion_checks, part_removal
from geometry.mould.parting import Parting
from geometry.mould.squeezing import confined_strain, outer_strain
from geometry.mould.sweeping import swept, tolerance_mm3, touching_mm2, way_mm
from geometry.surface.rays import RayCaster
from geometry.workshop.opening_words import (
    closing_steps,
    direction_words,
    opening_steps,
    recipe_json,
)
from ui.scene.parts import PartsView
from workbench.core.result.fabrication import FabricationPart, PartGroup, PartMotion, Severity
from workbench.core.result.results import LabelledSurface

X = np.array([1.0, 0.0, 0.0])
DOWN = np.array([0.0, 0.0, -1.0])


def box(*low_and_high: float) -> csg.Box:
    """A box by its lower and upper corner."""
    x0, y0, z0, x1, y1, z1 = low_and_high
    return csg.Box(low_mm=(x0, y0, z0), high_mm=(x1, y1, z1))


def body(node: csg.Node) -> csg.Body:
    """A description as a cast body."""
    points, faces = arrays(evaluate(node))
    return csg.Body(points_mm=points, faces=faces)


def cast(outer: csg.Body, core: csg.Body) -> Cast:
    """A skin between two bodies on z = 0; its sensing surface is all but the base."""
    sides = outer.points_mm[outer.faces][:, :, 2].max(axis=1) > 1e-6
    sensing = csg.Body(points_mm=outer.points_mm, faces=outer.faces[sides])
    return Cast(outer=outer, core=core, base_mm=0.0, sensing=sensing, loops_mm=())


HALVES = Parting(
    count=2,
    azimuth_deg=0.0,
    middle_mm=np.zeros(2),
    curve_mm=np.array([[0.0, 0.0], [0.0, 20.0]]),
    undercut=0.0,
)


HOOKED = csg.Union(
    parts=(box(-10, -10, 0, 10, 10, 20), box(9, -10, 0, 13, 10, 2), box(12, -10, 0, 13, 10, 10))
)
"""A block with a fin that stands up beside it."""


def motion(step: int, part: str, direction: tuple[float, float, float], mm: float) -> PartMotion:
    """A motion with nothing in its way."""
    return PartMotion(step=step, part=part, direction=direction, distance_mm=mm)


OUTER_FIRST = (
    motion(1, "half_a", (1.0, 0.0, 0.0), 42.0),
    motion(2, "half_b", (-1.0, 0.0, 0.0), 39.0),
    motion(3, "core", (0.0, -0.2588, -0.9659), 60.0),
)
CORE_FIRST = (
    motion(1, "core", (0.0, 0.0, -1.0), 37.0),
    motion(2, "half_a", (1.0, 0.0, 0.0), 42.0),
    motion(3, "half_b", (-1.0, 0.0, 0.0), 39.0),
)


def test_a_rim_is_in_the_way_until_it_has_been_drawn_past() -> None:
    """A block of 20 mm in a rim of 3 x 4 mm with a gap of 0.15: pulled along X it cuts the whole
    rim, 3 x 20 x 4 = 240 mm3; once the rim is 4.2 mm lower nothing is in its way."""
    block = evaluate(box(-10, -10, 0, 10, 10, 20))
    rim = csg.without(box(-14, -14, -6, 14, 14, 4), [box(-10.15, -10.15, 0, 10.15, 10.15, 9)])
    met = swept(block, {"core": evaluate(rim)}, X, 30.0)
    assert met.overlap_mm3 == pytest.approx((14.0 - 10.15) * 20.0 * 4.0)
    assert met.over_mm3 > 0.0
    assert met.place_mm[0] == pytest.approx((14.0 + 10.15) / 2)
    lower = evaluate(rim).translate((0.0, 0.0, -4.2))
    assert swept(block, {"core": lower}, X, 30.0).over_mm3 <= 0.0


def test_faces_that_slide_on_each_other_are_no_overlap() -> None:
    """Two cubes of 10 mm touch on 100 mm2: 0.1 mm3 is tolerated, 1 mm3 is not."""
    one = evaluate(box(0, 0, 0, 10, 10, 10))
    below = evaluate(box(0, 0, -10, 10, 10, 0))
    assert touching_mm2(one, below) == pytest.approx(100.0, rel=0.02)
    assert tolerance_mm3(one, below) == pytest.approx(0.1, rel=0.02)
    assert tolerance_mm3(one, evaluate(box(20, 0, 0, 30, 10, 10))) == pytest.approx(1e-6)
    assert swept(one, {"below": below}, X, 12.0).over_mm3 <= 0.0
    sunk = one.translate((0.0, 0.0, -0.005))
    assert swept(sunk, {"below": below}, X, 12.0).over_mm3 > 0.2
    grazed = one.translate((0.0, 0.0, -0.0005))
    assert swept(grazed, {"below": below}, X, 12.0).over_mm3 <= 0.0
    assert way_mm(one, {"below": below}, X) == pytest.approx(10.0)


def test_a_peg_is_caught_however_wide_the_faces_around_it() -> None:
    """A peg of 1.5 x 1.2 x 1 mm in its socket under 2400 mm2 that slide: 1.2 mm3 at 1 mm, 1.8 at 2,
    where the rounding of so much area would be 2.4 mm3."""
    slab = csg.Union(parts=(box(0, 0, 0, 60, 40, 5), box(30, 20, -1, 31.5, 21.2, 0)))
    socket = csg.without(box(0, 0, -5, 60, 40, 0), [box(30, 20, -1, 31.5, 21.2, 1)])
    met = swept(evaluate(slab), {"below": evaluate(socket)}, X, 20.0)
    assert met.overlap_mm3 == pytest.approx(1.5 * 1.2, rel=0.01)
    assert met.over_mm3 > 1.0


def test_a_skin_is_as_wide_as_its_narrow_side_however_it_is_turned() -> None:
    """A fin beside a slab of 8 x 60 mm dents it by 0.5 / 4, along the axes and askew."""
    slab = csg.Union(
        parts=(box(-4, -30, 0, 4, 30, 20), box(3, -30, 0, 7, 30, 2), box(6, -30, 0, 7, 30, 10))
    )
    cavity = body(box(-2, -28, 0, 2, 28, 15))
    straight = outer_strain(cast(body(slab), cavity), HALVES, 0, backed=False)
    assert straight.value == pytest.approx(0.5 / 5.5, rel=0.02)
    askew = dataclasses.replace(HALVES, azimuth_deg=40.0)
    turned = cast(body(csg.turned(slab, 40.0)), body(csg.turned(cavity, 40.0)))
    assert outer_strain(turned, askew, 0, backed=False).value == pytest.approx(
        straight.value, rel=0.05
    )


def test_a_skin_squeezed_against_its_core_stretches_by_depth_over_rest() -> None:
    """Behind a fin of 1 mm a wall passes 0.5 mm deep, 12.5 - 6 = 6.5 mm from the core: 0.5 / 6.5;
    with the core gone the skin of half width 10 dents by 0.5 / 10."""
    made = cast(body(HOOKED), body(box(-6, -6, 0, 6, 6, 15)))
    backed = outer_strain(made, HALVES, 0, backed=True)
    assert backed.value == pytest.approx(0.5 / 6.5, rel=0.02)
    assert backed.place_mm[0] == pytest.approx(12.5, abs=0.01)
    free = outer_strain(made, HALVES, 0, backed=False)
    assert free.value == pytest.approx(0.5 / 10.0, rel=0.02)
    assert outer_strain(made, HALVES, 1, backed=True).value == 0.0


def test_a_ray_that_misses_makes_no_endless_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ray through a corner may come out nowhere: its way is left out, not 6 km long."""
    hits = RayCaster.hits

    def sometimes_missing(caster: RayCaster, origins: np.ndarray, along: np.ndarray) -> Any:
        distance, *others = hits(caster, origins, along)
        return np.where(np.arange(len(distance)) % 7 == 3, np.inf, distance), *others

    monkeypatch.setattr(RayCaster, "hits", sometimes_missing)
    made = cast(body(HOOKED), body(box(-6, -6, 0, 6, 6, 15)))
    worst = outer_strain(made, HALVES, 0, backed=True)
    assert worst.value < 1.0
    assert np.abs(worst.place_mm).max() <= 20.0


def test_a_core_with_a_head_squeezes_a_skin_that_is_held() -> None:
    """A head 1 mm wider than its neck, in a wall of 4 mm at the neck: it passes 1 mm deep there,
    and root 2 in the corners, 3 mm from the outside; a straight core asks for nothing."""
    outer = body(box(-10, -10, 0, 10, 10, 20))
    headed = csg.Union(parts=(box(-6, -6, 0, 6, 6, 15), box(-7, -7, 10, 7, 7, 15)))
    strain = confined_strain(cast(outer, body(headed)), DOWN)
    assert 1.0 / 3.0 < strain.value < np.sqrt(2.0) / 3.0 + 1e-3
    assert confined_strain(cast(outer, body(box(-6, -6, 0, 6, 6, 15))), DOWN).value == 0.0


def leaning(node: csg.Node, slope: float) -> csg.Body:
    """A body sheared along Y."""
    straight = body(node)
    points = straight.points_mm + straight.points_mm[:, 2:] * np.array([0.0, slope, 0.0])
    return csg.Body(points_mm=points, faces=straight.faces)


@pytest.mark.parametrize("slope", [0.0, 0.213])
def test_a_leaning_core_leaves_along_its_lean(slope: float) -> None:
    """A core sheared by tan 12 degrees goes 12 degrees aslant; a straight one goes down."""
    made = cast(
        leaning(csg.cylinder(10.0, 0.0, 30.0), slope), leaning(csg.cylinder(8.0, 0.0, 28.0), slope)
    )
    wanted = np.array([0.0, -slope, -1.0]) / np.hypot(slope, 1.0)
    assert np.degrees(np.arccos(min(1.0, float(core_way(made) @ wanted)))) < 0.2
    core = made.core
    assert core is not None
    skin = LabelledSurface(
        points_mm=made.outer.points_mm,
        faces=made.outer.faces,
        labels=np.zeros(len(made.outer.faces), np.uint8),
        numbers=np.full(len(made.outer.faces), -1, np.int16),
    )
    assert bend_strain(core, skin, core_way(made)).value == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("aside_mm", [0.0, 1e-7, 0.1])
def test_an_upright_core_wider_than_its_neck_goes_straight_down(aside_mm: float) -> None:
    """A bulb leans nowhere: rounding of its tip is no direction, and the way has length 1."""
    bulb = csg.Union(
        parts=(
            csg.cylinder(5.0, 0.0, 10.0),
            csg.cylinder(9.0, 10.0, 25.0),
            csg.cylinder(2.0, 25.0, 28.0),
        )
    )
    core = body(bulb)
    tip = core.points_mm[:, 2] > 27.0
    points = core.points_mm + aside_mm * np.outer(tip, [1.0, 0.0, 0.0])
    made = cast(body(csg.cylinder(12.0, 0.0, 30.0)), csg.Body(points_mm=points, faces=core.faces))
    assert core_way(made) == pytest.approx(DOWN)


def test_what_is_in_the_way_is_bad_and_told_with_its_place() -> None:
    """276 mm3 where 0.1 is tolerated: bad, with volume and place; a free one is good."""
    blocked = PartMotion(
        step=1,
        part="half_a",
        direction=(1.0, 0.0, 0.0),
        distance_mm=40.0,
        overlap_mm3=276.0,
        tolerance_mm3=0.1,
        overlap_at_mm=(12.0, 0.0, 2.0),
    )
    bad, good = motion_checks((blocked, motion(2, "half_b", (-1.0, 0.0, 0.0), 9.0)))
    assert (bad.severity, bad.value, bad.place_mm) == (Severity.BAD, 276.0, (12.0, 0.0, 2.0))
    assert "276 mm3" in bad.message
    assert good.severity is Severity.GOOD
    assert hardship((blocked,)) > hardship(OUTER_FIRST)


@pytest.mark.parametrize(("strain", "severity"), [(0.5, "good"), (1.0, "warning"), (2.5, "bad")])
def test_the_silicone_decides_whether_a_part_comes_off(strain: float, severity: str) -> None:
    """Of an elongation of 2 a third is good, all of it the end."""
    from geometry.mould.castability import Worst

    assert part_removal("half_a", Worst(strain, (0.0, 0.0, 0.0)), 2.0).severity == severity


def test_motions_are_rows_and_words() -> None:
    """The contract of `recipe.json`; axes by name, other ways by numbers."""
    rows = json.loads(recipe_json(OUTER_FIRST))
    assert rows[0] == {
        "step": 1,
        "part": "half_a",
        "direction": [1.0, 0.0, 0.0],
        "distance_mm": 42.0,
    }
    assert direction_words((-1.0, 0.0, 0.0)) == "-X"
    assert direction_words((-0.0, -0.2588, -0.9659)) == "(0.00, -0.26, -0.97)"


def test_closing_is_opening_backward() -> None:
    """Parts that come off first are put on last: a bent core stands before the halves close."""
    (stand,) = closing_steps(OUTER_FIRST, 2)
    assert stand.startswith("Stand the core on its flange and bring half_a and half_b")
    assert opening_steps(OUTER_FIRST, hollow=True)[1:4] == [
        "Pull half_a 42 mm along +X.",
        "Pull half_b 39 mm along -X.",
        "Roll the skin off the core, drawing the core 60 mm along (0.00, -0.26, -0.97).",
    ]
    bolt, close = closing_steps(CORE_FIRST, 2)
    assert bolt.startswith("Bolt half_a and half_b together")
    assert close == "Close the mould with the core, flange up, along +Z."
    assert opening_steps(CORE_FIRST, hollow=True)[1].startswith("Draw the core out of the skin")


def test_the_exploded_view_plays_the_motions_in_turn() -> None:
    """Of three motions the second is half done at a spread of 0.5; parts of the sensor go along."""

    class Server:
        scene = None

    view = PartsView(Server())

    def part(name: str, explode: tuple[float, float, float]) -> FabricationPart:
        return FabricationPart(
            name=name,
            group=PartGroup.MOULD,
            points_mm=np.zeros((3, 3)),
            faces=np.array([[0, 1, 2]]),
            brep=np.zeros(0, np.uint8),
            volume_mm3=1.0,
            watertight=True,
            explode=explode,
        )

    names = {"half_a": (42.0, 0.0, 0.0), "half_b": (-39.0, 0.0, 0.0), "core": (0.0, 0.0, -60.0)}
    parts = [part(name, way) for name, way in names.items()]
    view.load((*parts, part("support", (0.0, 0.0, 20.0))), OUTER_FIRST)
    view.spread = 0.5
    where = [view.moved(name, (0.0, 0.0, 0.0)) for name in (*names, "support")]
    assert where == [(42.0, 0.0, 0.0), (-19.5, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 10.0)]
