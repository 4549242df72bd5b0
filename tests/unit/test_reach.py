"""The slider of the section reaches all that is on show, and remembers the sensor's place."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from ui.scene.reach import Reach
from workbench.view.section_cut import Axis


@pytest.fixture
def slider() -> Any:
    return SimpleNamespace(min=-20.0, max=20.0, value=5.0)


def test_the_range_covers_parts_that_move_apart_and_comes_back(slider: Any) -> None:
    """A cut at 5 mm moves to 60 mm among parts up to 80 mm; with the sensor it is at 5 mm again."""
    reach = Reach(slider)
    reach.fit(-40.0, 50.0, axis=Axis.Z, parts=True)
    reach.fit(-70.0, 80.0, axis=Axis.Z, parts=True)
    assert (slider.min, slider.max, slider.value) == (-70.0, 80.0, 5.0)
    slider.value = 60.0
    reach.fit(-20.0, 20.0, axis=Axis.Z, parts=False)
    assert (slider.min, slider.max, slider.value) == (-20.0, 20.0, 5.0)


def test_a_place_on_another_axis_does_not_come_back(slider: Any) -> None:
    """The cut was at 5 mm along Y; along Z it stays as near as the sensor reaches."""
    reach = Reach(slider)
    reach.fit(-70.0, 80.0, axis=Axis.Y, parts=True)
    slider.value = 60.0
    reach.fit(-20.0, 20.0, axis=Axis.Z, parts=False)
    assert slider.value == 20.0


def test_a_range_without_width_is_not_taken(slider: Any) -> None:
    """A slider needs an extent: that of before stays."""
    Reach(slider).fit(3.0, 3.0, axis=Axis.Y, parts=False)
    assert (slider.min, slider.max, slider.value) == (-20.0, 20.0, 5.0)
