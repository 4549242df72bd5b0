"""Drop-downs over names that come and go."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ui.page.callbacks import put


def offer(handle: Any, names: Sequence[str], *, preferred: str = "") -> None:
    """Offer names in a drop-down; the one chosen stays where it still is among them."""
    now = preferred or handle.value
    if tuple(handle.options) != tuple(names):
        handle.options = tuple(names)
    wanted = now if now in names else names[0]
    put(handle, wanted)
