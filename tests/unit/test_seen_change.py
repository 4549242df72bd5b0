"""What is found of a frame's change is found once, and is what a fresh look finds."""

from __future__ import annotations

import numpy as np
import pytest

import ui.panels.results.seen_change as seen_change
from tests.unit.test_close_up import frames
from ui.panels.results.seen_change import SeenChange
from workbench.view.close_up import contact_window
from workbench.view.image_views import visible_change


def test_frames_that_are_played_again_are_not_looked_at_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two frames, each played three times: two looks; other images are looked at anew."""
    looks: list[int] = []

    def counted(given: object, number: int) -> object:
        looks.append(number)
        return contact_window(given, number)  # pyright: ignore[reportArgumentType]

    monkeypatch.setattr(seen_change, "contact_window", counted)
    shot = frames(slice(40, 60), slice(70, 90))
    change = SeenChange()
    for _ in range(2):
        change.take([(np.asarray(shot.rgb), shot)])
        looks.clear()
        found = [change.of(0, number) for number in (0, 1, 0, 1, 0, 1)]
        assert looks == [0, 1]
    assert found[1].window == contact_window(shot, 1)
    assert found[1].gain == visible_change(shot.rgb[1], shot.rgb[0])[1]
    assert found[0].unseen == found[1].unseen == ""


def test_images_without_fields_have_no_close_up() -> None:
    """A live press: the gain is known, and why nothing is seen; there is no place of a contact."""
    images = np.full((2, 12, 16, 3), 90, np.uint8)
    change = SeenChange()
    change.take([(images, None)])
    found = change.of(0, 1)
    assert found.window is None
    assert found.gain == 1
    assert found.unseen.startswith("no change seen")
