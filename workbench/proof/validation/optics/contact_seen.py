"""Whether a contact is seen at a glance: what a press of a ball changes in the image of a preset.

A ball of 6 mm, 1 mm deep, at the place where the family is usually touched; nothing is amplified.
The change is absolute, over pixels and colours, in 1.45 times the box of the contact. The DigiTac
is left out: its skin hides in the dark and its pins tell. Null: an image that shows no contact.
"""

from __future__ import annotations

import dataclasses
import functools
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from workbench.core.base.errors import OpticsError
from workbench.core.design.design import SensorDesign
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.sensing import TactileFrames
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, evaluate, plan
from workbench.project.aim import default_target_mm
from workbench.project.named_designs import load_design
from workbench.proof.row import Row, bounded

NAMES = ("finger", "geltip", "trunk", "paw", "thumb", "tentacle", "pad")
BALL_MM, DEPTH_MM = 6.0, 1.0
WIDER = 1.45
"""Sides of the box in which the change is looked at over those of the contact's."""
MEAN_GREY, MOST_GREY = 15.0, 60.0


class Change(NamedTuple):
    """Absolute change of grey levels about a contact."""

    mean_grey: float
    most_grey: float


def rows() -> list[Row]:
    """Two rows of each preset."""
    return [row for name in NAMES for row in _rows(name)]


def _rows(name: str) -> list[Row]:
    found = functools.cache(lambda: seen_change(pressed(load_design(name))))
    what = f"{name}: ball of {BALL_MM:g} mm, {DEPTH_MM:g} mm deep"
    return [
        bounded(
            "contact_seen",
            f"{what}, mean change",
            lambda: found().mean_grey,
            unit="grey",
            limit=MEAN_GREY,
            sense="min",
            null=0.0,
        ),
        bounded(
            "contact_seen",
            f"{what}, largest change",
            lambda: found().most_grey,
            unit="grey",
            limit=MOST_GREY,
            sense="min",
            null=0.0,
        ),
    ]


def pressed(design: SensorDesign) -> TactileFrames:
    """A design at rest and pressed, as its first camera sees it.

    Raises:
        WorkbenchError: From the stage that fails.
    """
    press = Press(target_mm=default_target_mm(design), depth_mm=DEPTH_MM, frames=1)
    case = PressCase(indenter=Indenter(size_mm=BALL_MM), press=press)
    with tempfile.TemporaryDirectory() as folder:
        store = Store(Path(folder))
        for _ in evaluate(design, case, InlineRunner(store), wanted=("shoot",)):
            pass
        frames = store.load("shoot", plan(design, case)["shoot"].key).frames
        # What is loaded is mapped from the folder, which goes.
        return dataclasses.replace(
            frames,
            rgb=np.array(frames.rgb),
            depth_z_mm=np.array(frames.depth_z_mm),
            moved=np.array(frames.moved),
        )


def seen_change(frames: TactileFrames) -> Change:
    """How much the last image differs from the one at rest, about the contact.

    Raises:
        OpticsError: If the camera sees no contact.
    """
    from sim.optics.studio.metrics import contact_box, contact_pixels

    box = contact_box(contact_pixels(frames, -1))
    if box is None:
        raise OpticsError("the camera does not see the contact", hint="turn or move it", at="")
    rows, columns = frames.rgb.shape[1:3]
    wide = _wider(box[0], rows), _wider(box[1], columns)
    change = np.abs(frames.rgb[-1][wide].astype(np.float64) - frames.rgb[0][wide])
    return Change(mean_grey=float(change.mean()), most_grey=float(change.max()))


def _wider(span: slice, size: int) -> slice:
    """A span made wider about its middle, inside the image."""
    middle, half = (span.start + span.stop) / 2.0, WIDER * (span.stop - span.start) / 2.0
    return slice(max(0, round(middle - half)), min(size, round(middle + half)))
