"""Clicks on a node of the 3D view, and the mouse that rests over it, which viser does not tell.

Where the place under the mouse is wanted, the page clicks there by itself once the mouse has rested
(`ui.patches.image_click`), with keys held that no hand holds: only nodes that listen here take it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

RESTS = "cmd/ctrl+alt+shift"
"""Keys held in a click that the page makes for a mouse that rests, as viser calls them."""


def listen(node: Any, on_click: Callable[[Any], None]) -> None:
    """Tell of clicks on a node and of the mouse over it; `rests` tells which one it was."""
    node.on_click(on_click)
    node.on_click(modifier=RESTS)(on_click)


def rests(event: Any) -> bool:
    """Whether the mouse only rests there."""
    return event.modifier == RESTS
