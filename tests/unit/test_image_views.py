"""What is shown of an image and of a map: exact colours, scales and words of made-up ones."""

from __future__ import annotations

import numpy as np
import pytest

from tests.unit.test_quantities import SQUARE
from ui.page.imaging import scale_bar, table
from workbench.core.result.maps import DesignerMaps, SkinMap
from workbench.core.result.sensing import TactileFrames
from workbench.view.colour_scale import NOTHING_GREY, YES, scale_colours, viridis
from workbench.view.image_views import (
    NO_CHANGE,
    OF_IMAGES,
    View,
    looked,
    unseen_words,
    views,
    visible_change,
    wiped,
)
from workbench.view.map_display import (
    heights_words,
    map_look,
    score_rows,
    scores,
    value_at,
    value_words,
)

HIGH, WIDE = 8, 12


def frames(markers: int = 0) -> TactileFrames:
    """Background and one frame, in which one pixel moved from 10 mm to 12 mm; column 0 misses."""
    rgb = np.full((2, HIGH, WIDE, 3), 100, np.uint8)
    rgb[1, 4, 6] = (110, 100, 90)
    depth = np.full((2, HIGH, WIDE), 10.0, np.float32)
    depth[1, 4, 6] = 12.0
    depth[:, :, 0] = np.nan
    normal = np.zeros((2, HIGH, WIDE, 3), np.float16)
    normal[..., 2] = 1.0
    normal[:, :, 0] = 0.0
    moved = np.zeros((2, HIGH, WIDE), bool)
    moved[1, 4, 6] = True
    uv = np.full((2, markers, 2), 5.0, np.float32)
    uv[1, :1] += 0.5
    return TactileFrames(
        rgb=rgb,
        depth_z_mm=depth,
        normal=normal,
        moved=moved,
        marker_uv_px=uv,
        exposure=1.0,
        marker_mm=np.zeros((markers, 3), np.float32),
    )


def test_views_follow_what_there_is() -> None:
    """A live press has images only; marker motion needs markers."""
    assert views(None) == OF_IMAGES
    assert View.MOTION not in views(frames())
    assert set(views(frames(3))) == set(View)


def test_the_image_itself_is_shown_as_it_is() -> None:
    """Frame 1 to the byte, without a legend."""
    given = frames()
    found = looked(View.IMAGE, given.rgb, 1, given)
    assert np.array_equal(found.rgb, given.rgb[1])
    assert found.words == ""


def test_difference_is_about_mid_grey() -> None:
    """+10 and -10 grey levels, strengthened 8 times at most; unchanged pixels are 128."""
    given = frames()
    change, gain = visible_change(given.rgb[1], given.rgb[0])
    assert gain == 8
    assert tuple(change[4, 6]) == (208, 128, 48)
    assert (change[0] == 128).all()


def test_a_contact_is_not_blown_out_by_a_faint_change_all_over() -> None:
    """60 levels on a hundredth of the image and 1 everywhere: twice, so that 120 do not saturate.

    Nineteen of twenty changed values are 1; they alone would ask for eight times.
    """
    before = np.full((100, 100, 3), 100, np.uint8)
    after = before + 1
    after[40:50, 40:50] = 160
    change, gain = visible_change(after, before)
    assert gain == 2
    assert change.max() < 255


def test_a_sparkle_does_not_hide_a_contact() -> None:
    """One pixel of +150 beside a hundred of +15: it saturates, they are strengthened 8 times."""
    before = np.full((100, 100, 3), 100, np.uint8)
    after = before.copy()
    after[40:50, 40:50] = 115
    after[0, 0] = 250
    change, gain = visible_change(after, before)
    assert gain == 8
    assert tuple(change[45, 45]) == (248, 248, 248)


def test_a_plain_grey_difference_says_so() -> None:
    """Of a frame that changes nothing beyond rounding; not of the background, nor of a real one."""
    given = frames()
    rgb = np.stack([given.rgb[0], given.rgb[0], given.rgb[1]])
    rgb[1, 0, 0] += 1
    words = [looked(View.DIFFERENCE, rgb, number).words for number in range(3)]
    assert [NO_CHANGE in found for found in words] == [False, True, False]
    assert all("× " in found for found in words)


def test_an_image_that_is_too_bright_says_so() -> None:
    """White everywhere is no lack of contact; a twentieth of it is said beside the change."""
    dark, white = np.full((10, 20, 3), 90, np.uint8), np.full((10, 20, 3), 255, np.uint8)
    assert unseen_words(dark, dark) == NO_CHANGE
    assert unseen_words(white, white).startswith("no change seen: 100 % of the pixels are white")
    spot = dark.copy()
    spot[0, :10] = 255
    assert unseen_words(spot, dark).startswith("5 % of the pixels are white")
    spot[0, :10, 2] = 200
    assert unseen_words(spot, dark) == ""


def test_normals_are_coloured_by_axis() -> None:
    """The normal +Z is (127.5, 127.5, 255) to rounding; a miss is grey."""
    given = frames()
    rgb = looked(View.NORMALS, given.rgb, 1, given).rgb
    assert tuple(rgb[2, 3]) == (128, 128, 255)
    assert tuple(rgb[2, 0]) == NOTHING_GREY


def test_depth_has_the_scale_of_frame_and_background() -> None:
    """From 10 to 12 mm in both; the deeper pixel has the upper end's colour, a miss is grey."""
    given = frames()
    rest, now = (looked(View.DEPTH, given.rgb, k, given) for k in (0, 1))
    assert now.bar is not None
    assert (now.bar.low, now.bar.high, now.bar.unit) == (10.0, 12.0, "mm")
    assert tuple(now.rgb[4, 6]) == YES
    assert tuple(now.rgb[4, 0]) == NOTHING_GREY
    assert rest.bar is not None
    assert rest.bar.low == 10.0


def test_contact_mask_tells_its_share() -> None:
    """One of 96 pixels, 1.0 %, white; the rest dark."""
    given = frames()
    found = looked(View.CONTACT, given.rgb, 1, given)
    assert "1.0 %" in found.words
    assert tuple(found.rgb[4, 6]) == (255, 255, 255)
    assert tuple(found.rgb[0, 0]) == (30, 30, 30)


def test_marker_motion_tells_the_longest_way() -> None:
    """One of three markers went 0.5 px in both directions: 0.71 px."""
    given = frames(3)
    found = looked(View.MOTION, given.rgb, 1, given)
    assert "longest 0.71 px, 3 markers" in found.words


def skin_map(values: list[float], name: str = "incidence", unit: str = "deg") -> SkinMap:
    """A map of four vertices; percentiles from 0 to 60 in steps of 10."""
    return SkinMap(
        name=name,
        label=name,
        unit=unit,
        values=np.array(values, np.float32),
        percentiles=np.arange(0.0, 70.0, 10.0),
        score_name=f"{name}_median_deg",
        score=30.0,
        better="less",
        meaning="",
    )


def test_map_scale_is_from_5_to_95_percent() -> None:
    """10 and 50 degrees are the ends, 30 the middle; blind places are grey."""
    look = map_look(skin_map([10.0, 50.0, 70.0, np.nan]))
    assert (look.low, look.middle, look.high) == (10.0, 30.0, 50.0)
    assert tuple(look.colours[0]) == tuple(viridis(np.zeros(1))[0])
    assert tuple(look.colours[1]) == tuple(look.colours[2]) == YES
    assert tuple(look.colours[3]) == NOTHING_GREY


def test_blind_places_of_a_yes_and_no_map_are_grey() -> None:
    """0 is blind, 1 is seen, whatever the percentiles."""
    look = map_look(skin_map([0.0, 1.0, 1.0, 1.0], name="visible", unit="1"))
    assert tuple(look.colours[0]) == NOTHING_GREY
    assert tuple(look.colours[1]) == YES
    assert (look.low, look.high) == (0.0, 1.0)


def test_where_skin_is_blind_is_told_by_its_height() -> None:
    """The lowest and the highest vertex that no camera sees; nothing where all are seen."""
    points = np.array([[0.0, 0.0, -0.01], [1.0, 0.0, 4.0], [0.0, 1.0, 12.6], [0.0, 0.0, 30.0]])
    found = skin_map([0.0, np.nan, 0.0, 1.0], name="visible", unit="1")
    words = heights_words(found, points)
    assert words.endswith("skin at heights z from 0.0 to 12.6 mm")
    assert not heights_words(skin_map([1.0] * 4, name="visible", unit="1"), points)


@pytest.mark.parametrize("level", [0.0, 3.0, -2.0, np.nan])
def test_a_map_of_one_value_has_a_scale(level: float) -> None:
    """Its ends differ and are finite, or the legend would divide by zero."""
    flat = skin_map([2.5] * 4)
    flat.percentiles[:] = level
    look = map_look(flat)
    assert look.high > look.low


def test_a_click_tells_the_value_of_the_nearest_vertex() -> None:
    """From above near the corner (2, 2): vertex 2 with 70 degrees; beside the skin nothing."""
    found, down = skin_map([10.0, 50.0, 70.0, np.nan]), np.array([0.0, 0.0, -1.0])
    hit = value_at(found, SQUARE.points_mm, SQUARE.faces, np.array([1.8, 1.9, 5.0]), down)
    assert hit is not None
    np.testing.assert_allclose(hit[0], [1.8, 1.9, 0.0])
    assert value_words(found, hit[1]) == "70 deg"
    assert value_at(found, SQUARE.points_mm, SQUARE.faces, np.array([9.0, 9, 5]), down) is None
    assert value_words(found, np.nan) == "blind here"


def test_scores_say_which_way_is_better_and_lights_come_last() -> None:
    """A row per map, its score named as on the score card, with its unit; single LEDs come last."""
    maps = DesignerMaps(maps=(skin_map([1.0], "led_01"), skin_map([1.0])))
    rows = score_rows(maps)
    assert rows[0] == ("incidence", "angle of sight", "30 °", "low")
    assert rows[1][0] == "led_01"
    assert scores(maps) == {"incidence_median_deg": 30.0}


def test_colours_of_numbers_that_are_none() -> None:
    """NaN is grey, beyond the ends the ends' colours, also of a scale without width."""
    colours = scale_colours(np.array([np.nan, -1e9, 1e9]), 0.0, 1.0)
    assert tuple(colours[0]) == NOTHING_GREY
    assert np.array_equal(colours[1:], viridis(np.array([0.0, 1.0])))
    assert scale_colours(np.array([1.0]), 1.0, 1.0).shape == (1, 3)


def test_legend_and_table_escape_and_name_units() -> None:
    """Both ends have the unit, the median its place; names cannot be HTML."""
    bar = scale_bar(1.0, 3.0, "mm", middle=2.0)
    assert "1 mm" in bar
    assert "3 mm" in bar
    assert "left:50.0%" in bar
    assert "<b>" not in table(("a",), (("<b>",),))


def test_a_chosen_gain_is_taken_as_it_is() -> None:
    """+10 and -10 grey levels twice and 32 times, clipped at the ends; the automatic one is 8."""
    given = frames()
    for gain, seen in ((2, (148, 128, 108)), (32, (255, 128, 0))):
        change, told = visible_change(given.rgb[1], given.rgb[0], gain)
        assert told == gain
        assert tuple(change[4, 6]) == seen
    words = looked(View.DIFFERENCE, given.rgb, 1, given, gain=4).words
    assert "× 4" in words


def test_false_colour_has_one_scale_for_the_frame_and_the_rest() -> None:
    """The channel that moved most, 10 of 10; and 8 grey levels at least, so that noise is dark."""
    given = frames()
    found = looked(View.CHANGE, given.rgb, 1, given)
    assert found.bar is not None
    assert (found.bar.high, found.bar.unit) == (10.0, "grey")
    assert tuple(found.rgb[4, 6]) == YES
    rest = looked(View.CHANGE, given.rgb, 0, given, beside=1)
    assert rest.bar == found.bar
    assert (rest.rgb == viridis(np.array(0.0))).all()
    faint = given.rgb.copy()
    faint[1] = faint[0] + 1
    nothing = looked(View.CHANGE, faint, 1)
    assert nothing.bar is not None
    assert nothing.bar.high == 8.0


@pytest.mark.parametrize(("share", "column"), [(0.0, 0), (0.5, WIDE // 2), (1.0, WIDE)])
def test_a_wipe_has_what_was_on_the_left(share: float, column: int) -> None:
    """Rest up to the line and the frame beyond, whole images at the ends without a line."""
    was, now = (np.full((HIGH, WIDE, 3), grey, np.uint8) for grey in (10, 200))
    both = wiped(now, was, share)
    line = 1 if 0 < column < WIDE else 0
    assert (both[:, : column - line] == 10).all()
    assert (both[:, column + line :] == 200).all()
    assert (both[:, column - line : column + line] == 255).all()
