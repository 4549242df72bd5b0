"""The pressed skin in the 3D view: a coloured mesh for every frame, and arrows of force.

Frames are prepared when a press arrives, so that stepping only shows and hides them; of a long
press they are made as they are asked for. A live frame takes the place of the one before only once
the page has had time to read it, or the skin would flicker: the desk's pump calls `turn`, which
removes what was replaced.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from ui.imaging import coloured_glb, heat_colours
from ui.sensor import SKIN_COLOUR
from workbench.core.results import Skin
from workbench.core.sensing import Contact
from workbench.quantities import Quantity, Shown, force_arrows, largest_arrow_N, shown

ARROW_COLOUR = (255, 210, 60)
MOST_PREPARED = 60
"""Frames of which the meshes are made at once."""
MOST_KEPT = 120
"""Meshes that are kept at all."""
LINGER_S = 0.6
"""How long a replaced live frame stays: software rendering takes so long to read a new one."""


class PressedView:
    """Nodes of one press."""

    def __init__(
        self,
        api: Any,
        on_click: Callable[[Any], None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.api = api
        self._clock = clock
        self.on_click = on_click
        self.contact: Contact | None = None
        self.quantity = Quantity.DISPLACEMENT
        self.shown: Shown | None = None
        self._skin: Skin | None = None
        self._nodes: dict[int, Any] = {}
        self._arrows: Any = None
        self._arrows_wanted = False
        self._top_N = 0.0
        self._number = 0
        self._series = 0
        self._lingering: list[tuple[float, Any]] = []
        """Replaced live frames and when each goes [s]."""

    @property
    def count(self) -> int:
        """Frames of the press."""
        return 0 if self.contact is None else len(self.contact.reaction_N)

    def load(self, skin: Skin, contact: Contact) -> None:
        """Take a press; nothing of it is on show yet."""
        self.clear()
        self._skin, self.contact = skin, contact
        self._measure()
        self._prepare()

    def load_live(self, skin: Skin, contact: Contact) -> None:
        """Take a press of one frame, and show it in place of the one before."""
        before = [node for node in self._nodes.values() if node.visible]
        rest = [node for node in self._nodes.values() if not node.visible]
        self._nodes.clear()
        for node in rest:
            node.remove()
        self._skin, self.contact = skin, contact
        self._measure()
        self._series += 1
        leave_s = self._clock() + LINGER_S
        self._lingering += [(leave_s, node) for node in before]
        self.show(1)

    def turn(self) -> None:
        """Remove the replaced live frames whose time is over."""
        now_s = self._clock()
        over = [node for leave_s, node in self._lingering if leave_s <= now_s]
        self._lingering = [entry for entry in self._lingering if entry[0] > now_s]
        for node in over:
            node.remove()

    def paint(self, quantity: Quantity) -> None:
        """Colour the skin by another quantity."""
        self.quantity = quantity
        if self.contact is not None:
            number = self._number
            self._forget_nodes()
            self._measure()
            self._prepare()
            self.show(number)

    def draw_arrows(self, wanted: bool) -> None:
        """Draw the forces of the frame on show, or take them away."""
        self._arrows_wanted = wanted
        self._follow_arrows()

    def show(self, number: int) -> None:
        """Show frame `number`, counted from 1; 0 shows none."""
        self._number = number
        if number:
            self._node(number)
        for k, node in self._nodes.items():
            if (k == number) != node.visible:
                node.visible = k == number
        self._follow_arrows()

    def clear(self) -> None:
        """Forget the press."""
        self._forget_nodes()
        self.contact = self._skin = self.shown = None
        self._number = 0
        self._follow_arrows()

    def _measure(self) -> None:
        if self._skin is not None and self.contact is not None:
            self.shown = shown(self._skin, self.contact, self.quantity)
            self._top_N = largest_arrow_N(self._skin, self.contact)

    def _prepare(self) -> None:
        self._series += 1
        for k in range(1, min(self.count, MOST_PREPARED) + 1):
            self._node(k)

    def _node(self, number: int) -> Any:
        """The mesh of a frame, made when it is first asked for."""
        if number in self._nodes or self._skin is None or self.contact is None:
            return self._nodes.get(number)
        if self.shown is None or number > self.count:
            return None
        while len(self._nodes) >= MOST_KEPT:
            self._nodes.pop(next(iter(self._nodes))).remove()
        moved = np.asarray(self.contact.displacement_mm[number - 1])
        points = (np.asarray(self._skin.points_mm) + moved).astype(np.float32)
        colours = heat_colours(self.shown.shares[number - 1], SKIN_COLOUR)
        glb = coloured_glb(points, np.asarray(self._skin.faces), colours)
        node = self.api.add_glb(f"/frames/{self._series}/{number}", glb, visible=False)
        node.on_click(self.on_click)
        self._nodes[number] = node
        return node

    def _forget_nodes(self) -> None:
        for _, node in self._lingering:
            node.remove()
        self._lingering.clear()
        for node in self._nodes.values():
            node.remove()
        self._nodes.clear()

    def _follow_arrows(self) -> None:
        if self._arrows is not None:
            self._arrows.remove()
            self._arrows = None
        wanted = self._arrows_wanted and 0 < self._number <= self.count
        if wanted and self._skin is not None and self.contact is not None:
            ends = force_arrows(self._skin, self.contact, self._number - 1, top_N=self._top_N)
            if len(ends):
                self._arrows = self.api.add_arrows(
                    "/forces",
                    ends.astype(np.float32),
                    ARROW_COLOUR,
                    shaft_radius=0.07,
                    head_radius=0.2,
                    head_length=0.5,
                )
