"""The folder A against B: parameters and figures that differ, images, and both in the 3D view."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.blink import Blink
from ui.page.imaging import placeholder
from ui.page.offer import offer
from ui.page.plain import plain
from ui.panels.compare.variant_cards import thumbnail_html
from ui.patches.leading import empty_state
from ui.scene.ghost import COLOURS, Ghost, GhostView
from workbench.core.base.errors import DesignError
from workbench.system.names import NONE
from workbench.variants.comparison import changes, parameter_differences, press_notice, summary
from workbench.variants.comparison_images import Moment, Pair, pair, side_by_side
from workbench.variants.comparison_side import NOW, Side
from workbench.variants.comparison_tables import change_table, parameter_table, scrolled
from workbench.variants.comparison_words import sentences

BESIDE, BLINK, DIFFERENCE = "side by side", "blink", "difference"
BLINK_S = 0.6
NOTHING = empty_state(
    "There is only the design as it stands: save it, change something, and compare both.",
    "Save it as a variant",
    press="Save variant",
)
STANDS_BESIDE, OVERLAID = "beside A", "over A"


class VersusFolder:
    """Widgets of the folder."""

    def __init__(
        self,
        desk: Desk,
        side: Callable[[str], Side | None],
        thumbnail: Callable[[str], Path | None],
    ) -> None:
        self.desk = desk
        self.side = side
        """Finds a side by its name; None of one that cannot be read."""
        self.thumbnail = thumbnail
        """Finds the file of a thumbnail by the name of its variant."""
        self.a: Side | None = None
        self.b: Side | None = None
        self.both: Pair | None = None
        self.ghosts = GhostView(desk.server, desk.session.store, on_error=desk.reports.tell)
        self._compared = False
        """Whether other designs stand in the view, or are on their way."""
        self.hidden = False
        """Whether parts are looked at, so that no ghost stands among them."""
        self.on_compare: Callable[[Side | None, Side | None], None] = lambda a, b: None
        """Set by the panel: told what is compared."""
        gui = desk.server.gui
        with gui.add_folder("A against B"):
            self._choices(gui)
            self._images(gui)
            self._view(gui)
            self.tables = gui.add_html("")

    def _choices(self, gui: Any) -> None:
        desk = self.desk
        hint = "What B is compared with"
        self.choice_a = gui.add_dropdown("A", (NONE, NOW), hint=hint)
        self.choice_b = gui.add_dropdown("B", (NONE, NOW), hint="What is judged")
        for handle in (self.choice_a, self.choice_b):
            handle.on_update(desk.guarded(lambda event: self.compare()))
        hint = "A in place of B and B in place of A"
        swap = gui.add_button("Swap A and B", icon=viser.Icon.ARROWS_EXCHANGE, hint=hint)
        swap.on_click(desk.guarded(self._swap))
        self.thumbnails = gui.add_html("")
        self.words = gui.add_markdown("Choose A and B.")

    def _images(self, gui: Any) -> None:
        desk = self.desk
        names = (BESIDE, BLINK, DIFFERENCE)
        hint = f"Blink: one in place of the other, every {BLINK_S:g} s"
        self.mode = gui.add_dropdown("Images", names, hint=hint)
        self.moment = gui.add_dropdown(
            "Moment", tuple(m.value for m in Moment), hint="Which image of each press is compared"
        )
        for handle in (self.mode, self.moment):
            handle.on_update(desk.guarded(lambda event: self._show_images()))
        self.caption = gui.add_markdown("")
        self.image = gui.add_image(placeholder(), format="jpeg", visible=False)
        self.blink_a = gui.add_image(placeholder(), label="A", format="jpeg", visible=False)
        self.blink_b = gui.add_image(placeholder(), label="B", format="jpeg", visible=False)
        self.turns = Blink(desk.server, self.blink_a, self.blink_b, period_s=BLINK_S)

    def _view(self, gui: Any) -> None:
        desk = self.desk
        hint = "Translucent and in colours of their own, made of what is stored"
        self.in_view = gui.add_checkbox("Show B in 3D", False, hint=hint)
        self.placing = gui.add_dropdown(
            "B stands", (STANDS_BESIDE, OVERLAID), hint="Where B is drawn in the 3D view"
        )
        self.dented = gui.add_checkbox("B pressed", False, hint="In the last frame of its press")
        self.view_words = gui.add_markdown("", visible=False)
        self.in_view.on_update(desk.guarded(self._toggle_view))
        for handle in (self.placing, self.dented):
            handle.on_update(desk.guarded(lambda event: self.draw()))

    def offer(self, names: tuple[str, ...]) -> None:
        """Offer variants beside the design as it stands; follow those that changed."""
        for handle in (self.choice_a, self.choice_b):
            offer(handle, (NONE, NOW, *names))
        self.compare()

    def fill(self, name: str) -> None:
        """Take a variant into the first of both that is free."""
        for handle in (self.choice_a, self.choice_b):
            if handle.value == NONE:
                handle.value = name
                return

    def _swap(self, event: Any) -> None:
        a, b = self.choice_a.value, self.choice_b.value
        self.choice_a.value = b
        self.choice_b.value = a

    def compare(self) -> None:
        """Show what differs between those chosen."""
        self.a, self.b = (
            None if handle.value == NONE else self.side(handle.value)
            for handle in (self.choice_a, self.choice_b)
        )
        self.thumbnails.content = self._thumbnails()
        if self.a is None or self.b is None:
            self.both = None
            self.words.content = "Choose A and B."
            self.tables.content = "" if len(self.choice_a.options) > 2 else NOTHING
        else:
            self._tell(self.a, self.b)
            self._pair(self.a, self.b)
        for handle in (self.mode, self.moment):
            handle.visible = self.both is not None
        self._show_images()
        self.draw()
        self.on_compare(self.a, self.b)

    def _thumbnails(self) -> str:
        """Thumbnails of those chosen, each below its letter, as HTML."""
        tiles = []
        for letter, side in (("A", self.a), ("B", self.b)):
            path = None if side is None else self.thumbnail(side.name)
            if side is not None and path is not None:
                tiles.append(
                    "<div style='display:flex;align-items:center;gap:6px;max-width:250px'>"
                    f"<b>{letter}</b>"
                    f"{thumbnail_html(path, short(side))}</div>"
                )
        return f"<div style='margin:4px 8px;font-size:12px'>{''.join(tiles)}</div>"

    def _tell(self, a: Side, b: Side) -> None:
        rows = changes(a.figures, b.figures)
        words = summary(rows, press_notice(a.state, b.state))
        heads = (line.partition(": ") for line in sentences(rows))
        items = [f"- **{plain(head)}**: {plain(figures)}" for head, _, figures in heads]
        self.words.content = "\n".join([f"**{plain(words)}**", "", *items])
        differing = parameter_differences(a.state, b.state)
        self.tables.content = (
            "<div style='font-size:12px;margin:8px 8px 0'><b>Parameters that differ</b></div>"
            + scrolled(parameter_table(differing, short(a), short(b)))
            + "<div style='font-size:12px;margin:8px 8px 0'><b>Figures</b></div>"
            + scrolled(change_table(rows, short(a), short(b)))
        )

    def _pair(self, a: Side, b: Side) -> None:
        store = self.desk.session.store
        shots = [side.shot(store) for side in (a, b)]
        self.both = None
        without = [s.name for s, shot in zip((a, b), shots, strict=True) if shot is None]
        if without:
            names = plain(" and ".join(without))
            self.caption.content = (
                f"No image of {names} is stored: press *Run press* or *Run what is missing*."
            )
        elif shots[0] is not None and shots[1] is not None:
            self.both = pair(shots[0], shots[1], Moment(self.moment.value))

    def _show_images(self) -> None:
        """Show the images in the way that is chosen; blinking stops in every other."""
        if self.a is not None and self.b is not None and self.both is not None:
            self._pair(self.a, self.b)
        both, mode = self.both, self.mode.value
        self.turns.stop()
        none = mode == DIFFERENCE and (both is None or both.difference is None)
        with self.desk.server.atomic():
            self.image.visible = both is not None and mode != BLINK and not none
            self.blink_a.visible = both is not None and mode == BLINK
            self.blink_b.visible = False
            if both is None:
                if self.a is None or self.b is None:
                    self.caption.content = ""
                return
            words = both.change_words if mode == DIFFERENCE else both.words
            order = "A left, B right: " if mode == BESIDE else ""
            self.caption.content = f"<small>{plain(order + words)}</small>"
            if mode == BESIDE:
                self.image.image = side_by_side(both)
            elif mode == DIFFERENCE and both.difference is not None:
                self.image.image = both.difference
            elif mode == BLINK:
                self.blink_a.image, self.blink_b.image = both.a, both.b
                self.turns.start()

    def _toggle_view(self, event: Any) -> None:
        if self.in_view.value and (self.a is None or self.b is None):
            self.in_view.value = False
            raise DesignError("there is no B to show", hint="choose A and B first")
        was = self.ghosts.bounds_mm is not None
        self.draw()
        if not self.in_view.value and was:
            self.desk.scene.views.step_forward(*self.desk.scene.body.bounds_mm)

    def draw(self) -> None:
        """Draw A and B beside or over the sensor in the view, or take them away."""
        if not self.in_view.value or self.hidden or self.a is None or self.b is None:
            self._clear()
            return
        # Dimensions would stand among the names of the designs.
        self._tell_compared(True)
        wanted, own = self._wanted(self.a, self.b)
        bounds = self.desk.scene.body.bounds_mm
        then = self.desk.guarded(self._drawn)
        self.ghosts.show(wanted, own=own, bounds_mm=bounds, then=then)

    def _clear(self) -> None:
        self.ghosts.clear()
        self._tell_compared(False)

    def _tell_compared(self, compared: bool) -> None:
        """Tell all panels when other designs come to stand in the view, and when they go."""
        if compared != self._compared:
            self._compared = compared
            self.desk.tell("compared", compared)

    def _wanted(self, a: Side, b: Side) -> tuple[list[Ghost], str]:
        """What is drawn, and the label of the sensor: A where it is that, else what it is."""
        now = self.desk.session.calls()["build"].key
        over = self.placing.value == OVERLAID
        pressed = bool(self.dented.value)
        own = [f"{letter}: {short(side)}" for letter, side in (("A", a),) if _is(side, now)]
        ghosts = []
        for letter, side, place, colour in (("A", a, -1, COLOURS[0]), ("B", b, 1, COLOURS[1])):
            if letter == "A" and own:
                continue
            ghosts.append(
                Ghost(
                    label=f"{letter}: {short(side)}",
                    side=side,
                    colour=colour,
                    place=0 if over else place,
                    pressed=pressed,
                )
            )
        return ghosts, own[0] if own else "as it stands"

    def _drawn(self, missing: str) -> None:
        """Tell what could not be drawn, and step back until all stands in the view."""
        self.view_words.content = plain(missing)
        self.view_words.visible = bool(missing)
        bounds = self.ghosts.bounds_mm
        if bounds is not None and self.ghosts.on:
            self.desk.scene.views.step_back(*bounds)

    def forget_view(self) -> None:
        """Another sensor is in the view: ghosts of the old comparison go."""
        if self.in_view.value:
            self.in_view.value = False
        self._clear()

    def cover(self, hidden: bool) -> None:
        """Step aside while parts are looked at."""
        self.hidden = hidden
        self.draw()


def short(side: Side) -> str:
    """The name of a side for a label."""
    return "as it stands" if side.name == NOW else side.name


def _is(side: Side, key: str) -> bool:
    return side.name == NOW or side.keys.get("build") == key
