"""The checks of the workshop: one coloured button each, which flies to where it is worst."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np

from ui.desk.desk import Desk
from ui.page.plain import plain
from ui.panels.make.parts import PartsTree
from ui.scene.views import Mark
from workbench.core.result.fabrication import FabricationCheck, Severity
from workbench.view.part_words import part_label, part_words
from workbench.view.scene_shapes import clear_view

LOOKS = {
    Severity.BAD: ("✗", (190, 48, 52)),
    Severity.WARNING: ("!", (176, 110, 10)),
    Severity.GOOD: ("✓", (32, 110, 72)),
}
"""Sign and colour, worst first; the sign is for those who do not see the colour."""
SHARE = "of "
"""Units that begin so are shares of a whole."""
NOISE = re.compile(r"-?\b\d(\.\d+)?e-(0[6-9]|[1-9]\d)\b")
"""Numbers that are nought but for rounding."""
NEAR_MM = (30.0, 160.0)
"""Nearest and farthest that the eye comes to a place [mm]."""
NEAR_SHARE = 1.3
"""Distance of the eye from a place over the diagonal of its part."""


class ChecksList:
    """Widgets of all checks; made anew for every design."""

    def __init__(self, desk: Desk, tree: PartsTree) -> None:
        self.desk = desk
        self.tree = tree
        gui = desk.server.gui
        self.folder = gui.add_folder("Checks", visible=False)
        with self.folder:
            self.detail = gui.add_markdown("")
        self.made: list[Any] = []

    def offer(self, checks: tuple[FabricationCheck, ...]) -> None:
        """Show the checks of another design, the worst first."""
        for handle in self.made:
            handle.remove()
        self.made = []
        self.folder.visible = bool(checks)
        self.detail.content = verdict(checks)
        order = list(LOOKS)
        gui = self.desk.server.gui
        with self.folder:
            for check in sorted(checks, key=lambda check: order.index(check.severity)):
                _, colour = LOOKS[check.severity]
                button = gui.add_button(line(check), color=colour, hint=said(check))
                button.on_click(self.desk.guarded(self._flight(check)))
                self.made.append(button)

    def _flight(self, check: FabricationCheck) -> Callable[[Any], None]:
        return lambda event: self._fly(check)

    def _fly(self, check: FabricationCheck) -> None:
        """Look at the place of a check and mark it."""
        scene = self.desk.scene
        self.tree.reveal(check.part)
        part = scene.parts.parts.get(check.part)
        solid = scene.body.solid
        surface = part if part is not None else None if solid is None else solid.membrane
        if surface is None:
            return
        points = np.asarray(surface.points_mm)
        size_mm = float(np.linalg.norm(np.ptp(points, axis=0)))
        place = scene.parts.moved(check.part, check.place_mm)
        distance_mm = min(max(NEAR_SHARE * size_mm, NEAR_MM[0]), NEAR_MM[1])
        toward = clear_view(points, surface.faces, np.asarray(check.place_mm), distance_mm)
        name = check.name.replace("_", " ")
        mark = Mark(f"{name}: {amount(check)}", LOOKS[check.severity][1])
        scene.views.fly_to(place, toward, distance_mm, mark)
        x, y, z = check.place_mm
        where = f"{x:.1f}, {y:.1f}, {z:.1f} mm"
        self.detail.content = f"{plain(said(check))} At {where}."
        self.desk.log(f"{part_label(check.part)}: looking at {name}, {where}")


def verdict(checks: tuple[FabricationCheck, ...]) -> str:
    """How many checks came out how."""
    counts = {
        "cannot be made": sum(c.severity is Severity.BAD for c in checks),
        "to look at": sum(c.severity is Severity.WARNING for c in checks),
        "good": sum(c.severity is Severity.GOOD for c in checks),
    }
    return " · ".join(f"**{count}** {what}" for what, count in counts.items() if count)


def amount(check: FabricationCheck) -> str:
    """Value, unit and limit."""
    sense = "≤" if check.sense == "max" else "≥"
    # Rounding noise is nought to a reader: five digits below the limit's own size.
    value = 0.0 if abs(check.value) < 1e-5 * max(abs(check.limit), 1.0) else check.value
    if not check.unit.startswith(SHARE):
        return f"{value:.3g} {check.unit} ({sense} {check.limit:.3g})"
    return f"{100 * value:.3g} % {check.unit} ({sense} {100 * check.limit:.3g} %)"


def said(check: FabricationCheck) -> str:
    """The message of a check in a designer's words: parts, shares in percent, nought for noise."""
    text = NOISE.sub("0", check.message)
    if text.startswith(f"{check.part}:"):
        text = part_label(check.part) + text.removeprefix(check.part)
    if check.unit.startswith(SHARE):
        number = rf"([\d.]+(?:e[-+]\d+)?) {re.escape(check.unit)}"
        text = re.sub(number, lambda m: f"{100 * float(m[1]):.3g} % {check.unit}", text)
    return text


def line(check: FabricationCheck) -> str:
    """One check as a button says it."""
    sign, _ = LOOKS[check.severity]
    return f"{sign} {check.name.replace('_', ' ')}, {part_words(check.part)}: {amount(check)}"
