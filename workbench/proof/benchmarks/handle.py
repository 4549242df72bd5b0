"""A handle of the 3D view in headless Chromium: where on the page its upright arm stands."""

from __future__ import annotations

from typing import Any

import numpy as np

LEFT_DOCK_PX, RIGHT_DOCK_PX = 390, 355
HOVER_MS, MOST_HOVERS = 500, 20
"""Between two looks whether the arm under the mouse has another colour, and how many."""
BLUE_MARGIN = 50
"""How much more blue than red and green the upright arm of the handle is."""


def switch(page: Any, label: str) -> None:
    """Click a checkbox by its label."""
    found = page.locator("label[for]").filter(has_text=label).first
    page.locator(f'[id="{found.get_attribute("for")}"]').click(force=True)


def hold(page: Any, x: int, y: int) -> None:
    """Move the mouse over an arm of a handle, and press its button once the page knows of it.

    A slow page finds out late, and would else turn the eye. An arm under the mouse is not blue.

    Raises:
        ValueError: If the page does not find out.
    """
    for number in range(MOST_HOVERS):
        page.mouse.move(x, y + number % 2)
        page.wait_for_timeout(HOVER_MS)
        if not _blue(pixels(page)[y - 1 : y + 3, x - 1 : x + 2]).any():
            page.mouse.down()
            return
    raise ValueError("the handle does not feel the mouse")


def _blue(seen: np.ndarray) -> np.ndarray:
    """Which pixels of (H, W, 3) are as blue as the upright arm, (H, W) bool."""
    blue, green, red = np.moveaxis(seen, -1, 0)
    return (blue > red + BLUE_MARGIN) & (blue > green + BLUE_MARGIN // 2)


def pixels(page: Any) -> np.ndarray:
    """The page as shown, shape (H, W, 3) of blue, green, red."""
    import cv2

    data = np.frombuffer(page.screenshot(), dtype=np.uint8)
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), dtype=np.int16)


def arm(before: np.ndarray, after: np.ndarray) -> tuple[int, int]:
    """Pixel of the tip of the handle's upright arm: the highest blue that was not there before."""
    found = (np.abs(after - before).sum(axis=2) > 60) & _blue(after)
    # The docks are blue too.
    found[:, :LEFT_DOCK_PX] = found[:, -RIGHT_DOCK_PX:] = False
    rows, columns = np.nonzero(found)
    if not len(rows):
        raise ValueError("the handle is not on screen")
    top = int(rows.min())
    return int(np.median(columns[rows < top + 10])), top + 7
