"""Strokes after the approach: where the object goes, and what is refused."""

import numpy as np
import pytest

from sim.contact.motion.approach import Approach, plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.readout.verdict import check_depth
from sim.contact.studies.specimens import finger, flat_block
from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.core.base.mapping import from_table, to_table
from workbench.core.press.actuation import Actuation
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.motion import (
    Stroke,
    StrokeKind,
    hold,
    lift,
    move,
    press_stroke,
    release,
    roll,
    slide,
    twist,
)
from workbench.core.press.press import Press
from workbench.edit.strokes import read_stroke

BLOCK, _ = flat_block(width_mm=16.0, height_mm=4.0, grid_mm=1.0)
FINGER, _ = finger(grid_mm=2.0)
FRAMES = 4


def plan(*strokes: Stroke, kind: IndenterKind = IndenterKind.SPHERE, **press: object) -> Approach:
    """A press 1 mm into the block by four frames, then strokes; U is +X, V is +Y there."""
    collider = make_collider(Indenter(kind=kind), grid_mm=0.5)
    fields = {"target_mm": (0.0, 0.0, 4.0), "frames": FRAMES, **press}
    return plan_approach(BLOCK.outer, collider, Press(strokes=strokes, **fields))  # type: ignore[arg-type]


def test_strokes_follow_one_another() -> None:
    """3 mm deep in all, 1 and -2 mm aside, lifted by 0.5 mm: the places after every stroke."""
    approach = plan(press_stroke(0.5, frames=2), slide(1.0, -2.0), lift(0.2), move(-1.0, 0.0, -0.1))
    origins, turned = approach.poses(np.array([4.0, 6.0, 16.0, 26.0, 36.0, 99.0]))
    exact = [[0, 0, 6.0], [0, 0, 5.5], [1, -2, 5.5], [1, -2, 5.7], [0, -2, 5.6], [0, -2, 5.6]]
    # First touch is exact to 1e-4 mm on a flat skin.
    np.testing.assert_allclose(origins, exact, atol=1e-4)
    np.testing.assert_allclose(turned, np.tile(np.eye(3), (6, 1, 1)), atol=1e-12)
    assert approach.frame_count == 4 + 2 + 30
    assert approach.deepest_mm == pytest.approx(1.5)
    assert approach.aside_mm == pytest.approx(5.0**0.5)


def test_strokes_begin_where_shear_and_twist_end() -> None:
    """The pose is continuous over the seam, and a twist adds to a twist."""
    approach = plan(twist(40.0), shear_mm=(0.3, 0.1), twist_deg=20.0)
    before, after = approach.pose(2 * FRAMES - 1e-9), approach.pose(2.0 * FRAMES)
    # In 1e-9 of a frame nothing moves by more than 1e-9 mm.
    np.testing.assert_allclose(after[0], before[0], atol=1e-8)
    np.testing.assert_allclose(after[1], before[1], atol=1e-8)
    _, end = approach.pose(99.0)
    angle = np.radians(60.0)
    np.testing.assert_allclose(end[:2, 0], [np.cos(angle), np.sin(angle)], atol=1e-12)


@pytest.mark.parametrize("axis_deg", [0.0, 90.0, 30.0])
def test_rolling_ball_does_not_slip(axis_deg: float) -> None:
    """The material point at the contact stands still; the origin goes 2 mm x 0.5 rad along a x n.

    The ball of radius 3 mm lies 1 mm deep, so the contact plane is 2 mm below its origin.
    """
    degrees = np.degrees(0.5)
    approach = plan(roll(degrees, axis_deg=axis_deg))
    start, end = approach.pose(4.0)[0], approach.pose(14.0)[0]
    angle = np.radians(axis_deg)
    exact = np.cross([np.cos(angle), np.sin(angle), 0.0], [0.0, 0.0, 1.0])
    np.testing.assert_allclose(end - start, 2.0 * 0.5 * exact, atol=1e-4)
    step = 1e-4
    (origin, rotation), (later, turned) = approach.pose(8.0), approach.pose(8.0 + step)
    contact = rotation.T @ np.array([0.0, 0.0, approach.touch_mm - 1.0]) * -1.0
    moved = (later + turned @ contact) - (origin + rotation @ contact)
    # To first order nothing: what is left is the square of the turn, 5e-6^2 x 2 mm.
    assert np.linalg.norm(moved) < 1e-10
    assert np.linalg.norm(later - origin) > 5e-6


@pytest.mark.parametrize("kind", [IndenterKind.SPHERE, IndenterKind.CUBE])
def test_release_leaves_the_clearance(kind: IndenterKind) -> None:
    """After a roll of 30 degrees a cube's edge hangs lower; either ends 0.5 mm above the skin."""
    approach = plan(roll(30.0), release(frames=3), kind=kind, depth_mm=0.5)
    origin, rotation = approach.pose(99.0)
    gap = approach.collider.distance((BLOCK.outer.points_mm - origin) @ rotation)[0].min()
    assert gap == pytest.approx(0.5, abs=2e-3)
    assert approach.overlaps_mm[-1] == 0.0
    assert not approach.pressing(approach.frame_count - 1)
    assert approach.pressing(FRAMES - 1)


def test_slide_off_a_curved_skin_is_not_pressing() -> None:
    """8 mm along the tangent of R 15 at 1 mm depth: the ball is 0.79 mm off in the end."""
    collider = make_collider(Indenter(), grid_mm=0.5)
    press = Press(target_mm=(0.0, 0.0, 42.0), frames=FRAMES, strokes=(slide(0.0, 8.0, frames=8),))
    approach = plan_approach(FINGER.outer, collider, press)
    touching = [approach.pressing(frame) for frame in range(approach.frame_count)]
    # Contact ends where 17^2 + s^2 = 18^2, at 5.92 mm: frames end at 1, 2 ... 8 mm.
    assert touching == [True] * FRAMES + [True] * 5 + [False] * 3
    # Where contact ends the extrapolation begins anew.
    assert [approach.continues(k) for k in range(12)] == [1, 2, 3, 4, 1, 2, 3, 4, 5, 1, 2, 3]


def test_straight_runs_are_counted() -> None:
    """Each stroke begins at 1, rest is 0, and a stroke that goes on the same way counts on."""
    approach = plan(
        press_stroke(0.25, frames=1), slide(1, 0, frames=3), hold(2), twist(9, frames=3)
    )
    found = [approach.continues(frame) for frame in range(approach.frame_count)]
    assert found == [1, 2, 3, 4, 5, 1, 2, 3, 0, 0, 1, 2, 3]


def test_travel_is_way_and_turn() -> None:
    """A slide of 3 mm by 3 frames: 1 mm; a twist of 90 degrees by 3 frames at 2 mm: pi / 3 mm."""
    approach = plan(slide(3.0, 0.0, frames=3), twist(90.0, frames=3))
    assert approach.travel_mm(5, 2.0) == pytest.approx(1.0)
    assert approach.travel_mm(8, 2.0) == pytest.approx(np.pi / 3)


def test_driven_regions_make_no_force_certain() -> None:
    """An actuator may take the skin away: nothing is due, and the object rests at the end."""
    drive = Actuation(move_mm=(0.0, 0.0, -1.0), keys=((0.0, 0.0), (20.0, 1.0)))
    approach = plan(shear_mm=(0.5, 0.0), actuations=(drive,))
    assert approach.frame_count == 20
    assert not any(approach.pressing(frame) for frame in range(20))
    np.testing.assert_allclose(approach.pose(20.0)[0], [0.5, 0.0, 6.0], atol=1e-4)
    assert [approach.continues(k) for k in range(10)] == [1, 2, 3, 4, 1, 2, 3, 4, 0, 0]


def test_stroke_into_the_support_is_refused() -> None:
    """1 + 3.4 mm into 4 mm: met in the last of four frames of the second stroke, 0.4 mm deep."""
    approach = plan(slide(1.0, 0.0), press_stroke(3.4, frames=4))
    with pytest.raises(DesignError) as raised:
        check_depth(BLOCK.inner.points_mm, approach)
    assert raised.value.at == "press.strokes"
    # The support is looked at where its vertices are: up to 0.28 mm aside, which is 0.013 mm less.
    assert "frame 18 of 18 (stroke 2, press:3.4): the object reaches 0.39 mm" in str(raised.value)
    check_depth(BLOCK.inner.points_mm, plan(slide(1.0, 0.0), press_stroke(2.9)))


def test_support_is_looked_at_on_the_way() -> None:
    """A slide of 100 mm in one frame crosses a post 20 mm aside that its ends do not touch."""
    post = np.array([[20.0, 0.0, 4.0]])
    up, aside, down = lift(50.0, frames=1), slide(-50.0, 0.0), move(0.0, 0.0, -50.0)
    with pytest.raises(DesignError, match="stroke 4, slide:100,0"):
        check_depth(post, plan(up, aside, down, slide(100.0, 0.0, frames=1)))


@pytest.mark.parametrize(
    ("words", "stroke"),
    [
        ("press:0.5", press_stroke(0.5, frames=7)),
        ("slide:3,-1:12", slide(3.0, -1.0, frames=12)),
        ("twist:-30:2", twist(-30.0, frames=2)),
        ("roll:30", roll(30.0, frames=7)),
        ("roll:30,90", roll(30.0, axis_deg=90.0, frames=7)),
        ("lift:.2", lift(0.2, frames=7)),
        ("release", release(frames=7)),
        ("release:1:3", release(clearance_mm=1.0, frames=3)),
        ("hold", hold(7)),
        ("hold:5", hold(5)),
        ("move:1,0,-0.2", move(1.0, 0.0, -0.2, frames=7)),
    ],
)
def test_strokes_are_read_from_words(words: str, stroke: Stroke) -> None:
    """KIND:AMOUNT[:FRAMES]; without frames 7, those of the approach. `text` says it again."""
    assert read_stroke(words, frames=7) == stroke
    assert read_stroke(stroke.text, frames=stroke.frames) == stroke


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("slid:3,0", "there is no stroke 'slid'"),
        ("slide:3", "'slide:3' cannot be read"),
        ("slide:3,0:2,3", "cannot be read"),
        ("slide:3,0:1.5", "cannot be read"),
        ("slide:3,0:5:6", "cannot be read"),
        ("slide:a,b", "cannot be read"),
        ("twist:400", "turn of a twist 400 degree is outside -360 to 360"),
        ("press:nan", "not a finite number"),
        ("hold:0", "frame count of a hold 0 is outside 1 to 500"),
        ("hold:1e999", "cannot be read"),
    ],
)
def test_bad_words_are_refused(words: str, message: str) -> None:
    """One message that names the words or the value, and a remedy."""
    with pytest.raises(DesignError, match=message.replace(".", r"\.")) as raised:
        read_stroke(words, frames=7)
    assert raised.value.at == "press.strokes"
    assert raised.value.hint


def test_amounts_of_another_kind_are_refused() -> None:
    """A hold that shifts and a slide that turns say what belongs where."""
    for kind, amount in (
        (StrokeKind.HOLD, {"shift_mm": (1.0, 0.0, 0.0)}),
        ("slide", {"turn_deg": 5}),
    ):
        with pytest.raises(DesignError) as raised:
            Stroke(kind=StrokeKind(kind), **amount)  # type: ignore[arg-type]
        assert "shifts belong to press, slide, lift and move" in raised.value.hint


def test_strokes_survive_a_file_and_change_the_key() -> None:
    """A press as a table and back is equal; another stroke has another digest."""
    press = Press(strokes=(slide(1.0, 2.0), release()))
    table = to_table(press)
    assert "trajectory" not in table
    assert from_table(Press, table) == press
    assert digest(press) != digest(Press(strokes=(slide(1.0, 2.1), release())))
