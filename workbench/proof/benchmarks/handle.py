"""A handle of the 3D view in headless Chromium: where on the page its upright arm stands."""

from __future__ import annotations

from typing import Any

import numpy as np

LEFT_DOCK_PX, RIGHT_DOCK_PX = 390, 355
BLUE_MARGIN = 50
"""How much more blue than red and green the upright arm of the handle is."""


def switch(page: Any, label: str) -> None:
    """Click a checkbox by its label."""
    found = page.locator("label[for]").filter(has_text=label).first
    page.locator(f'[id="{found.get_attribute("for")}"]').click(force=True)


def pixels(page: Any) -> np.ndarray:
    """The page as shown, shape (H, W, 3) of blue, green, red."""
    import cv2

    data = np.frombuffer(page.screenshot(), dtype=np.uint8)
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), dtype=np.int16)


def arm(before: np.ndarray, after: np.ndarray) -> tuple[int, int]:
    """Pixel of the tip of the handle's upright arm: the highest blue that was not there before."""
    blue, green, red = np.moveaxis(after, -1, 0)
    found = (np.abs(after - before).sum(axis=2) > 60) & (blue > red + BLUE_MARGIN)
    found &= blue > green + BLUE_MARGIN // 2
    # The docks are blue too.
    found[:, :LEFT_DOCK_PX] = found[:, -RIGHT_DOCK_PX:] = False
    rows, columns = np.nonzero(found)
    if not len(rows):
        raise ValueError("the handle is not on screen")
    top = int(rows.min())
    return int(np.median(columns[rows < top + 10])), top + 7
