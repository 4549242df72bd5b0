"""Changes of an object by widgets: what stays, what shrinks, what is refused."""

from __future__ import annotations

import dataclasses
from collections import Counter

import numpy as np
import pytest

from workbench.core.base.errors import DesignError
from workbench.core.objects.kind import Group
from workbench.core.press.indenter import SEEN, UNSEEN, Indenter, IndenterKind
from workbench.core.press.texture import Pattern, Texture
from workbench.edit.indenter_edit import (
    another,
    edge_mm,
    gallery,
    gallery_heading,
    pictured,
    resized,
    rounded,
    uploaded,
)
from workbench.view.object_words import EVERYDAY, HEADINGS


def test_gallery_holds_every_object_once() -> None:
    """10 seen, 4 unseen, 14 as released with their sizes, other primitives, everyday objects."""
    names = gallery()
    assert names["sphere r27, 12 mm"] == "released_sphere_r27"
    under = Counter(gallery_heading(name) for name in names.values())
    assert under[HEADINGS[Group.RELEASED]] == 14
    assert under[HEADINGS[Group.SEEN]] == len(SEEN) == 10
    assert under[HEADINGS[Group.UNSEEN]] == len(UNSEEN) == 4
    assert under[EVERYDAY] == 3
    primitives = {kind.value for kind in IndenterKind if kind is not IndenterKind.MESH}
    assert primitives < set(names.values())
    assert {"mug", "screwdriver", "banana"} <= set(names.values())
    assert len(set(names.values())) == len(names)


def test_another_object_keeps_size_and_texture() -> None:
    """A sphere of 9 mm with waves becomes a cube of 9 mm with waves."""
    waves = Texture(pattern=Pattern.WAVES, height_mm=0.1)
    cube = another("cube", Indenter(size_mm=9.0, texture=waves))
    assert (cube.kind, cube.size_mm, cube.texture) == (IndenterKind.CUBE, 9.0, waves)


def test_a_released_head_has_its_own_size() -> None:
    """4 mm of the bar after a ball of 9 mm, and 6 mm of what is then chosen; textures stay."""
    waves = Texture(pattern=Pattern.WAVES, height_mm=0.1)
    bar = another("released_cube", Indenter(size_mm=9.0, texture=waves))
    assert (bar.size_mm, bar.texture) == (4.0, waves)
    assert another("released_hexagon", bar).size_mm == pytest.approx(7.1056)
    assert another("torus", bar).size_mm == 6.0


def test_a_small_object_has_smaller_edges() -> None:
    """A cross of 6 mm has edges of 0.45 mm; one of 2 mm at most 0.28 mm."""
    small = resized(another("cross", Indenter()), 2.0)
    assert edge_mm(small) == pytest.approx(0.28)


def test_a_mesh_is_scaled_and_rounded() -> None:
    """A mug of 40 mm is half of the one of 80 mm; its edges have a rounding of their own."""
    mug = another("mug", Indenter())
    half = resized(mug, mug.size_mm / 2)
    assert mug.mesh is not None
    assert half.mesh is not None
    np.testing.assert_allclose(half.mesh.points_mm, mug.mesh.points_mm / 2)
    assert edge_mm(rounded(half, 0.5)) == 0.5


def test_a_ball_has_no_edges_to_round() -> None:
    """The refusal names the field."""
    with pytest.raises(DesignError, match="no edges") as caught:
        rounded(Indenter(), 0.3)
    assert caught.value.at == "indenter.edge_radius_mm"
    assert edge_mm(Indenter()) == 0.0


def test_files_are_read_by_their_ending() -> None:
    """A triangle is no closed mesh, and a text no picture: both are refused with a remedy."""
    triangle = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    with pytest.raises(DesignError):
        uploaded("open.obj", triangle)
    with pytest.raises(DesignError, match="picture"):
        pictured(Indenter(), "photo.png", b"no picture")


def test_a_picture_becomes_the_texture() -> None:
    """A black and white PNG stands across the whole object."""
    import cv2

    ok, data = cv2.imencode(".png", np.array([[0, 255], [255, 0]] * 8, np.uint8))
    assert ok
    base = dataclasses.replace(Indenter(), size_mm=8.0)
    shaped = pictured(base, "checks.png", data.tobytes())
    assert shaped.texture.pattern is Pattern.IMAGE
    assert shaped.texture.pitch_mm == 8.0
