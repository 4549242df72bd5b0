"""Pictures of designs look alike in galleries: one ground, and of a variant its membrane alone."""

from __future__ import annotations

import cv2
import numpy as np

from ui.page.gallery import Card, cards_html
from workbench.report.image_files import png_bytes
from workbench.report.thumbnails import GROUND, TILE_PX, first_tile


def test_the_first_of_three_is_taken() -> None:
    """Red, green, blue side by side: red is left, of one tile, and what is no picture stays."""
    tiles = [np.full((TILE_PX, TILE_PX, 3), colour, np.uint8) for colour in np.eye(3) * 255]
    tile = cv2.imdecode(np.frombuffer(first_tile(png_bytes(np.hstack(tiles))), np.uint8), 1)
    assert tile is not None and tile.shape == (TILE_PX, TILE_PX, 3)
    assert (tile == (0, 0, 255)).all()
    assert first_tile(b"no picture") == b"no picture"


def test_all_have_the_ground_of_compare() -> None:
    """Those with a clear ground of their own, and those without."""
    clear = cv2.imencode(".png", np.zeros((4, 4, 4), np.uint8))[1].tobytes()
    opaque = png_bytes(np.full((4, 4, 3), GROUND, np.uint8))
    page = cards_html([Card(name="ships", png=clear), Card(name="own", png=opaque)])
    assert page.count("background:rgb(244,243,241)") == 2
