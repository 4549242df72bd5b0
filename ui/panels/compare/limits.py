"""The folder of the designer's own limits, by which the headline above all pages is judged."""

from __future__ import annotations

from ui.desk.desk import Desk
from workbench.project.limits import read_limits, write_limits
from workbench.view.headline import HEADLINES, MAKEABLE, Bounds, Headline
from workbench.view.metric_rules import rule

SET, TAKE_BACK = "Set limits", "Take back"


def _label(one: Headline) -> str:
    unit = rule(one.figure).unit
    return f"{one.word} [{unit}]" if unit else one.word


CHOICES = {_label(one): one for one in HEADLINES if one.figure != MAKEABLE}
"""Figures that have limits, as people call them."""


class LimitsFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui, guarded = desk.server.gui, desk.guarded
        with gui.add_folder("My limits", expand_by_default=False):
            hint = "Whose good and poor ends are set; Makeable is judged by the checks of the parts"
            self.choice = gui.add_dropdown("Limits of", tuple(CHOICES), hint=hint)
            hint = "In the figure's unit; above Poor from where more is better, else below it"
            self.good = gui.add_number("Good from", 0.0, hint=hint)
            hint = "In the figure's unit; between the two it is fair"
            self.poor = gui.add_number("Poor from", 1.0, hint=hint)
            hint = "Set limits keeps both in the project; Take back: those of the workbench again"
            self.acts = gui.add_button_group("Limits", (SET, TAKE_BACK), hint=hint)
        self.choice.on_update(guarded(lambda event: self.show()))
        self.acts.on_click(guarded(lambda event: self._act()))
        self.show()

    def show(self) -> None:
        """Show the limits that hold of the chosen figure."""
        one = CHOICES[self.choice.value]
        bounds = read_limits(self.desk.session.project.folder).get(one.figure, one.bounds)
        if bounds is not None:
            self.good.value, self.poor.value = bounds.good, bounds.poor

    def _act(self) -> None:
        folder = self.desk.session.project.folder
        figure, limits = CHOICES[self.choice.value].figure, read_limits(folder)
        if self.acts.value == SET:
            limits[figure] = Bounds(good=float(self.good.value), poor=float(self.poor.value))
        else:
            limits.pop(figure, None)
        write_limits(folder, limits)
        self.show()
        self.desk.limited()
