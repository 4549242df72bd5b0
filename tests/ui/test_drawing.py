"""How a browser without a graphics card draws the 3D view."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import tab, wait_until
from ui.patches.software_drawing import CALM_MS, FINE, HEARTBEAT_MS

pytestmark = [pytest.mark.ui, pytest.mark.slow]

DRAWN = """() => {
  const state = window.__viserMutable.scene.__r3f.root.getState(), canvas = state.gl.domElement;
  return [state.gl.getContextAttributes().antialias, canvas.width / canvas.clientWidth];
}"""
"""Whether edges are smoothed by samples, and pixels per pixel of the page."""

COUNT = """() => {
  const gl = window.__viserMutable.scene.__r3f.root.getState().gl, draw = gl.render.bind(gl);
  window.drawings = 0;
  gl.render = (...given) => { window.drawings++; draw(...given); };
}"""


def test_pixels_are_fine_at_rest_and_coarse_in_motion(
    browser: Any, start_server: Any, pressed_project: Path
) -> None:
    """No samples anywhere; half again as many pixels as the page has once nothing moves, no more
    than it has while the eye turns, and fine again after it; then nothing is drawn at all."""
    server: Server = start_server(pressed_project)
    page = browser.new_page(viewport={"width": 900, "height": 600})
    page.goto(server.url)
    tab(page, "Shape").wait_for()

    def fine() -> bool:
        smoothed, share = page.evaluate(DRAWN)
        assert smoothed is False
        return share == pytest.approx(FINE, rel=0.01)

    wait_until(fine, 60, "the view at rest is fine")
    page.mouse.move(450, 250)
    page.mouse.down()
    page.mouse.move(480, 260, steps=3)
    smoothed, share = page.evaluate(DRAWN)
    assert smoothed is False and share < 1.01
    page.mouse.up()
    wait_until(fine, 30, "it is fine again")

    page.wait_for_timeout(CALM_MS + 2 * HEARTBEAT_MS)
    page.evaluate(COUNT)
    page.wait_for_timeout(4 * HEARTBEAT_MS)
    assert page.evaluate("window.drawings") == 0, "nothing has changed"
    page.mouse.move(450, 250)
    page.mouse.wheel(0, 100)
    wait_until(lambda: page.evaluate("window.drawings") > 0, 10, "the eye moves")
    page.close()
