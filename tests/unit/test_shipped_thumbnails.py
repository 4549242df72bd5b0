"""Every card of a gallery has a thumbnail, of what it starts from today."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from workbench.edit.forms import choices
from workbench.edit.indenter_edit import gallery
from workbench.edit.shipped_thumbnails import object_key, shipped_keys, shipped_thumbnail, start_key

STARTS = tuple(f"start-{name}" for name in choices())
OBJECTS = tuple(f"object-{name}" for name in gallery().values())


@pytest.mark.parametrize("name", [*STARTS, *OBJECTS])
def test_every_card_has_a_thumbnail(name: str) -> None:
    """144 x 144 with a clear ground, something drawn on at least a tenth of it."""
    data = shipped_thumbnail(name)
    assert data is not None
    thumbnail = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    assert thumbnail.shape == (144, 144, 4)
    drawn = thumbnail[..., 3] > 128
    assert 0.1 < drawn.mean() < 0.95


def test_thumbnails_are_of_todays_bodies_and_objects() -> None:
    """The keys beside the thumbnails are those of today; else run docs/thumbnails.py."""
    now = {f"start-{name}": start_key(name) for name in choices()}
    now |= {f"object-{name}": object_key(name) for name in gallery().values()}
    assert shipped_keys() == now
