"""What came of a calibration: scores in words, photographs beside predictions, the lights."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.colours import AMBER
from ui.page.imaging import placeholder, table
from ui.page.offer import offer
from workbench.calibration.seen.photo_set import TABLE
from workbench.core.base.errors import DesignError
from workbench.photographs.calls import OF
from workbench.photographs.kept_photos import KeptPhotos
from workbench.photographs.outcome import CALIBRATED, Outcome, lights, read_outcome, summary
from workbench.photographs.pictures import strip
from workbench.system.names import NONE

BALL_MM = 0.7
"""Radius of a light's mark in the 3D view [mm]."""
HEAD = ("photo", "depth mm", "dB", "no contact", "polynomial", "repeat")
OLD = (
    f"<span style='color:{AMBER}'>Of the photographs as they were before: *Calibrate* again.</span>"
)


class OutcomeFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk, kept: KeptPhotos) -> None:
        self.desk, self.kept = desk, kept
        self.found: Outcome | None = None
        self._nodes: list[Any] = []
        gui, guarded = desk.server.gui, desk.guarded
        self.folder = gui.add_folder("Calibrated", visible=False)
        with self.folder:
            self.said = gui.add_markdown("")
            hint = "The design in the fitted light, as the sensor that was built; Undo goes back"
            use = gui.add_button("Use calibrated design", icon=viser.Icon.CHECK, hint=hint)
            use.on_click(guarded(self._use))
            hint = "Photograph, prediction, and their difference twice as strong"
            self.choice = gui.add_dropdown("Prediction of", (NONE,), hint=hint)
            self.choice.on_update(guarded(lambda event: self._draw()))
            self.image = gui.add_image(placeholder(), format="jpeg")
            self.about = gui.add_markdown("")
            with gui.add_folder("Scores and depths", expand_by_default=False):
                self.scores = gui.add_html("")
            with gui.add_folder("Lights found", expand_by_default=False):
                hint = "Balls in their colours, where the lights are"
                self.marks = gui.add_checkbox("Show lights in 3D", False, hint=hint)
                self.marks.on_update(guarded(lambda event: self._mark()))
                self.lights = gui.add_html("")
            hint = "Every photograph beside its prediction, as one page"
            report = gui.add_button("Download report", icon=viser.Icon.DOWNLOAD, hint=hint)
            report.on_click(guarded(self._report))
            hint = "Calibrated design, its unit, predictions, figures and report"
            whole = gui.add_button("Download calibration (zip)", hint=hint)
            whole.on_click(guarded(self._archive))

    def refresh(self) -> None:
        """Show the calibration that lies in the project, if there is one."""
        before, self.found = self.found, read_outcome(self.kept.out)
        self.folder.visible = self.found is not None
        if self.found is None:
            self.marks.value = False
            return
        lines = summary(self.found)
        self.said.content = "\n\n".join([*lines, *([] if self._fresh() else [OLD])])
        if before is not None and before.figures == self.found.figures:
            return
        photos = self.found.photos
        self.scores.content = table(HEAD, [score_row(each) for each in photos.values()])
        self.lights.content = lights_table(self.found)
        # The worst first: it tells most.
        names = sorted(photos, key=lambda name: photos[name]["psnr_dB"])
        offer(self.choice, names)
        self._draw()
        self._mark()

    def _fresh(self) -> bool:
        """Whether the photographs are those that it was made from."""
        try:
            return (self.kept.out / OF).read_bytes() == (self.kept.folder / TABLE).read_bytes()
        except OSError:
            return False

    def _there(self) -> Outcome:
        if self.found is None:
            raise DesignError("there is no calibration yet", hint="press Calibrate")
        return self.found

    def _draw(self) -> None:
        found, name = self.found, self.choice.value
        if found is None or name not in found.photos:
            return
        try:
            photo = self.kept.image(name)
        except DesignError:
            self.about.content = "The photograph itself is gone."
            return
        self.image.image = strip(photo, found.predicted(name))
        self.about.content = score_words(found.photos[name])

    def _mark(self) -> None:
        """Show the lights as balls, or take them away."""
        for node in self._nodes:
            node.remove()
        self._nodes = []
        if not self.marks.value or self.found is None:
            return
        for name, place_mm, power in lights(self.found):
            strongest = max(*power, 1e-9)
            red, green, blue = (round(255.0 * value / strongest) for value in power)
            self._nodes.append(
                self.desk.server.scene.add_icosphere(
                    f"/calibration/{name}",
                    radius=BALL_MM,
                    color=(red, green, blue),
                    position=place_mm,
                    subdivisions=2,
                )
            )

    def _use(self, event: Any) -> None:
        design = self._there().design()
        self.desk.session.replace_design(design)
        self.desk.replaced()
        self.desk.log(f"design {design.name} opened")
        words = f"{design.name}: images now show the sensor that was built"
        self.desk.reports.notify("Calibrated design", words, color="green")

    def _name(self) -> str:
        return self.desk.session.design.name.removesuffix(CALIBRATED)

    def _report(self, event: Any) -> None:
        content = self._there().report()
        event.client.send_file_download(
            f"{self._name()}-calibration.html", content, save_immediately=True
        )

    def _archive(self, event: Any) -> None:
        content = self._there().archive()
        event.client.send_file_download(
            f"{self._name()}-calibration.zip", content, save_immediately=True
        )


def score_row(each: Mapping[str, Any]) -> tuple[str, ...]:
    """A line of the table."""
    name = each["photo"] + (", held out" if each["held_out"] else "")
    names = ("psnr_dB", "null_psnr_dB", "polynomial_psnr_dB", "repeat_psnr_dB")
    return (name, f"{each['depth_mm']:.2f}", *(f"{each[value]:.1f}" for value in names))


def score_words(each: Mapping[str, Any]) -> str:
    """The score of one photograph, beside what nothing would give."""
    held = "held out, " if each["held_out"] else ""
    return (
        f"Photograph, prediction, difference: {held}pressed {each['depth_mm']:.2f} mm deep, "
        f"**{each['psnr_dB']:.1f} dB** (no contact {each['null_psnr_dB']:.1f}, polynomial "
        f"{each['polynomial_psnr_dB']:.1f})."
    )


def lights_table(found: Outcome) -> str:
    """Places and powers of the lights."""
    rows = [
        (name, ", ".join(f"{x:.1f}" for x in place_mm), *(f"{value:.2f}" for value in power))
        for name, place_mm, power in lights(found)
    ]
    return table(("light", "place mm", "red", "green", "blue"), rows)
