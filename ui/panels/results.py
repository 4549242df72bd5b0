"""The right dock: tactile image, forces, log; and the timeline that steps through the frames."""

from __future__ import annotations

import html
import threading
import time
from typing import Any

import numpy as np
import viser
from viser import uplot

from ui.desk import Desk
from ui.imaging import difference, legend, placeholder
from ui.sensor import SKIN_COLOUR
from workbench.core.sensing import Contact, Shot
from workbench.outputs import force_balance

FRAME_S = 0.15
"""Time between frames while playing [s]."""
LOG_ROWS = 60
NO_IMAGE = "No press of this sensor yet: *Run press* makes an image."
NO_PRESS = "No press of this sensor yet."


class ResultsPanel:
    """Widgets of the right dock and the timeline."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.shot: Shot | None = None
        self.contact: Contact | None = None
        self.playing = threading.Event()
        self.stepping = False
        """Whether there are frames to step through."""
        self.covered = False
        """Whether parts or a mesh are looked at instead of the press."""
        gui = desk.server.gui
        self.dock = gui.add_panel()
        with self.dock.add_tab("Tactile image", viser.Icon.PHOTO):
            self.caption = gui.add_markdown(NO_IMAGE)
            self.image = gui.add_image(placeholder(), label="camera", format="jpeg")
            self.difference_text = gui.add_markdown("")
            self.difference = gui.add_image(placeholder(), label="difference", format="jpeg")
        with self.dock.add_tab("Forces", viser.Icon.CHART_LINE):
            self.force_text = gui.add_markdown(NO_PRESS)
            self.plot = gui.add_uplot(
                (np.zeros(2), np.zeros(2)),
                (
                    uplot.Series(label="depth mm"),
                    uplot.Series(label="normal N", stroke="#3b82f6", width=2),
                ),
                scales={"x": uplot.Scale(time=False)},
                title="Normal force [N] against depth [mm]",
                aspect=1.4,
            )
        with self.dock.add_tab("Log", viser.Icon.LIST):
            self.log = gui.add_html("")
        self.dock.dock_right()
        self.dock.set_width(350)
        self._timeline()

    def _timeline(self) -> None:
        gui = self.desk.server.gui
        self.timeline = panel = gui.add_panel(visible=False)
        with panel.add_tab("Timeline", viser.Icon.CLOCK):
            self.frame = gui.add_slider("Frame", 0, 1, 1, 0, hint="0 is the untouched skin")
            self.play = gui.add_button("Play / pause", icon=viser.Icon.PLAYER_PLAY)
            self.legend = gui.add_html("")
        panel.float(x=405, y=-15, width=380)
        self.frame.on_update(self.desk.guarded(lambda event: self._show_frame()))
        self.play.on_click(self.desk.guarded(self._toggle))
        command = gui.add_command("Play or pause", hotkey="P")
        command.on_trigger(self.desk.guarded(self._toggle))
        threading.Thread(target=self._play_forever, daemon=True).start()

    def _toggle(self, event: Any) -> None:
        if self.playing.is_set():
            self.playing.clear()
        else:
            self.playing.set()

    def _play_forever(self) -> None:
        while self.playing.wait():
            time.sleep(FRAME_S)
            count = int(self.frame.max)
            self.frame.value = (int(self.frame.value) + 1) % (count + 1)

    def _show_frame(self) -> None:
        number = int(self.frame.value)
        self.desk.scene.show_frame(number)
        self._show_image(number)
        self._show_forces(number)

    def _show_image(self, number: int) -> None:
        if self.shot is None:
            return
        rgb = self.shot.frames.rgb
        number = min(number, len(rgb) - 1)
        change, gain = difference(np.asarray(rgb[number]), np.asarray(rgb[0]))
        self._caption(number)
        with self.desk.server.atomic():
            self.image.image = np.asarray(rgb[number])
            self.difference_text.content = f"Difference to the background, × {gain}"
            self.difference.image = change

    def _caption(self, number: int) -> None:
        if self.shot is None:
            return
        last = len(self.shot.frames.rgb) - 1
        phase = "" if number <= self.desk.session.case.press.frames else ", shear and twist"
        what = f"frame {min(number, last)} of {last}{phase}" if number else "background"
        stale = "" if self.desk.current("shoot") else " · **stale**: render again"
        if self.caption.content != f"{what}{stale}":
            self.caption.content = f"{what}{stale}"

    def refresh(self) -> None:
        """Mark an image and a force that no longer belong to the state."""
        self._caption(int(self.frame.value))
        self._show_forces(int(self.frame.value))
        if not self.desk.current("press"):
            # There are no frames on the skin to step through.
            self.stepping = False
            self._offer_timeline()

    def show(self, stage: str, result: Any) -> None:
        """Follow results and the log."""
        if stage == "press":
            self._show_contact(result)
        elif stage == "shoot":
            self.shot = result
            self._follow_frames(len(result.frames.rgb) - 1)
            self._show_image(int(self.frame.value))
            self.desk.scene.show_frame(int(self.frame.value))
            camera = self.desk.session.design.optics.camera
            image = np.asarray(result.frames.rgb[int(self.frame.value)])
            self.desk.scene.rig.show_camera(camera, image[::4, ::4])
        elif stage == "sensor":
            self._blank()
        elif stage == "covered":
            self.covered = result
            self._offer_timeline()
            if not self.covered:
                self.desk.scene.show_frame(int(self.frame.value))
        elif stage == "log":
            rows = "<br>".join(html.escape(line) for line in reversed(result[-LOG_ROWS:]))
            self.log.content = f"<div style='font:12px monospace;margin:8px'>{rows}</div>"

    def _follow_frames(self, count: int) -> None:
        if int(self.frame.max) != count:
            self.frame.value = min(int(self.frame.value), count)
            self.frame.max = count
        self.frame.value = count
        self.stepping = True
        self._offer_timeline()

    def _offer_timeline(self) -> None:
        visible = self.stepping and not self.covered
        if self.timeline.visible != visible:
            self.timeline.visible = visible

    def _blank(self) -> None:
        """What was seen and felt belongs to another sensor."""
        self.shot = self.contact = None
        self.playing.clear()
        with self.desk.server.atomic():
            self.caption.content, self.force_text.content = NO_IMAGE, NO_PRESS
            self.difference_text.content = ""
            self.image.image = self.difference.image = placeholder()
            self.plot.data = (np.zeros(2), np.zeros(2))

    def _show_contact(self, contact: Contact) -> None:
        path = self.desk.session.case.press
        mesh = self.desk.session.result("mesh")
        top_mm = self.desk.scene.load_frames(mesh.outer, contact)
        self.legend.content = legend("Displacement of the skin", top_mm, "mm", SKIN_COLOUR)
        count = path.frames
        depth_mm = np.r_[0.0, path.depth_mm * np.arange(1, count + 1) / count]
        self.plot.data = (depth_mm, np.r_[0.0, contact.normal_N[:count]])
        self.contact = contact
        self._follow_frames(len(contact.reaction_N))
        self._show_forces(int(self.frame.value))
        self.desk.scene.show_frame(int(self.frame.value))

    def _show_forces(self, number: int) -> None:
        """The force of the frame on show; of the last one at frame 0."""
        contact = self.contact
        if contact is None:
            return
        count = len(contact.reaction_N)
        k = (number or count) - 1
        if k >= count:
            return
        x, y, z = contact.reaction_N[k]
        text = (
            f"**{contact.normal_N[k]:.3f} N** along the normal, frame {k + 1} of {count}\n\n"
            f"on the object: x {x:.3f} · y {y:.3f} · z {z:.3f} N\n\n"
            f"peak {contact.normal_N.max():.3f} N · residual {contact.residual.max():.1e} · force "
            f"balance {100 * force_balance(contact):.2f} % · friction ratio "
            f"≤ {contact.friction_ratio.max():.3f}"
        )
        if not self.desk.current("press"):
            text = f"**stale**: run the press again\n\n{text}"
        if self.force_text.content != text:
            self.force_text.content = text
