"""Where tabs look from: a whole thing is framed, and parts put away give the view back."""

from __future__ import annotations

import contextlib
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ui.scene.views import RAISED, Mark, Views

LOW, HIGH = np.array([-10.0, -10.0, 0.0]), np.array([10.0, 10.0, 40.0])
MIDDLE = (LOW + HIGH) / 2
PLACE = (3.0, 4.0, 5.0)


def client() -> Any:
    """A tab that looks along -X."""
    camera = SimpleNamespace(position=(200.0, 0.0, 0.0), look_at=(0.0, 0.0, 0.0), aspect=1.0)
    return SimpleNamespace(camera=camera, atomic=contextlib.nullcontext)


class Page:
    """A server with tabs and a scene that takes everything."""

    def __init__(self) -> None:
        self.clients = {0: client()}
        self.initial_camera = SimpleNamespace()
        node = SimpleNamespace(remove=lambda: None)
        names = ("add_line_segments", "add_label", "add_icosphere")
        self.scene = SimpleNamespace(**{name: lambda *a, **k: node for name in names})

    def get_clients(self) -> dict[int, Any]:
        return self.clients


@pytest.fixture
def page() -> Page:
    return Page()


def test_parts_put_away_give_back_the_view_before_a_flight(page: Page) -> None:
    """A flight to a place of a part does not outlive the parts: the eye is at (200, 0, 0) again."""
    views = Views(page)
    views.step_back(LOW, HIGH)
    views.fly_to(PLACE, np.array([0.0, 1.0, 0.0]), 20.0, Mark("here"))
    assert views.close
    views.step_forward(LOW, HIGH)
    assert page.clients[0].camera.position == (200.0, 0.0, 0.0)
    assert not views.close


def test_a_tab_opened_among_parts_sees_the_sensor_when_they_go(page: Page) -> None:
    """Without a view of before, the tab looks at the middle of the sensor."""
    views = Views(page)
    views.step_back(LOW, HIGH)
    page.clients[1] = client()
    views.fly_to(PLACE, np.array([0.0, 1.0, 0.0]), 20.0, Mark("here"))
    views.step_forward(LOW, HIGH)
    assert page.clients[1].camera.look_at == pytest.approx(MIDDLE)
    assert page.clients[0].camera.look_at == (0.0, 0.0, 0.0)


def test_fit_keeps_the_side_one_looks_from(page: Page) -> None:
    """An eye on +X stays on +X, farther than half the diagonal, and looks below the middle."""
    views = Views(page)
    views.fit(LOW, HIGH)
    camera = page.clients[0].camera
    away = np.asarray(camera.position) - np.asarray(camera.look_at)
    assert camera.look_at[:2] == pytest.approx(MIDDLE[:2])
    # The timeline lies along the lower edge of the view.
    assert camera.look_at[2] == pytest.approx(MIDDLE[2] - RAISED * away[0])
    assert away[1:] == pytest.approx([0.0, 0.0])
    assert away[0] > np.linalg.norm(HIGH - LOW) / 2


def test_a_tab_that_opens_among_parts_sees_them_whole(page: Page) -> None:
    """It starts outside the ball around the parts; once they are gone, as after `frame`."""
    views = Views(page)
    views.frame(LOW, HIGH)
    before = page.initial_camera.position, page.initial_camera.look_at
    low, high = 3.0 * LOW, 3.0 * HIGH
    views.step_back(low, high)
    away = np.asarray(page.initial_camera.position) - (low + high) / 2
    assert np.linalg.norm(away) > np.linalg.norm(high - low) / 2
    views.step_forward(LOW, HIGH)
    assert (page.initial_camera.position, page.initial_camera.look_at) == before
