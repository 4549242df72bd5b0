"""The form of a search: what may vary, what is wanted, what must hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.offer import offer
from ui.page.plain import plain
from workbench.core.base.errors import DesignError
from workbench.search.choice_fields import CHOICES
from workbench.search.kept_searches import Asked
from workbench.search.problem import Goal, Limit, Vary, Want
from workbench.search.search_figures import KNOWN
from workbench.search.varied import read_vary
from workbench.search.wishes import WISHES
from workbench.system.names import NONE
from workbench.variants.sweep_fields import SweepField, field_value, sweep_fields

WANTS = {
    "as large as can be": Want.MAX,
    "as small as can be": Want.MIN,
    "near a value": Want.TARGET,
}
ENDS = ("at least", "at most")


class FormFolder:
    """Widgets of the folder, and what has been put together in it."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.vary: dict[str, Vary] = {}
        self.goals: dict[str, Goal] = {}
        self.limits: dict[str, Limit] = {}
        self.fields: dict[str, SweepField] = {}
        self.family = ""
        self.figures = {_titled(name): name for name in KNOWN}
        gui = desk.server.gui
        with gui.add_folder("What is looked for"):
            hint = "Goals and limits in words; more can be added below"
            words = (NONE, *WISHES)
            self.wish = gui.add_dropdown("Wish", words, hint=hint)
            self.wish.on_update(desk.guarded(lambda event: self._tell()))
            self._vary_form(gui)
            self._goal_form(gui)
            hint = "Powers of the ring's LEDs by least squares in every trial; needs no trials"
            self.even = gui.add_checkbox("Solve LED powers for even light", False, hint=hint)
            self.asked_words = gui.add_markdown("")
            clear = gui.add_button("Ask anew", icon=viser.Icon.ERASER, hint="Empties the form")
            clear.on_click(desk.guarded(self._clear))
        self.refresh()
        self._tell()

    def _vary_form(self, gui: Any) -> None:
        hint = "A number of the design or its press that may vary"
        self.field = gui.add_dropdown("Varied parameter", (NONE,), hint=hint)
        self.field.on_update(self.desk.guarded(self._suggest))
        self.low = gui.add_number("Lowest", 0.0, step=0.1, hint="In the unit of the parameter")
        self.high = gui.add_number("Highest", 1.0, step=0.1, hint="In the unit of the parameter")
        hint = "Apart by commas, for example 6, 8, 9; empty: all between lowest and highest"
        self.only = gui.add_text("Only these values", "", hint=hint)
        hint = "Between lowest and highest, or among the values; again changes what it may be"
        add = gui.add_button("Let it vary", hint=hint)
        add.on_click(self.desk.guarded(self._add_vary))

    def _goal_form(self, gui: Any) -> None:
        guarded = self.desk.guarded
        figures = (NONE, *self.figures)
        hint = "Of the score card, or of a search alone"
        self.figure = gui.add_dropdown("Figure", figures, hint=hint)
        self.want = gui.add_dropdown("Wanted", tuple(WANTS), hint="Which way the goal goes")
        self.end = gui.add_dropdown("Allowed", ENDS, hint="Which end of the limit Value is")
        hint = "Of a limit, or of a goal near a value; in the figure's unit"
        self.value = gui.add_number("Value", 0.0, step=0.1, hint=hint)
        goal = gui.add_button(
            "Add goal", icon=viser.Icon.TARGET, hint="Figure and Wanted as a goal"
        )
        goal.on_click(guarded(self._add_goal))
        limit = gui.add_button("Add limit", icon=viser.Icon.FENCE, hint="Figure, Allowed and Value")
        limit.on_click(guarded(self._add_limit))

    def refresh(self) -> None:
        """Offer what the design that stands has."""
        family = self.desk.session.design.family
        if family != self.family:
            self.family = family
            self.fields = {field.title: field for field in sweep_fields(self.desk.session.state)}
            offer(self.field, (NONE, *self.fields, *CHOICES))

    def asked(self) -> Asked:
        """What has been put together."""
        return Asked(
            vary=tuple(self.vary.values()),
            goals=tuple(self.goals.values()),
            limits=tuple(self.limits.values()),
            wishes=() if self.wish.value == NONE else (self.wish.value,),
            even_light=bool(self.even.value),
        )

    def _suggest(self, event: Any) -> None:
        """A range about the value that stands, within that of the parameter."""
        field, choice = self.fields.get(self.field.value), CHOICES.get(self.field.value)
        self.only.value = "" if choice is None else ", ".join(choice.values)
        for end in (self.low, self.high):
            end.disabled = choice is not None
        if field is None:
            return
        now = field_value(self.desk.session.state, field.path)
        width = max(0.5 * (abs(now) or field.high - field.low), 1.0 if field.whole else 0.0)
        digits = 0 if field.whole else 4
        self.low.value = round(max(field.low, now - width), digits)
        self.high.value = round(min(field.high, now + width), digits)

    def _add_vary(self, event: Any) -> None:
        title = self.field.value
        field, choice = self.fields.get(title), CHOICES.get(title)
        found = field or choice
        if found is None:
            raise DesignError("no parameter is chosen", hint="choose one, then let it vary")
        asked: dict[str, Any] = {"low": float(self.low.value), "high": float(self.high.value)}
        values = [text.strip() for text in self.only.value.split(",") if text.strip()]
        if values or choice is not None:
            asked = {"choices": values}
        vary = read_vary({"field": found.path, **asked}, self.desk.session.state)
        self.vary[found.path] = replace(vary, title=title)
        self._tell()

    def _add_goal(self, event: Any) -> None:
        name, want = self._figure(), WANTS[self.want.value]
        value = float(self.value.value) if want is Want.TARGET else 0.0
        self.goals[name] = Goal(figure=name, want=want, value=value)
        self._tell()

    def _add_limit(self, event: Any) -> None:
        name, value = self._figure(), float(self.value.value)
        before = self.limits.get(name, Limit(figure=name))
        least, most = before.at_least, before.at_most
        if self.end.value == ENDS[0]:
            least = value
        else:
            most = value
        self.limits[name] = Limit(figure=name, at_least=least, at_most=most)
        self._tell()

    def _figure(self) -> str:
        if self.figure.value not in self.figures:
            raise DesignError("no figure is chosen", hint="choose one, then add it")
        return self.figures[self.figure.value]

    def _clear(self, event: Any) -> None:
        for kept in (self.vary, self.goals, self.limits):
            kept.clear()
        self.wish.value, self.even.value = NONE, False
        self._tell()

    def _tell(self) -> None:
        """Say what has been put together."""
        wish = WISHES.get(self.wish.value)
        goals, limits = dict(self.goals), dict(self.limits)
        for each in () if wish is None else wish.goals:
            goals.setdefault(each.figure, each)
        for each in () if wish is None else wish.limits:
            limits.setdefault(each.figure, each)
        lines = [f"varies: {plain(v.title)}, {plain(v.span)}" for v in self.vary.values()]
        lines += [f"goal: {plain(_titled(g.figure))}, {_wanted(g)}" for g in goals.values()]
        lines += [f"limit: {plain(_titled(each.figure))} {each.words}" for each in limits.values()]
        self.asked_words.content = _listed(lines)


def _titled(figure: str) -> str:
    about = KNOWN[figure]
    label = about.label[:1].upper() + about.label[1:]
    return f"{label} [{about.unit}]" if about.unit else label


def _wanted(goal: Goal) -> str:
    if goal.want is Want.TARGET:
        return f"near {goal.value:g}"
    return next(words for words, want in WANTS.items() if want is goal.want)


def _listed(lines: Sequence[str]) -> str:
    if not lines:
        return "Nothing is asked yet: let a parameter vary, and add a goal or choose a wish."
    return "\n".join(f"- {line}" for line in lines)
