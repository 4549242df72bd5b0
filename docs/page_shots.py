"""Screenshots of the workbench's page, and the hands that its tests do not need."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2  # noqa: TID253 (a program of its own, not part of the package)
import numpy as np

from tests.ui.page_faults import quiet
from tests.ui.widgets import control, press, wait_until

FOLDER = Path(__file__).parent / "screens"
SIZE = {"width": 1440, "height": 900}
MOST_BYTES, QUALITIES = 200_000, (85, 75, 65, 55, 45)
LONG_S = 600
ASIDE = (720, 60)
"""A place of the page where there is nothing to point at."""


def shoot(page: Any, name: str, *, aside: bool = True) -> None:
    """One screenshot, once the 3D view has caught up, in the best quality that is small enough."""
    page.wait_for_timeout(5_000)
    if aside:
        # Neither notifications nor the hint of the widget that was clicked last.
        quiet(page)
        page.mouse.move(*ASIDE)
        page.wait_for_timeout(1_000)
    data = np.frombuffer(page.screenshot(), dtype=np.uint8)
    image = cv2.imdecode(data, cv2.IMREAD_COLOR)
    assert image is not None
    for quality in QUALITIES:
        done, encoded = cv2.imencode(".webp", image, [cv2.IMWRITE_WEBP_QUALITY, quality])
        if done and len(encoded) < MOST_BYTES:
            break
    else:
        raise SystemExit(f"{name} is larger than {MOST_BYTES} bytes")
    (FOLDER / f"{name}.webp").write_bytes(encoded.tobytes())
    print(f"{name}: {len(encoded) / 1e3:.0f} kB", flush=True)


def tick(page: Any, label: str) -> None:
    """Tick a box, or take its tick away."""
    box = control(page, label)
    box.scroll_into_view_if_needed()
    box.click(force=True)


def fresh(page: Any, stage: str) -> None:
    """Until a stage is up to date."""
    wait_until(lambda: page.get_by_text(f"{stage} ✓").count(), LONG_S, f"{stage} is up to date")


def pressed(page: Any) -> None:
    """Until the image is up to date; asked for where nothing computes it already.

    A store that has results of other designs starts no first press of its own.
    """
    page.wait_for_timeout(5_000)
    if page.get_by_text("Image ○").count():
        press(page, "Update results")
    fresh(page, "Image")


def command(page: Any, name: str) -> None:
    """Run a command of the palette."""
    page.keyboard.press("Control+k")
    page.get_by_placeholder("Search commands").fill(name)
    page.keyboard.press("Enter")


def number(page: Any, label: str, value: float) -> None:
    """Type into a box without a slider."""
    box = control(page, label)
    box.fill(str(value))
    box.press("Tab")
