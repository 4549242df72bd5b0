"""The folder of sweeps: one number in steps, computed in the background, as plot and images."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

import viser

from ui.desk import Desk
from ui.header import NAMES
from ui.panels.sweep_results import SweepResults
from ui.panels.variants import offer
from workbench.comparison_report import point_state
from workbench.core.errors import Cancelled, DesignError, WorkbenchError
from workbench.core.units import human_seconds
from workbench.names import numbered
from workbench.requests import Finished
from workbench.sweep_fields import SweepField, field_value, sweep_fields
from workbench.sweep_files import (
    delete_sweep,
    list_sweeps,
    load_sweep,
    restore_sweep,
    save_sweep,
)
from workbench.sweeps import (
    FEWEST,
    MOST,
    Status,
    Sweep,
    done,
    failed,
    make_sweep,
    refusal,
    seconds_left,
    state_at,
    todo,
)
from workbench.variants import save_variant

NONE = "-"
TOPIC = "sweep"
TELL_S = 0.5
"""Between two looks at how far a sweep is [s]."""


class SweepFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk, on_keep: Callable[[str], None]) -> None:
        self.desk = desk
        self.project = desk.session.project
        self.on_keep = on_keep
        """Told the name of a variant that a point was kept as."""
        self.sweep: Sweep | None = None
        self.running: int | None = None
        """Number of the point that is computed."""
        self.left: list[int] = []
        """Points to compute, the running one first."""
        self.began = 0.0
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
        self.cancel.on_click(guarded(lambda event: self.desk.conductor.stop(TOPIC)))

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
        offer(self.choice, names, preferred=self.sweep.name if self.sweep else "")

    def _begin(self, event: Any) -> None:
        self._refuse_two()
        field = self.fields.get(self.field.value)
        if field is None:
            raise DesignError("no parameter is chosen", hint="choose one, then run the sweep")
        name = numbered(field.path.rpartition(".")[2], list_sweeps(self.project), first=1)
        self.sweep = make_sweep(
            name,
            self.desk.session.state,
            field.path,
            start=float(self.start.value),
            stop=float(self.stop.value),
            steps=int(self.steps.value),
            parts=bool(self.parts.value),
        )
        save_sweep(self.project, self.sweep)
        self._offer()
        self._go()

    def _refuse_two(self) -> None:
        if self.running is not None:
            raise DesignError("a sweep runs already", hint="wait for it, or press Cancel sweep")

    def _open(self, event: Any) -> None:
        name = self.choice.value
        if self.running is not None or (self.sweep is not None and self.sweep.name == name):
            # The one that runs stays on show: its points come one by one.
            self._offer()
            return
        self.sweep, self.progress.content = None, ""
        try:
            if name != NONE:
                self.sweep = load_sweep(self.project, name)
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
        self.sweep = None
        self.progress.content = ""
        self._offer()
        self.choice.value = NONE
        self._follow()

    def _resume(self, event: Any) -> None:
        self._refuse_two()
        self._go()

    def _go(self) -> None:
        if self.sweep is None:
            return
        self.left = todo(self.sweep, self.desk.session.store)
        if self.left:
            threading.Thread(target=self._tell, name="sweep", daemon=True).start()
        self._next()

    def _next(self) -> None:
        """Ask for the next point; values that the design refuses fail at once."""
        while self.sweep is not None and self.left:
            number = self.left[0]
            error = refusal(self.sweep, number)
            if error is None:
                self.running, self.began = number, time.monotonic()
                state, wanted = state_at(self.sweep, number), self.sweep.wanted
                self._follow()
                self.desk.jobs.submit(TOPIC, state.design, state.case, wanted, self._ended)
                return
            self._take(failed(self.sweep, number, error))
        self.running = None
        self._follow()
        if self.sweep is not None:
            fails = sum(point.status is Status.FAILED for point in self.sweep.points)
            words = f", {fails} failed" if fails else ""
            self.progress.content = f"Finished: {len(self.sweep.points)} points{words}."

    def _ended(self, finished: Finished) -> None:
        """Take a point in and go on; a cancelled sweep keeps what it has."""
        number, self.running = self.running, None
        if self.sweep is None or number is None:
            return
        error = finished.error
        if isinstance(error, Cancelled):
            self.left = []
            self._follow()
            self.progress.content = "Stopped; *Resume sweep* goes on where it was."
            return
        try:
            if error is None:
                store = self.desk.session.store
                self._take(done(self.sweep, number, store, finished.seconds))
            else:
                self._take(failed(self.sweep, number, error))
        except WorkbenchError as broken:
            self._take(failed(self.sweep, number, broken))
        self._next()

    def _take(self, sweep: Sweep) -> None:
        self.sweep, self.left = sweep, self.left[1:]
        save_sweep(self.project, sweep)

    def _tell(self) -> None:
        """Say how far the sweep is until it ends."""
        while self.left:
            with self.desk.reports.lock:
                words = self._words()
                if words:
                    self.progress.content = words
            time.sleep(TELL_S)

    def _words(self) -> str:
        """How far the sweep is, and how long it still takes; "" between two points."""
        if self.sweep is None or self.running is None:
            return ""
        eta_s = seconds_left(self.sweep, len(self.left), time.monotonic() - self.began)
        ends = f", about {human_seconds(eta_s)} left" if eta_s is not None else ""
        now = self.desk.jobs.running.get(TOPIC)
        name = "" if now is None else NAMES.get(now.stage, now.stage)
        stage = "" if now is None else f" · {name} {100.0 * now.fraction:.0f} %"
        count = len(self.sweep.points)
        return f"**{count - len(self.left) + 1} of {count}**{ends}{stage}"

    def _follow(self) -> None:
        """Show the sweep as it stands."""
        sweep, store = self.sweep, self.desk.session.store
        busy = self.running is not None
        open_points = [] if sweep is None else todo(sweep, store)
        values = [] if sweep is None else [f"{p.value:.6g}" for p in sweep.points if p.figures]
        self.cancel.visible = busy
        self.resume.visible = bool(open_points) and not busy
        self.delete.visible = self.choice.value != NONE and not busy
        for handle in (self.point, self.keep):
            handle.visible = bool(values)
        offer(self.point, tuple(values) or (NONE,))
        self.results.load(sweep)

    def shown(self) -> tuple[Sweep | None, str]:
        """The sweep on show and the figure that it is plotted by."""
        return self.sweep, self.results.chosen()

    def _keep(self, event: Any) -> None:
        if self.sweep is None or self.point.value == NONE:
            raise DesignError("no point is chosen", hint="run a sweep, then choose a point")
        name = f"{self.sweep.name} at {self.point.value}"
        state = point_state(self.sweep, self.point.value)
        save_variant(self.project, name, state, tags=(self.sweep.name,))
        self.desk.log(f"variant {name} saved")
        self.on_keep(name)
