"""The pressed skin in the 3D view: a coloured mesh for every frame, and arrows of force.

Stepping only shows and hides frames that are there. They are made a few at a time when the desk's
pump turns, the last one first, so that a long press holds nobody up; one that is asked for before
its turn is made at once. A frame that takes the place of another, live or cut elsewhere, does so
only once the page has had time to read it, or the skin would flicker: `turn` removes what was
replaced.
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
from workbench.section_cut import Plane

ARROW_COLOUR = (255, 210, 60)
MOST_PREPARED = 60
"""Frames of which the meshes are made beforehand."""
MOST_KEPT = 120
"""Meshes that are kept at all."""
LINGER_S = 0.6
"""How long a replaced live frame stays: software rendering takes so long to read a new one."""
CUT_LINGER_S = 0.25
"""The same of a frame that was cut elsewhere, whose rest stands beyond the plane meanwhile."""
SLICE_S = 0.04
"""Time for making frames at each turn of the pump: other tabs wait so long at most [s]."""
QUIET_S = 0.4
"""A plane that has not moved for so long is where the other frames are cut [s]."""


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
        self._waiting: list[int] = []
        """Frames that are still to be made."""
        self._not_before_s = 0.0
        self.plane: Plane | None = None
        """What the frames are cut by."""
        self.allowed = True
        """Whether the designer wants to see the skin at all."""
        self._lingering: list[tuple[float, Any]] = []
        """Replaced frames and when each goes [s]."""

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
        self._let_linger(LINGER_S)
        self._skin, self.contact = skin, contact
        self._measure()
        self.show(1)

    def _let_linger(self, seconds: float) -> None:
        """Forget all frames; the one on show stays until the page has read its successor."""
        leave_s = self._clock() + seconds
        for node in self._nodes.values():
            if node.visible:
                self._lingering.append((leave_s, node))
            else:
                node.remove()
        self._nodes.clear()
        self._waiting.clear()
        self._series += 1

    def turn(self) -> None:
        """Remove the replaced live frames whose time is over."""
        now_s = self._clock()
        over = [node for leave_s, node in self._lingering if leave_s <= now_s]
        self._lingering = [entry for entry in self._lingering if entry[0] > now_s]
        for node in over:
            node.remove()
        if now_s >= self._not_before_s:
            self._make_some()

    def _make_some(self) -> None:
        """Make frames that wait for as long as nobody minds, and at least one."""
        until_s = self._clock() + SLICE_S
        while self._waiting:
            self._node(self._waiting.pop(0))
            if self._clock() >= until_s:
                break

    @property
    def ready(self) -> bool:
        """Whether every frame that is made beforehand is there."""
        return not self._waiting

    def cut(self, plane: Plane | None) -> None:
        """Cut the frames by a plane, or make them whole."""
        self.plane = plane
        if self.contact is not None:
            self._let_linger(CUT_LINGER_S)
            self.show(self._number)
            self._prepare()
            self._not_before_s = self._clock() + QUIET_S

    def allow(self, wanted: bool) -> None:
        """Let the skin be seen, or hide it whatever else is shown."""
        self.allowed = wanted
        self.show(self._number)

    def name_of(self, number: int) -> str:
        """Name of the node of a frame, which is made if it is not there."""
        return self._node(number).name

    def surface(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Vertices [mm] and triangles of the frame on show, not cut; None where none is."""
        if not self._number or self._skin is None or self.contact is None or not self.allowed:
            return None
        number = min(self._number, self.count)
        moved = np.asarray(self.contact.displacement_mm[number - 1])
        return np.asarray(self._skin.points_mm) + moved, np.asarray(self._skin.faces)

    def paint(self, quantity: Quantity) -> None:
        """Colour the skin by another quantity."""
        self.quantity = quantity
        if self.contact is not None:
            self._let_linger(CUT_LINGER_S)
            self._measure()
            self.show(self._number)
            self._prepare()

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
            wanted = k == number and self.allowed
            if wanted != node.visible:
                node.visible = wanted
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
        """Let the frames of a press of usual length be made, the last one first."""
        frames = range(1, min(self.count, MOST_PREPARED) + 1)
        self._waiting = [self.count, *frames] if self.count else []
        self._not_before_s = 0.0

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
        glb = coloured_glb(points, np.asarray(self._skin.faces), colours, self.plane)
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
        self._waiting.clear()
        self._series += 1

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
