"""Textures raise the lower side by their height, and what cannot be resolved is refused."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from geometry.surface.primitives import rounded_box
from geometry.surface.surface import is_watertight, mesh_volume
from sim.contact.objects import textures
from sim.contact.objects.collider import make_collider
from sim.contact.objects.object_measures import exact_distance
from workbench.core.base.errors import DesignError
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.press.texture import STEEPEST, HeightImage, Pattern, Texture
from workbench.edit.indenter_choice import choose_texture
from workbench.live.indenter_display import display_mesh

SPACING_MM = 0.2
STEPS = HeightImage(heights=np.kron([[0.0, 1.0], [1.0, 0.0]], np.ones((20, 20))))
TEXTURES = {
    "waves": Texture(pattern=Pattern.WAVES),
    "grid": Texture(pattern=Pattern.GRID),
    "dots": Texture(pattern=Pattern.DOTS),
    "letters": Texture(pattern=Pattern.LETTERS, text="R", pitch_mm=3.0),
    "image": Texture(pattern=Pattern.IMAGE, image=STEPS, pitch_mm=4.0),
}


def lowest(function, place: np.ndarray) -> np.ndarray:
    """Height of the lower surface at places (N, 2), by bisection from below."""
    low, high = np.full(len(place), -4.0), np.full(len(place), -1.0)
    for _ in range(40):
        middle = 0.5 * (low + high)
        outside = function(np.column_stack([place, middle])) > 0.0
        low, high = np.where(outside, middle, low), np.where(outside, high, middle)
    return low


def plan(count: int = 800) -> np.ndarray:
    return np.random.default_rng(4).uniform(-2.2, 2.2, (count, 2))


@pytest.mark.parametrize("name", TEXTURES)
def test_lower_side_of_a_cube_is_lowered_by_the_heights(name: str) -> None:
    """The face at z = -3 comes to -3 - h(x, y); crests reach the height, valleys nothing."""
    texture = TEXTURES[name]
    collider = make_collider(Indenter(kind=IndenterKind.CUBE, texture=texture), grid_mm=0.5)
    place = plan()
    height = textures.heights(texture, SPACING_MM)(place)
    found = lowest(lambda p: collider.distance(p)[0], place)
    # Strokes are 0.96 mm wide, five samples: their creases where two meet are smoothed by 0.03.
    bound = 0.035 if name == "letters" else 0.015
    assert np.abs(found + 3.0 + height).max() < bound
    assert height.min() == pytest.approx(0.0, abs=0.01)
    # The filter of an image, 0.3 mm, leaves little of the rise of a step 2 mm wide.
    assert height.max() == pytest.approx(texture.height_mm, rel=0.05)
    assert collider.half_height_mm == 3.2


@pytest.mark.parametrize("kind", [IndenterKind.CUBE, IndenterKind.SPHERE, IndenterKind.FLOWER])
def test_textured_distance_is_a_distance(kind: IndenterKind) -> None:
    """Slope 1 within half a millimetre outside, in the median to 1e-3, below 1.1 in 19 of 20."""
    collider = make_collider(Indenter(kind=kind, texture=TEXTURES["waves"]), grid_mm=0.5)
    where = np.random.default_rng(2).uniform(-4.0, 4.0, (6000, 3))
    distance, gradient = collider.distance(where)
    slope = np.linalg.norm(gradient, axis=1)[(distance > 0.0) & (distance < 0.5)]
    assert np.median(slope) == pytest.approx(1.0, abs=2e-3)
    assert np.percentile(slope, 95) < 1.1


def test_upper_side_and_flanks_stay() -> None:
    """The upper face of a cube is still at z = 3, the sides at x = 3; the texture is below."""
    collider = make_collider(
        Indenter(kind=IndenterKind.CUBE, texture=TEXTURES["dots"]), grid_mm=0.5
    )
    place = plan(200)
    above = np.column_stack([place, np.full(200, 3.0)])
    beside = np.column_stack([np.full(200, 3.0), place])
    assert np.abs(collider.distance(above)[0]).max() < 5e-3
    assert np.abs(collider.distance(beside)[0]).max() < 5e-3


@pytest.mark.parametrize("name", TEXTURES)
def test_texture_is_shown(name: str) -> None:
    """The shown mesh is closed, bulkier than the smooth one, and within 0.05 mm of the felt one."""
    texture = TEXTURES[name]
    indenter = Indenter(kind=IndenterKind.CYLINDER_END, texture=texture)
    points, faces = display_mesh(indenter)
    assert is_watertight(faces)
    smooth = mesh_volume(*display_mesh(Indenter(kind=IndenterKind.CYLINDER_END)))
    assert smooth + 0.3 < mesh_volume(points, faces) < smooth + 0.2 * np.pi * 9.0
    felt = np.abs(make_collider(indenter, grid_mm=0.5).distance(points)[0])
    assert np.percentile(felt, 99) < 0.05


def test_mesh_takes_a_texture(taichi_device: str) -> None:
    """A box mesh with waves is felt as the textured cube, and shown with its lower side moved."""
    points, faces = rounded_box(3.0, 0.0)
    mesh = IndenterMesh(points_mm=points, faces=faces)
    indenter = Indenter(kind=IndenterKind.MESH, mesh=mesh, texture=TEXTURES["waves"])
    collider, place = make_collider(indenter, grid_mm=0.5), plan()
    exact = -3.0 - textures.heights(TEXTURES["waves"], SPACING_MM)(place)
    found = lowest(lambda p: collider.distance(p)[0], place)
    assert np.abs(found - exact).max() < 5e-3
    shown, shown_faces = display_mesh(indenter)
    assert is_watertight(shown_faces)
    assert shown[:, 2].min() == pytest.approx(-3.2, abs=1e-3)
    assert shown[:, 2].max() == pytest.approx(3.0)


def test_displaced_surface_is_the_zero_of_the_textured_function() -> None:
    """Places of a sphere, moved, lie on the textured sphere to 1e-12, the upper half included."""
    field = textures.heights(TEXTURES["dots"], SPACING_MM)
    body = exact_distance(Indenter())
    direction = np.random.default_rng(1).normal(size=(500, 3))
    surface = 3.0 * direction / np.linalg.norm(direction, axis=1, keepdims=True)
    moved = textures.displaced(surface, field, 3.0)
    assert np.abs(textures.textured(body, field, 3.0)(moved)).max() < 1e-12


def test_letters_read_rightly_along_plus_z() -> None:
    """An L seen along +Z, +Y up: its upright is on the left, which is +X; its foot is below."""
    texture = Texture(pattern=Pattern.LETTERS, text="L", pitch_mm=4.0)
    field = textures.heights(texture, SPACING_MM)
    lines = np.linspace(-3.0, 3.0, 121)
    x, y = np.meshgrid(lines, lines, indexing="ij")
    height = field(np.stack([x.ravel(), y.ravel()], axis=1)).reshape(x.shape)
    raised = height > 0.5 * texture.height_mm
    upper, lower = raised & (y > 0.5), raised & (y < -0.5)
    assert x[upper].mean() > 0.5
    assert x[lower].mean() < x[upper].mean() - 0.3
    assert np.ptp(y[raised]) == pytest.approx(4.0 + 0.16 * 4.0, abs=0.15)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"pattern": Pattern.WAVES, "height_mm": 1.0}, r"slope of 1\.57; the limit is 1\.5"),
        ({"pattern": Pattern.DOTS, "pitch_mm": 0.2}, "slope of"),
        ({"pattern": Pattern.LETTERS, "pitch_mm": 3.0}, "says ''"),
        ({"pattern": Pattern.LETTERS, "pitch_mm": 3.0, "text": "naïve"}, "plain characters"),
        ({"pattern": Pattern.IMAGE}, "needs an image"),
        ({"pattern": Pattern.WAVES, "image": STEPS}, "takes no image"),
        ({"pattern": Pattern.WAVES, "height_mm": -0.1}, "outside 0 to 5 mm"),
    ],
)
def test_impossible_textures_are_refused(change: dict, says: str) -> None:
    """Each with a remedy, at its field."""
    with pytest.raises(DesignError, match=says) as caught:
        Texture(**change)
    assert caught.value.at.startswith("indenter.texture")
    assert caught.value.hint


def test_remedy_of_a_steep_texture_holds() -> None:
    """The pitch that the message names is accepted: slope pi H / P at the limit."""
    assert Texture(pattern=Pattern.WAVES, height_mm=1.0, pitch_mm=2.1).slope < STEEPEST


def test_contact_feels_too_fine_ridges_as_a_layer_of_their_mean() -> None:
    """Waves of 0.5 mm are 0.5 mm wide; samples of 0.2 mm hold 0.8 mm, of 0.1 mm 0.4 mm.

    The face of a cube at z = -3 then comes to -3.05, half the height.
    """
    fine = Texture(pattern=Pattern.WAVES, height_mm=0.1, pitch_mm=0.5)
    cube = Indenter(kind=IndenterKind.CUBE, texture=fine)
    place = plan(200)
    coarse, close = (make_collider(cube, grid_mm=grid_mm) for grid_mm in (0.5, 0.25))
    assert np.abs(lowest(lambda p: coarse.distance(p)[0], place) + 3.05).max() < 1e-3
    assert np.ptp(lowest(lambda p: close.distance(p)[0], place)) > 0.08
    # No crest is there whose radius contact would have to resolve.
    assert coarse.least_radius_mm == cube.edge_radius_mm
    assert coarse.half_height_mm == 3.1


def test_contact_feels_too_fine_letters_filtered() -> None:
    """An upright through a Gaussian of 0.3 mm, as its section convolved with one."""
    fine = Texture(pattern=Pattern.LETTERS, text="I", height_mm=0.05, pitch_mm=1.0)
    x = np.linspace(-2.0, 2.0, 401)
    place = np.column_stack([x, np.zeros(401)])
    felt, true = textures.heights(fine, SPACING_MM)(place), textures.true_heights(fine)(place)
    bell = np.exp(-0.5 * (x / 0.3) ** 2)
    smooth = np.convolve(true, bell / bell.sum(), mode="same")
    # Letters are drawn with 40 pixels for contact, and end 0.5 mm above and below: 10 % is lost.
    assert np.abs(felt - smooth).max() < 0.2 * smooth.max()
    assert true.max() == pytest.approx(0.05, rel=0.02)


def test_ridges_that_no_image_shows_are_refused() -> None:
    """Strokes of letters 0.15 mm high are 0.048 mm wide; images show 0.05 mm."""
    fine = Texture(pattern=Pattern.LETTERS, text="A", height_mm=0.01, pitch_mm=0.15)
    with pytest.raises(DesignError, match=r"neither contact nor image shows less") as caught:
        make_collider(Indenter(texture=fine), grid_mm=0.5)
    assert caught.value.hint == "raise the pitch to 0.16 mm"
    assert caught.value.at == "indenter.texture.pitch_mm"


def test_a_step_of_a_picture_rises_with_the_steepest_slope() -> None:
    """0.2 mm high, with pixels of 0.02 mm: 1.5, the limit, along its edges; more at a corner."""
    step = HeightImage(heights=np.repeat([[0.0] * 100 + [1.0] * 100], 200, axis=0))
    picture = Texture(pattern=Pattern.IMAGE, image=step, pitch_mm=4.0, height_mm=0.2)
    line = np.column_stack([np.linspace(-0.5, 0.5, 2001), np.zeros(2001)])
    slope = np.abs(np.diff(textures.true_heights(picture)(line))) / 5e-4
    # Linear interpolation between pixels of 0.01 mm.
    assert slope.max() == pytest.approx(STEEPEST, rel=0.03)


def test_steep_image_is_refused() -> None:
    """A step of 0.6 mm filtered by 0.3 mm rises by 0.6 / 0.3 / sqrt(2 pi) = 0.8 to 1.1 at a corner;

    of 1.2 mm by twice that.
    """
    steep = Texture(pattern=Pattern.IMAGE, image=STEPS, pitch_mm=4.0, height_mm=1.2)
    with pytest.raises(DesignError, match="texture image rises with a slope of"):
        textures.heights(steep, SPACING_MM)


def test_texture_must_be_lower_than_a_tenth_of_the_object() -> None:
    """6 mm carry 0.6 mm."""
    tall = Texture(pattern=Pattern.WAVES, height_mm=0.7, pitch_mm=4.0)
    with pytest.raises(DesignError, match=r"texture height 0\.7 mm is outside 0 to 0\.6 mm"):
        Indenter(texture=tall)


def test_textures_as_typed(tmp_path: Path) -> None:
    """PATTERN, PATTERN:HEIGHT:PITCH, letters=TEXT, and a picture whose white is 1."""
    assert choose_texture("dots") == Texture(pattern=Pattern.DOTS)
    waves = Texture(pattern=Pattern.WAVES, height_mm=0.1, pitch_mm=1.5)
    assert choose_texture("waves:0.1:1.5") == waves
    assert choose_texture("letters=A B:0.1").text == "A B"
    path = tmp_path / "dot.png"
    cv2.imwrite(str(path), np.array([[0, 255], [128, 0]], np.uint8))
    image = choose_texture(f"{path}:0.1:8").image
    assert image is not None
    np.testing.assert_allclose(image.heights, [[0.0, 1.0], [128 / 255, 0.0]])


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("wave", "there is no texture 'wave'"),
        ("waves:x", "expected PATTERN"),
        ("waves:1:2:3", "expected PATTERN"),
        ("gone.png", "not a picture"),
        ("letters", "there is no texture 'letters'"),
    ],
)
def test_textures_typed_wrongly(words: str, says: str) -> None:
    """What is wrong is named, with a remedy."""
    with pytest.raises(DesignError, match=says) as caught:
        choose_texture(words)
    assert caught.value.hint
