"""Bringing stale results up to date: on a button, or by itself once edits have settled.

Only the results a designer looks at all day: contact and image. Maps, mould and meshes keep their
own buttons. A newer request stops the older one, as everywhere.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import viser

from ui.desk.desk import Desk

SETTLED_S = 1.5
"""Quiet time after an edit before results are computed by themselves [s]."""
WANTED = ("press", "shoot")
JOB = "press"


class AutoUpdate:
    """Two widgets above the tabs."""

    def __init__(self, desk: Desk, clock: Callable[[], float] = time.monotonic) -> None:
        self.desk = desk
        self._clock = clock
        self._edited: float | None = None
        """When the state last changed without having been computed since [s]."""
        gui = desk.server.gui
        hint = "Contact and image of the design as it stands (U)"
        self.button = gui.add_button("Update results", icon=viser.Icon.REFRESH, hint=hint)
        self.button.on_click(desk.guarded(self._update))
        gui.add_command("Update results", hotkey="U").on_trigger(desk.guarded(self._update))
        hint = f"Update by itself {SETTLED_S:g} s after the last edit; a new edit starts anew"
        self.auto = gui.add_checkbox("Auto update", False, hint=hint)
        self.auto.on_update(desk.guarded(lambda event: self.edited()))

    def edited(self) -> None:
        """The state has changed, or may have."""
        self._edited = self._clock()

    def turn(self) -> None:
        """Compute what is stale once edits have settled; called by the pump."""
        if self._edited is None or self._clock() - self._edited < SETTLED_S:
            return
        self._edited = None
        if self.auto.value and not self.desk.live and self.stale:
            self.desk.run(JOB, WANTED)

    @property
    def stale(self) -> bool:
        """Whether contact or image are not those of the state."""
        fresh = self.desk.session.fresh()
        return not all(fresh[stage] for stage in WANTED)

    def refresh(self) -> None:
        """Offer the button only where there is something to do."""
        if self.button.disabled == self.stale:
            self.button.disabled = not self.stale

    def _update(self, event: Any) -> None:
        self._edited = None
        if self.stale:
            self.desk.run(JOB, WANTED)
