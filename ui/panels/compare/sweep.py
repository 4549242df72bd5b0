"""The folder of sweeps: one number in steps, computed in the background, as plot and images."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.desk.sweep_run import SweepRun
from ui.page.offer import offer
from ui.panels.compare.sweep_results import SweepResults
from workbench.core.base.errors import DesignError
from workbench.system.names import NONE, numbered
from workbench.variants.comparison_report import point_state
from workbench.variants.sweep_fields import SweepField, field_value, sweep_fields
from workbench.variants.sweep_files import (
    delete_sweep,
    list_sweeps,
    load_sweep,
    restore_sweep,
    save_sweep,
)
from workbench.variants.sweeps import FEWEST, MOST, Span, Sweep, make_sweep, todo
from workbench.variants.variants import save_variant

TELL_S = 0.5
"""Between two looks at how far a sweep is [s]."""


class SweepFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk, on_keep: Callable[[str], None]) -> None:
        self.desk = desk
        self.project = desk.session.project
        self.on_keep = on_keep
        """Told the name of a variant that a point was kept as."""
        self.run = SweepRun(self.project, desk.jobs, self._follow)
        self.trashed = ""
        """Name in the trash of what was deleted last."""
        self.fields: dict[str, SweepField] = {}
        self.family = ""
        gui = desk.server.gui
        with gui.add_folder("Sweep one parameter"):
            self._form(gui)
            self._results(gui)
        self.refresh()
        self._offer()

    def _form(self, gui: Any) -> None:
        guarded = self.desk.guarded
        self.field = gui.add_dropdown("Parameter", (NONE,), hint="All else stays as it stands")
        self.field.on_update(guarded(self._suggest))
        hint = "In the unit of the parameter"
        self.start = gui.add_number("From", 0.0, step=0.1, hint=hint)
        self.stop = gui.add_number("To", 1.0, step=0.1, hint=hint)
        hint = "Values, both ends included; each is a whole press"
        self.steps = gui.add_slider("Steps", FEWEST, MOST, 1, 5, hint=hint)
        hint = "Also mould and housing, for the counts of checks; slower"
        self.parts = gui.add_checkbox("With mould checks", False, hint=hint)
        run = gui.add_button(
            "Run sweep",
            icon=viser.Icon.PLAYER_PLAY,
            hint="Presses the design at each value, one after the other",
        )
        run.on_click(guarded(self._begin))
        self.progress = gui.add_markdown("")
        self.cancel = gui.add_button(
            "Cancel sweep", color="red", visible=False, hint="Points that are done are kept"
        )
        self.cancel.on_click(guarded(lambda event: self.run.stop()))

    def _results(self, gui: Any) -> None:
        guarded = self.desk.guarded
        self.choice = gui.add_dropdown("Sweep", (NONE,), hint="Those of this project")
        self.choice.on_update(guarded(self._open))
        hint = "Computes what is missing; what is stored costs nothing"
        self.resume = gui.add_button("Resume sweep", hint=hint, visible=False)
        self.resume.on_click(guarded(self._resume))
        hint = "Moves its file to the trash; computed results stay stored"
        self.delete = gui.add_button(
            "Delete sweep", icon=viser.Icon.TRASH, hint=hint, visible=False
        )
        self.delete.on_click(guarded(self._delete))
        hint = "Brings back the sweep that was deleted last"
        self.restore = gui.add_button(
            "Undo delete of sweep", icon=viser.Icon.ARROW_BACK_UP, hint=hint, visible=False
        )
        self.restore.on_click(guarded(self._restore))
        self.results = SweepResults(self.desk)
        self.point = gui.add_dropdown(
            "Point", (NONE,), visible=False, hint="What Keep point as variant keeps"
        )
        hint = "Under the name of sweep and value"
        self.keep = gui.add_button("Keep point as variant", hint=hint, visible=False)
        self.keep.on_click(guarded(self._keep))

    def refresh(self) -> None:
        """Offer what the design that stands has."""
        design = self.desk.session.design
        if design.family != self.family:
            self.family = design.family
            known = sweep_fields(self.desk.session.state)
            self.fields = {field.title: field for field in known}
            offer(self.field, (NONE, *self.fields))

    def _suggest(self, event: Any) -> None:
        """A span about the value that stands, within the range of the parameter."""
        field = self.fields.get(self.field.value)
        if field is None:
            return
        now = field_value(self.desk.session.state, field.path)
        width = 0.3 * (abs(now) or field.high - field.low)
        width = max(width, 1.0) if field.whole else width
        digits = 0 if field.whole else 4
        self.start.value = round(max(field.low, now - width), digits)
        self.stop.value = round(min(field.high, now + width), digits)

    def _offer(self) -> None:
        names = (NONE, *list_sweeps(self.project))
        offer(self.choice, names, preferred=self.run.sweep.name if self.run.sweep else "")

    def _begin(self, event: Any) -> None:
        self._refuse_two()
        field = self.fields.get(self.field.value)
        if field is None:
            raise DesignError("no parameter is chosen", hint="choose one, then run the sweep")
        name = numbered(field.path.rpartition(".")[2], list_sweeps(self.project), first=1)
        sweep = make_sweep(
            name,
            self.desk.session.state,
            field.path,
            Span(
                start=float(self.start.value),
                stop=float(self.stop.value),
                steps=int(self.steps.value),
            ),
            parts=bool(self.parts.value),
        )
        save_sweep(self.project, sweep)
        self.run.open(sweep)
        self._offer()
        self._go()

    def _refuse_two(self) -> None:
        if self.run.busy:
            raise DesignError("a sweep runs already", hint="wait for it, or press Cancel sweep")

    def _open(self, event: Any) -> None:
        name = self.choice.value
        if self.run.busy or (self.run.sweep is not None and self.run.sweep.name == name):
            # The one that runs stays on show: its points come one by one.
            self._offer()
            return
        self.run.open(None)
        self.progress.content = ""
        try:
            if name != NONE:
                self.run.open(load_sweep(self.project, name))
        finally:
            # One that cannot be read can be deleted all the same.
            self._follow()

    def _delete(self, event: Any) -> None:
        self._refuse_two()
        name = self.choice.value
        self.trashed = delete_sweep(self.project, name)
        self.desk.log(f"sweep {name} moved to the trash")
        self.restore.visible = True
        self._close()

    def _restore(self, event: Any) -> None:
        self._refuse_two()
        self.restore.visible = False
        name = restore_sweep(self.project, self.trashed)
        self._offer()
        self.choice.value = name

    def _close(self) -> None:
        """Show no sweep, and offer those that there are."""
        self.run.open(None)
        self.progress.content = ""
        self._offer()
        self.choice.value = NONE
        self._follow()

    def _resume(self, event: Any) -> None:
        self._refuse_two()
        self._go()

    def _go(self) -> None:
        self.run.start()
        if self.run.left:
            threading.Thread(target=self._tell, name="sweep", daemon=True).start()

    def _tell(self) -> None:
        """Say how far the sweep is until it ends."""
        while self.run.left:
            with self.desk.reports.lock:
                words = self.run.words()
                if words:
                    self.progress.content = words
            time.sleep(TELL_S)

    def _follow(self) -> None:
        """Show the sweep as it stands."""
        sweep, store, busy = self.run.sweep, self.desk.session.store, self.run.busy
        open_points = [] if sweep is None else todo(sweep, store)
        values = [] if sweep is None else [f"{p.value:.6g}" for p in sweep.points if p.figures]
        self.cancel.visible = busy
        self.resume.visible = bool(open_points) and not busy
        self.delete.visible = self.choice.value != NONE and not busy
        for handle in (self.point, self.keep):
            handle.visible = bool(values)
        offer(self.point, tuple(values) or (NONE,))
        self.results.load(sweep)
        if self.run.ending:
            self.progress.content = self.run.ending

    def shown(self) -> tuple[Sweep | None, str]:
        """The sweep on show and the figure that it is plotted by."""
        return self.run.sweep, self.results.chosen()

    def _keep(self, event: Any) -> None:
        sweep = self.run.sweep
        if sweep is None or self.point.value == NONE:
            raise DesignError("no point is chosen", hint="run a sweep, then choose a point")
        name = f"{sweep.name} at {self.point.value}"
        state = point_state(sweep, self.point.value)
        save_variant(self.project, name, state, tags=(sweep.name,))
        self.desk.log(f"variant {name} saved")
        self.on_keep(name)
