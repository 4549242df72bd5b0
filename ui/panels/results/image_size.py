"""How large the tactile image is shown: in its dock, beside the 3D view, or over the whole page.

Small and large are widths of the dock, the same in all tabs; its edge can be dragged to any other,
and the image is as wide as the dock. The whole page is one tab's own.
"""

from __future__ import annotations

from typing import Any

from ui.desk.desk import Desk
from ui.desk.signal import Signal
from ui.patches.image_click import script_in_html
from ui.patches.image_zoom import FILL_PAGE

SMALL_PX = 350
LARGE_PX = 600
"""On a page of 1280 pixels 330 of them are left to the 3D view."""
SMALL, LARGE = "Small", "Large"
HINT = "Or drag the dock's edge. I: small or large; W: over the whole page"


class ImageSize:
    """A row of buttons and two keys."""

    def __init__(self, desk: Desk, dock: Any) -> None:
        self.desk = desk
        self.dock = dock
        self.large = False
        self.sized: Signal[[bool]] = Signal()
        """Told whether the image is large, and little room is left to the 3D view."""
        self._scripts: dict[int, Any] = {}
        """What was last laid into a tab, by its number."""
        gui, guarded = desk.server.gui, desk.guarded
        self.sizes = gui.add_button_group("Image size", (SMALL, LARGE), hint=HINT)
        self.sizes.on_click(guarded(lambda event: self.widen(self.sizes.value == LARGE)))
        command = gui.add_command("Image small or large", hotkey="I")
        command.on_trigger(guarded(lambda event: self.widen(not self.large)))
        command = gui.add_command("Image over the whole page", hotkey="W")
        command.on_trigger(guarded(lambda event: self.fill(event.client)))
        desk.server.on_client_disconnect(self._left)
        self.widen(False)

    def widen(self, large: bool) -> None:
        """Give the dock one of its two widths."""
        self.large = large
        self.dock.set_width(LARGE_PX if large else SMALL_PX)
        self.sized(large)

    def fill(self, client: Any) -> None:
        """Show the image over the whole page of a tab, or end that."""
        if client is None:
            return
        before = self._scripts.pop(client.client_id, None)
        if before is not None:
            before.remove()
        self._scripts[client.client_id] = client.gui.add_html(script_in_html(FILL_PAGE))

    async def _left(self, client: Any) -> None:
        self._scripts.pop(client.client_id, None)
