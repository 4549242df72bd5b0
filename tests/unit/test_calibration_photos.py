"""Photographs that a calibration is given: what is read, found in them, and refused by name."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import cv2
import numpy as np
import pytest

from workbench.calibration.ball_presses import allowed_mm
from workbench.calibration.light_basis import contact_box
from workbench.calibration.seen.contact_circle import find_circle, relative_change
from workbench.calibration.seen.drift import measured_drift, seen_photos
from workbench.calibration.seen.photo_set import (
    COLUMNS,
    BallPhoto,
    Circle,
    PhotoSet,
    read_photo_set,
)
from workbench.calibration.seen.seen_places import ContactPlace
from workbench.core.base.errors import DesignError

WIDTH, HEIGHT = 200, 150
HEAD = ",".join(COLUMNS)


def dent_change(column: float, row: float, radius: float) -> np.ndarray:
    """What a dent changes in light of three colours from three sides, (H, W, 3) grey levels.

    Not the finder's own template: a ball's cap, whose slope grows as rho / sqrt(R^2 - rho^2), and
    beyond it skin that sinks in as under a point load (Boussinesq), its slope falling as 1 / rho^2.
    """
    y, x = np.mgrid[:HEIGHT, :WIDTH].astype(float)
    away = np.hypot(x - column, y - row)
    ball = 1.15 * radius
    inside = away / np.sqrt(np.maximum(ball**2 - np.minimum(away, radius) ** 2, 1.0))
    size = np.where(away < radius, inside, 0.8 * (radius / np.maximum(away, 1.0)) ** 2)
    along, across = (size * (v - c) / np.maximum(away, 1e-9) for v, c in ((x, column), (y, row)))
    turn = np.radians([90.0, 210.0, 330.0])
    return 40.0 * (along[..., None] * np.cos(turn) + across[..., None] * np.sin(turn))


def folder(tmp_path: Path, rows: list[str], *, count: int = 6) -> Path:
    """Photographs p0.png ... with a dent each, and a table of these rows."""
    idle = np.full((HEIGHT, WIDTH, 3), 120, np.uint8)
    cv2.imwrite(str(tmp_path / "idle.png"), idle)
    for number in range(count):
        shown = np.clip(idle + dent_change(60 + 10 * number, 70, 20), 0, 255).astype(np.uint8)
        cv2.imwrite(str(tmp_path / f"p{number}.png"), shown[:, :, ::-1])
    (tmp_path / "presses.csv").write_text("\n".join([HEAD, *rows]) + "\n")
    return tmp_path


GOOD = [f"p{number}.png,6,,,,," for number in range(6)]


def test_a_folder_is_read_as_it_stands(tmp_path: Path) -> None:
    """Empty places are unknown; a name without its ending is held out."""
    rows = ["p0.png,4.7,60,70,20,0.8,1.5,0,-3.5,20", *GOOD[1:]]
    found = read_photo_set(folder(tmp_path, rows), ("p3",))
    assert [each.held_out for each in found.photos] == [False, False, False, True, False, False]
    first, second = found.photos[:2]
    assert first.circle == Circle(column_px=60.0, row_px=70.0, radius_px=20.0)
    assert (first.ball_mm, first.depth_mm, first.force_N) == (4.7, 0.8, 1.5)
    assert first.place_mm is not None and first.place_mm.tolist() == [0.0, -3.5, 20.0]
    assert second.place_mm is None
    assert (second.circle, second.depth_mm, second.force_N) == (None, None, None)
    assert len(found.fitted) == 5


@pytest.mark.parametrize(
    ("row", "says"),
    [
        ("missing.png,6,,,,,", r"missing\.png"),
        ("p0.png,,,,,,", r"p0\.png has no ball_mm"),
        ("p0.png,ball,,,,,", r"p0\.png: ball_mm is 'ball'"),
        ("p0.png,6,250,70,20,,", r"p0\.png: column_px is '250'"),
        ("p0.png,6,50,,20,,", r"p0\.png has a circle without row_px"),
        ("p0.png,6,,,,-1,", r"p0\.png: depth_mm is '-1'"),
        ("p1.png,6,,,,,", r"names 'p1\.png' twice"),
    ],
)
def test_a_wrong_row_is_refused_by_name(tmp_path: Path, row: str, says: str) -> None:
    """Each with its value and what it may be."""
    with pytest.raises(DesignError, match=says) as caught:
        read_photo_set(folder(tmp_path, [row, *GOOD[1:]]))
    assert caught.value.exit_code == 2 and caught.value.hint


def test_another_size_is_refused_by_name(tmp_path: Path) -> None:
    """Both sizes are told."""
    where = folder(tmp_path, GOOD)
    cv2.imwrite(str(where / "p2.png"), np.zeros((HEIGHT, WIDTH - 2, 3), np.uint8))
    with pytest.raises(DesignError, match=r"p2\.png has 198 x 150 pixels, idle\.png 200 x 150"):
        read_photo_set(where)


def test_too_few_photographs_are_refused(tmp_path: Path) -> None:
    """Held-out ones do not count."""
    with pytest.raises(DesignError, match="leaves 4 photographs to fit to, fewer than 5"):
        read_photo_set(folder(tmp_path, GOOD), ("p0", "p5.png"))
    with pytest.raises(DesignError, match="no photograph 'p9' to hold out"):
        read_photo_set(folder(tmp_path, GOOD), ("p9",))


@pytest.mark.parametrize(("column", "row", "radius"), [(70, 80, 12), (120, 60, 22), (100, 75, 16)])
def test_a_contact_is_found_where_it_is(column: int, row: int, radius: int) -> None:
    """In noise of three grey levels: middle within a fifth of the radius, size within a third."""
    noise = np.random.default_rng(1).normal(0.0, 3.0, (HEIGHT, WIDTH, 3))
    found = find_circle(dent_change(column, row, radius) + noise, "p.png")
    assert np.hypot(found.column_px - column, found.row_px - row) < 0.2 * radius
    assert found.radius_px == pytest.approx(radius, rel=1 / 3)


@pytest.mark.parametrize(("column", "row"), [(40, 36), (150, 110)])
def test_a_small_contact_in_strong_noise_is_found(column: int, row: int) -> None:
    """It explains less than a quarter of all that differs, and far more than any other place."""
    noise = np.random.default_rng(2).normal(0.0, 14.0, (4 * HEIGHT, 4 * WIDTH, 3))
    noise[:HEIGHT, :WIDTH] += dent_change(column, row, 12)
    found = find_circle(noise, "p.png")
    assert np.hypot(found.column_px - column, found.row_px - row) < 4.0
    with pytest.raises(DesignError, match="as much as elsewhere"):
        find_circle(noise[HEIGHT:], "none.png")


def test_a_contact_with_a_highlight_in_strong_noise_is_found() -> None:
    """Slopes explain half of the change where it is, and hundreds of times that of other places."""
    noise = np.random.default_rng(3).normal(0.0, 20.0, (4 * HEIGHT, 4 * WIDTH, 3))
    noise[:HEIGHT, :WIDTH] += dent_change(90, 70, 12)
    row, column = np.mgrid[: 4 * HEIGHT, : 4 * WIDTH]
    noise += (80.0 * np.exp(-((column - 90) ** 2 + (row - 70) ** 2) / 50.0))[..., None]
    found = find_circle(noise, "p.png")
    assert np.hypot(found.column_px - 90, found.row_px - 70) < 4.0


@pytest.mark.parametrize("seen", [0.7, 1.0, 1.3])
def test_a_circle_that_was_found_allows_for_its_error(seen: float) -> None:
    """Of a ball of 3 mm that is .8 mm deep, by Hertz; one that was drawn is off by a tenth."""
    place = ContactPlace(
        point_mm=np.zeros(3), normal=np.array([0.0, 0.0, 1.0]), radius_mm=seen * np.sqrt(3.0 * 0.8)
    )
    found = dataclasses.replace(ball_photo(0, dent=True), ball_mm=6.0)
    least_mm, most_mm, _ = allowed_mm(found, place, wall_mm=2.0)
    assert least_mm < 0.5 * 0.8 and most_mm > 1.1 * 0.8
    drawn = dataclasses.replace(found, circle=Circle(column_px=9.0, row_px=9.0, radius_px=9.0))
    least_mm, most_mm, _ = allowed_mm(drawn, place, wall_mm=2.0)
    assert (least_mm < 0.8 < most_mm) == (seen > 0.9)


@pytest.mark.parametrize(("column", "row", "radius"), [(140, 75, 16), (150, 60, 20)])
def test_a_contact_in_the_dark_is_no_nearer_to_the_light(
    column: int, row: int, radius: int
) -> None:
    """Light that halves every 28 px makes the change of one flank more than twice the other's.

    By the change itself such a contact is found a quarter of its radius off.
    """
    light = np.exp(-np.arange(WIDTH) / 40.0)[None, :, None] * np.ones((HEIGHT, 1, 3))
    idle = np.clip(240.0 * light, 4.0, 255.0).astype(np.uint8)
    change = dent_change(column, row, radius)
    noise = np.random.default_rng(1).normal(0.0, 1.0, idle.shape)
    taken = idle * (1.0 + 0.8 * change / np.abs(change).max()) + noise
    found = find_circle(relative_change(taken, idle), "p.png")
    assert np.hypot(found.column_px - column, found.row_px - row) < 0.2 * radius


def test_what_is_cut_off_changes_nothing() -> None:
    """A mirror image of a light, white at rest, and skin that becomes white."""
    idle = np.full((20, 30, 3), 100, np.uint8)
    idle[5, 5], taken = (255, 40, 40), np.full((20, 30, 3), 120.0)
    taken[10, 10] = (90.0, 255.0, 90.0)
    found = relative_change(taken, idle)
    assert (found[5, 5] == 0.0).all() and (found[10, 10] == 0.0).all()
    assert (found[15, 20] > 0.1).all()


def test_no_contact_is_refused_by_name() -> None:
    """Noise, fine and smooth, and an exposure that changed everywhere."""
    random = np.random.default_rng(1)
    noise = random.normal(0.0, 3.0, (HEIGHT, WIDTH, 3))
    smooth = 20.0 * cv2.GaussianBlur(noise, (0, 0), 4.0)
    ramp = np.linspace(-20.0, 20.0, WIDTH)[None, :, None] * np.ones((HEIGHT, 1, 3))
    for change in (noise, smooth, noise + ramp):
        with pytest.raises(DesignError, match=r"flat\.png shows no contact") as caught:
            find_circle(change, "flat.png")
        assert "column_px" in caught.value.hint


def ball_photo(number: int, *, dent: bool, circle: Circle | None = None) -> BallPhoto:
    """A photograph with a dent or with noise alone."""
    noise = np.random.default_rng(number).normal(0.0, 1.0, (HEIGHT, WIDTH, 3))
    change = dent_change(100, 75, 16) if dent else 0.0
    image = np.clip(np.round(120.0 + change + noise), 0, 255).astype(np.uint8)
    return BallPhoto(
        name=f"p{number}.png",
        image=image,
        ball_mm=4.0,
        circle=circle,
        place_mm=None,
        depth_mm=None,
        force_N=None,
        held_out=False,
    )


def photo_set(dents: int, weak: int) -> PhotoSet:
    """Photographs with a dent, then weak ones."""
    photos = [ball_photo(number, dent=number < dents) for number in range(dents + weak)]
    idle = np.full((HEIGHT, WIDTH, 3), 120, np.uint8)
    return PhotoSet(idle=idle, idle_png=b"", photos=tuple(photos))


def test_a_weak_photograph_among_good_ones_is_left_out() -> None:
    """One that shows nothing, and one whose contact is not on the skin, each with its reason."""

    def located(circle: Circle, photo: BallPhoto) -> str:
        if photo.name == "p0.png":
            raise DesignError(f"{photo.name} is off the skin", hint="", at="")
        return photo.name

    seen, left_out = seen_photos(photo_set(dents=7, weak=1), located)
    assert [each.photo.name for each, _ in seen] == [at for _, at in seen]
    assert [each.photo for each in left_out] == ["p0.png", "p7.png"]
    assert "off the skin" in left_out[0].why and "shows no contact" in left_out[1].why


@pytest.mark.parametrize(("dents", "weak"), [(4, 1), (6, 4)])
def test_photographs_of_something_else_are_refused(dents: int, weak: int) -> None:
    """Fewer than five remain, or fewer than two thirds."""
    with pytest.raises(DesignError, match=rf"p{dents}\.png shows no contact"):
        seen_photos(photo_set(dents, weak), lambda circle, photo: photo.name)


def test_a_contact_that_was_given_is_not_left_out() -> None:
    """Its circle is wrong, and who wrote it is told."""
    given = ball_photo(9, dent=True, circle=Circle(column_px=5.0, row_px=5.0, radius_px=4.0))
    photos = photo_set(dents=7, weak=0)
    photos = dataclasses.replace(photos, photos=(*photos.photos, given))

    def located(circle: Circle, photo: BallPhoto) -> str:
        if photo.name == given.name:
            raise DesignError(f"{photo.name} is off the skin", hint="", at="")
        return photo.name

    with pytest.raises(DesignError, match=r"p9\.png is off the skin"):
        seen_photos(photos, located)


def test_drift_is_told_by_untouched_skin() -> None:
    """Gain 1.2 and offset -7 in one colour, with a contact and noise: a grey level remains."""
    random = np.random.default_rng(2)
    ramp = np.linspace(60.0, 180.0, WIDTH)[None, :, None] * np.ones((HEIGHT, 1, 3))
    change = dent_change(100, 75, 16)
    gain, offset = np.array([1.2, 1.0, 0.9]), np.array([-7.0, 0.0, 12.0])
    taken = (ramp + change) * gain + offset + random.normal(0.0, 1.0, ramp.shape)
    circle = Circle(column_px=100.0, row_px=75.0, radius_px=16.0)
    found = measured_drift(np.clip(taken, 0, 255).astype(np.uint8), ramp.astype(np.uint8), circle)
    back = found.applied(ramp)
    assert np.abs(back - (ramp * gain + offset)).mean() < 1.0
    assert found.gain == pytest.approx(gain, abs=0.03)


def test_the_box_of_a_contact_stays_inside() -> None:
    """1.45 times the circle, cut at the image's edge."""
    box = contact_box(Circle(column_px=10.0, row_px=75.0, radius_px=20.0), WIDTH, HEIGHT)
    assert box == (slice(46, 105), slice(0, 40))
