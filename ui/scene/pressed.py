"""The pressed skin in the 3D view: a coloured mesh for every frame, and arrows of force.

Stepping only shows and hides frames that are there. They are worked out in the background, the last
one first, and put into the page a few at a time; one that is asked for before its turn is made at
once. A frame that takes the place of another, live or cut elsewhere, does so only once the page has
had time to read it, or the skin would flicker: `turn` removes what was replaced.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from ui.page.background_thread import BackgroundThread
from ui.scene.pointing import listen
from ui.scene.pressed_frames import PressedFrames, pressed_frames
from workbench.core.result.results import Skin
from workbench.core.result.sensing import Contact
from workbench.view.force_sources import Forces
from workbench.view.quantities import Quantity, Shown
from workbench.view.section_cut import Plane

ARROW_COLOUR = (255, 210, 60)
MOST_PREPARED = 60
"""Frames of which the meshes are made beforehand."""
MOST_KEPT = 120
"""Meshes that are kept at all."""
LINGER_S = 0.6
"""How long a replaced live frame stays: software rendering takes so long to read a new one."""
CUT_LINGER_S = 0.25
"""The same of a frame that was cut elsewhere, whose rest stands beyond the plane meanwhile."""
QUIET_S = 0.4
"""A plane that has not moved for so long is where the other frames are cut [s]."""
MEASURE, FRAMES = "colours of a press", "frames of a press"
"""Jobs of the background thread."""


class PressedView:
    """Nodes of one press."""

    def __init__(
        self,
        api: Any,
        on_click: Callable[[Any], None],
        background: BackgroundThread,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.api = api
        self.on_click = on_click
        self.background = background
        self._clock = clock
        self.on_painted: Callable[[], None] = lambda: None
        """Set by the scene: called once a press has its colours, and so its frames."""
        self.contact: Contact | None = None
        self.field: Forces | None = None
        """What the skin shows of the press: the contact, or another source of its forces."""
        self.against: Forces | None = None
        """Another source, where the difference from it is on show."""
        self.quantity = Quantity.DISPLACEMENT
        self._skin: Skin | None = None
        self._frames: PressedFrames | None = None
        """None until the press has been measured."""
        self._nodes: dict[int, Any] = {}
        self._arrows: Any = None
        self._arrows_wanted = False
        self._number = 0
        self._series = 0
        self._prepare_at_s: float | None = None
        """When the frames that nobody has asked for are begun; None once they are."""
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

    @property
    def shown(self) -> Shown | None:
        """The quantity on show; None until it has been measured."""
        return None if self._frames is None else self._frames.shown

    @property
    def drawn(self) -> bool:
        """Whether a frame of the press stands in the view, in place of the skin at rest."""
        return self._number > 0 and self._frames is not None

    def load(self, skin: Skin, contact: Contact) -> None:
        """Take a press; nothing of it is on show until it has been measured in the background."""
        self.clear()
        self._skin, self.contact = skin, contact
        self.field, self.against = contact, None
        self._measure()

    def load_live(self, skin: Skin, contact: Contact) -> None:
        """Take a press of one frame, and show it in place of the one before."""
        self.background.forget(MEASURE)
        self._let_linger(LINGER_S)
        self._skin, self.contact = skin, contact
        self.field, self.against = contact, None
        self._frames = pressed_frames(skin, contact, self.quantity)
        self.show(1)

    def paint(self, quantity: Quantity) -> None:
        """Colour the skin by another quantity, once that has been measured in the background."""
        self.quantity = quantity
        self._measure()

    def show_source(self, field: Forces, against: Forces | None = None) -> None:
        """Show the press as another source has it, or how far that is from `against`."""
        self.field, self.against = field, against
        self._measure()

    def _measure(self) -> None:
        skin, field, quantity, before = self._skin, self.field, self.quantity, self._frames
        against = self.against
        if skin is not None and field is not None:
            work = (pressed_frames(skin, field, quantity, before, against) for _ in range(1))
            self.background.ask(MEASURE, work, self._painted)

    def _painted(self, frames: PressedFrames) -> None:
        """Show what has been measured."""
        self._let_linger(CUT_LINGER_S)
        self._frames = frames
        self.show(self._number)
        self._prepare_at_s = self._clock()
        self.on_painted()

    def _let_linger(self, seconds: float) -> None:
        """Forget all frames; the one on show stays until the page has read its successor."""
        leave_s = self._clock() + seconds
        for node in self._nodes.values():
            if node.visible:
                self._lingering.append((leave_s, node))
            else:
                node.remove()
        self._forget_frames()

    def _forget_frames(self) -> None:
        self.background.forget(FRAMES)
        self._nodes.clear()
        self._prepare_at_s = None
        self._series = self._free_series()

    def _free_series(self) -> int:
        """The first number that no frame on show has, nor had a moment ago.

        Names are used again: viser keeps a few messages of every name for ever, and a new tab is
        sent all of them.
        """
        lingering = {int(node.name.split("/")[2]) for _, node in self._lingering}
        return next(k for k in itertools.count() if k not in (*lingering, self._series))

    def turn(self) -> None:
        """Remove replaced frames whose time is over; begin with frames once the cut rests."""
        now_s = self._clock()
        over = [node for leave_s, node in self._lingering if leave_s <= now_s]
        self._lingering = [entry for entry in self._lingering if entry[0] > now_s]
        for node in over:
            node.remove()
        if self._prepare_at_s is not None and now_s >= self._prepare_at_s and self._frames:
            self._prepare_at_s = None
            numbers = [self.count, *range(1, min(self.count, MOST_PREPARED) + 1)]
            wanted = [k for k in dict.fromkeys(numbers) if k not in self._nodes]
            self.background.ask(FRAMES, self._frames.files(wanted, self.plane), self._take)

    def _take(self, made: tuple[int, bytes]) -> None:
        """Put a frame that was made in the background into the page, hidden."""
        number, glb = made
        if number not in self._nodes:
            self._add(number, glb)

    def cut(self, plane: Plane | None) -> None:
        """Cut the frames by a plane, or make them whole."""
        self.plane = plane
        if self._frames is not None:
            self._let_linger(CUT_LINGER_S)
            self.show(self._number)
            self._prepare_at_s = self._clock() + QUIET_S

    def allow(self, wanted: bool) -> None:
        """Let the skin be seen, or hide it whatever else is shown."""
        self.allowed = wanted
        self.show(self._number)

    def name_of(self, number: int) -> str:
        """Name of the node of a frame, which is made if it is not there."""
        return self._node(number).name

    def surface(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Vertices [mm] and triangles of the frame on show, not cut; None where none is."""
        if not self._number or self._skin is None or self.field is None or not self.allowed:
            return None
        number = min(self._number, self.count)
        moved = np.asarray(self.field.displacement_mm[number - 1])
        return np.asarray(self._skin.points_mm) + moved, np.asarray(self._skin.faces)

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
        self.background.forget(MEASURE)
        for node in (*(node for _, node in self._lingering), *self._nodes.values()):
            node.remove()
        self._lingering.clear()
        self._forget_frames()
        self.contact = self.field = self.against = self._skin = self._frames = None
        self._number = 0
        self._follow_arrows()

    def _node(self, number: int) -> Any:
        """The mesh of a frame, made when it is first asked for."""
        if number not in self._nodes and self._frames is not None and number <= self.count:
            self._add(number, self._frames.glb(number, self.plane))
        return self._nodes.get(number)

    def _add(self, number: int, glb: bytes) -> None:
        while len(self._nodes) >= MOST_KEPT:
            self._nodes.pop(next(iter(self._nodes))).remove()
        node = self.api.add_glb(f"/frames/{self._series}/{number}", glb, visible=False)
        listen(node, self.on_click)
        self._nodes[number] = node

    def _follow_arrows(self) -> None:
        if self._arrows is not None:
            self._arrows.remove()
            self._arrows = None
        if self._arrows_wanted and self._frames is not None and 0 < self._number <= self.count:
            ends = self._frames.arrows_mm(self._number)
            if len(ends):
                self._arrows = self.api.add_arrows(
                    "/forces",
                    ends.astype(np.float32),
                    ARROW_COLOUR,
                    shaft_radius=0.07,
                    head_radius=0.2,
                    head_length=0.5,
                )
