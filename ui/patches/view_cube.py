"""A cube in the corner of the 3D view that turns with the eye; a click on a face looks from there.

viser draws nothing over its view and knows no cube. Each tab has a piece of HTML of its own, told
where the tab looks from ten times a second at most and only while it turns; a script lays it over
the view, above the timeline. A face presses the key of its side, so that keyboard, palette and cube
go one way.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ui.patches.image_click import script_in_html
from workbench.core.base.poses import rotations

HALF_PX = 20.0
"""Half an edge of the cube."""
ROOM_PX = 96
"""Width and height of the place that it turns in."""
AXIS_SHARE = 1.55
"""How far the axes reach beyond the cube's corner, over an edge."""
AXES = (("X", "#ff6b6b"), ("Y", "#51cf66"), ("Z", "#74a9ff"))
Vector = tuple[float, float, float]
FACES: dict[str, tuple[Vector, Vector]] = {
    "Front": ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "Right": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "Top": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    "Back": ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "Left": ((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "Bottom": ((0.0, 0.0, -1.0), (0.0, -1.0, 0.0)),
}
"""Outward normal and upward direction of the word on each face."""
SEEN = 0.05
"""Least cosine between a face and the way to the eye at which it is drawn."""
INSTALL = """
document.querySelectorAll('.view-cube').forEach(old => old.remove());
clearInterval(window.viewCubeTimer);
(() => {
  const cube = document.createElement('div');
  cube.className = 'view-cube';
  document.body.append(cube);
  const place = () => {
    const canvas = document.querySelector('canvas');
    const around = canvas && canvas.getBoundingClientRect();
    cube.hidden = !around || around.width < 3 * ROOM || !cube.innerHTML;
    if (cube.hidden) return;
    const bars = [...document.querySelectorAll('[role=tab]')]
      .filter(tab => tab.textContent.trim() === 'Timeline' && tab.offsetParent)
      .map(tab => tab.getBoundingClientRect().top - 20).filter(y => y > around.top + 2 * ROOM);
    cube.style.left = `${around.left + 6}px`;
    cube.style.top = `${Math.min(around.bottom, ...bars) - ROOM - 6}px`;
  };
  cube.addEventListener('click', event => {
    const face = event.target.closest('[data-key]');
    if (face) document.body.dispatchEvent(new KeyboardEvent('keydown',
      {key: face.dataset.key, code: `Digit${face.dataset.key}`, bubbles: true}));
  });
  window.showViewCube = () => {
    const now = [...document.querySelectorAll('.view-cube-now')].pop();
    if (now) cube.innerHTML = now.innerHTML;
    place();
  };
  window.viewCubeTimer = setInterval(place, 500);
  window.showViewCube();
})();
""".replace("ROOM", str(ROOM_PX))
"""Installs the place over the view, instead of one of an earlier page of the same server."""


class ViewCube:
    """The cubes of all tabs of a server."""

    def __init__(self, server: Any, keys: Mapping[str, str]) -> None:
        self.keys = keys
        """Key of each face by its word."""
        self._cubes: dict[int, Any] = {}
        self._turned: dict[int, tuple[float, ...]] = {}
        """Where tabs look from that have turned since they were told."""
        server.on_client_connect(self._begin)
        server.on_client_disconnect(lambda client: self._end(client.client_id))

    def _begin(self, client: Any) -> None:
        # Of a tab's own, at the root: what stands in a closed tab of the dock is not in the page.
        client.gui.add_html(script_in_html(INSTALL))
        self._cubes[client.client_id] = client.gui.add_html("")

        @client.camera.on_update
        async def _(camera: Any) -> None:
            # On the event loop and many times a second: nothing but the newest is kept.
            self._turned[client.client_id] = tuple(float(part) for part in camera.wxyz)

    def _end(self, tab: int) -> None:
        self._cubes.pop(tab, None)
        self._turned.pop(tab, None)

    def turn(self) -> None:
        """Tell tabs that have turned."""
        for tab in list(self._turned):
            wxyz, cube = self._turned.pop(tab, None), self._cubes.get(tab)
            if wxyz is not None and cube is not None:
                shown = cube_html(np.array(wxyz), self.keys)
                if cube.content != shown:
                    cube.content = shown


def cube_html(wxyz: np.ndarray, keys: Mapping[str, str]) -> str:
    """The cube as an eye sees it, without perspective.

    Args:
        wxyz: Turn of the camera in the world, x to its right, y down, z forward, shape (4,).
        keys: Key of each face by its word.
    """
    to_page = page_axes(wxyz)
    middle = ROOM_PX / 2
    corner = to_page @ (-HALF_PX * np.ones(3))
    lines = ""
    for (letter, colour), way in zip(AXES, to_page.T, strict=True):
        end = corner + 2 * HALF_PX * AXIS_SHARE * way
        lines += (
            f'<line x1="{middle + corner[0]:.1f}" y1="{middle + corner[1]:.1f}" '
            f'x2="{middle + end[0]:.1f}" y2="{middle + end[1]:.1f}" stroke="{colour}"/>'
            f'<text x="{middle + end[0]:.1f}" y="{middle + end[1]:.1f}" fill="{colour}">'
            f"{letter}</text>"
        )
    faces = ""
    for word, (normal, up) in FACES.items():
        away = to_page @ normal
        if away[2] <= SEEN:
            continue
        across, down = to_page @ np.cross(up, normal), to_page @ np.negative(up)
        columns = [*across, 0, *down, 0, *away, 0, *(HALF_PX * away), 1]
        matrix = ",".join(f"{value:.3f}" for value in columns)
        key = keys[word]
        faces += (
            f'<button type="button" data-key="{key}" style="transform:matrix3d({matrix})" '
            f'title="Look from: {word} ({key})">{word}</button>'
        )
    shown = f'<svg width="{ROOM_PX}" height="{ROOM_PX}">{lines}</svg>{faces}'
    tell = script_in_html("window.showViewCube && window.showViewCube()")
    return f'<div class="view-cube-now" style="display:none">{shown}</div>{tell}'


def page_axes(wxyz: np.ndarray) -> np.ndarray:
    """Turns vectors of the world into the page's: right, down, toward the reader, shape (3, 3)."""
    camera = rotations(wxyz / np.linalg.norm(wxyz))
    return np.diag([1.0, 1.0, -1.0]) @ camera.T
