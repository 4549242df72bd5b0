"""The top of the left dock: name, stages, refusals, the builder's notice; and the running job."""

from __future__ import annotations

import html
from collections.abc import Callable, Collection, Mapping
from typing import Any

import viser

from ui.page.colours import AMBER
from ui.page.plain import plain
from ui.patches.leading import leading
from workbench.core.base.units import human_seconds
from workbench.core.design.design import SensorDesign
from workbench.live.requests import COMPLIANCE, FOLLOWING, LIVE, PATIENCE_S, SHAPE, Progress
from workbench.planning.stage_table import STAGES, label_of

WIDTH_PX = 220
"""Width of the panel of the running job; viser cuts the widgets of a narrower one at the right."""
MARGIN_PX = 4
"""From the panel to the dock on the right; notifications end 225 px from it at 1280 px."""
HOME_KEY = "o"
"""The key of the start page."""
WAIT_S = 3.0
"""A live press that takes longer than this is worth a bar and a Cancel."""


class Header:
    """Widgets that every page of the left dock has above it."""

    def __init__(self, gui: Any, *, on_cancel: Callable[[Any], None]) -> None:
        self.title = gui.add_html("")
        self.strip = gui.add_markdown("")
        self.headline = gui.add_html("")
        self.banner = gui.add_markdown("", visible=False)
        self.unsaved = gui.add_markdown("", visible=False)
        self.notice = gui.add_markdown("", visible=False)
        self.misfit = gui.add_markdown("", visible=False)
        hint = "LEDs, lamps and cameras that are in a wall or outside move to where there is room"
        self.fit = gui.add_button("Fit LEDs and camera to the body", visible=False, hint=hint)
        # A panel of its own: widgets must not move under the mouse when a job starts or ends.
        self.job_panel = gui.add_panel(visible=False)
        with self.job_panel.add_tab("Running", viser.Icon.LOADER):
            self.progress = gui.add_progress_bar(0.0, animated=True)
            self.progress_text = gui.add_markdown("")
            gui.add_button("Cancel", color="red", hint="Stop what runs (X)").on_click(on_cancel)
        gui.add_command("Cancel what runs", hotkey="X").on_trigger(on_cancel)
        # Notifications come in at the left; on a narrow page both find place side by side.
        self.job_panel.float(x=-MARGIN_PX, y=15, width=WIDTH_PX)

    def show_design(self, design: SensorDesign) -> None:
        """The way home, name and family."""
        home = leading("Start", {"key": HOME_KEY}, kind="home")
        names = f"<b>{html.escape(design.name)}</b> · {html.escape(design.family)}"
        text = f'<div class="design-title">{home}<span>{names}</span></div>'
        if self.title.content != text:
            self.title.content = text

    def show_stages(
        self,
        fresh: Mapping[str, bool],
        running: Mapping[str, Progress],
        *,
        begun: Collection[str] = (),
    ) -> None:
        """Which stages are done, stale or running; those begun have told nothing yet."""
        active = {*begun, *(progress.stage for progress in running.values())}
        marks = {True: "✓", False: "○"}
        text = "&nbsp; ".join(
            f"{record.label} {'▶' if stage in active else marks[fresh[stage]]}"
            for stage, record in STAGES.items()
            if record.on_strip and stage in fresh
        ).replace(" ✓", "&nbsp;✓")
        # Smaller, so that all of them stand on one row.
        text = f"<small>{text}</small>"
        if self.strip.content != text:
            self.strip.content = text

    def show_progress(self, running: Mapping[str, Progress]) -> None:
        """The newest job; what follows the hand is too quick to be worth a bar."""
        shown = [progress for job, progress in running.items() if _worth_a_bar(job, progress)]
        if self.job_panel.visible != bool(shown):
            self.job_panel.visible = bool(shown)
        if shown:
            now = shown[-1]
            self.progress.value = 100.0 * now.fraction
            left = f"about {human_seconds(now.eta_s)} left" if now.eta_s is not None else ""
            name = label_of(now.stage)
            # How far forces are from balance says nothing to who waits.
            note = now.note.partition(", residual ")[0]
            parts = (f"{name} {100 * now.fraction:.0f} %", left, plain(note))
            self.progress_text.content = " · ".join(part for part in parts if part)

    def show_notice(self, notices: Mapping[str, str]) -> None:
        """What builder and mesher had to change; nothing when they had to change nothing."""
        text = "<br>".join(plain(notice) for notice in notices.values() if notice)
        self.notice.visible = bool(text)
        self.notice.content = f"<span style='color:{AMBER}'>**Note:** {text}</span>"


def _worth_a_bar(job: str, progress: Progress) -> bool:
    if job == COMPLIANCE:
        # Nobody asked for it, and it stops at the first touch of anything.
        return False
    if job == LIVE:
        return progress.eta_s is not None and progress.eta_s > WAIT_S
    return job not in FOLLOWING or (job == SHAPE and progress.seconds > PATIENCE_S)
