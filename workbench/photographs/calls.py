"""What the browser asks the workers about photographs: where contacts are, and a calibration.

Both are calls of `workbench.live.preview_call`: they run in a lane that can be stopped. Contacts
come back through its pipe; a calibration is written into the project's folder, where the page finds
it again after a restart.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from workbench.calibration.seen.drift import NO_DRIFT, Drift, seen_contact
from workbench.calibration.seen.photo_set import IDLE, Circle
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.live.preview_call import OwnCall
from workbench.photographs.photo_files import decoded
from workbench.pipeline.store import Store
from workbench.system.whole_files import write_atomically

CONTACTS, CALIBRATION = "contacts", "calibration"
"""The jobs."""
OF = "photographs.csv"
"""Beside a calibration: the table that it was made from."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Found:
    """A contact, or why there is none."""

    photo: str
    circle: Circle | None
    reason: str = ""
    drift: Drift = field(default=NO_DRIFT, compare=False)


@dataclass(frozen=True, kw_only=True, slots=True)
class FindContacts(OwnCall):
    """The contacts of photographs in a folder; a `PreviewCall`."""

    folder: Path
    wanted: tuple[tuple[str, Circle | None], ...]
    """Names, and circles where they are known: of those only the drift is told."""

    @property
    def lane(self) -> str:
        """The worker that answers it."""
        return "look"

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "finding contacts"

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> tuple[Found, ...]:
        """Look for each contact; a photograph without one says so and holds nothing up.

        Raises:
            DesignError: If a file is gone or is no picture.
        """
        idle = _image(self.folder, IDLE)
        found = []
        for number, (name, circle) in enumerate(self.wanted):
            monitor(number / len(self.wanted), name)
            found.append(found_contact(name, _image(self.folder, name), idle, circle))
        return tuple(found)


@dataclass(frozen=True, kw_only=True, slots=True)
class Calibrate(OwnCall):
    """A calibration of a design to the photographs of a folder; a `PreviewCall`."""

    design: SensorDesign
    folder: Path
    held_out: tuple[str, ...]
    lights: str
    refining: str
    """As `workbench.calibration.calibrate` takes them."""
    out: Path

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "calibration"

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> Path:
        """Calibrate and write what comes of it; an earlier one stays until then."""
        from workbench.calibration.calibrate import calibrate
        from workbench.calibration.outputs import FILES, write_calibration
        from workbench.calibration.seen.photo_set import TABLE, read_photo_set
        from workbench.pipeline.devices import open_device
        from workbench.system.folder import prepare

        open_device()
        table = (self.folder / TABLE).read_bytes()
        photos = read_photo_set(self.folder, self.held_out)
        span = part(monitor, 0.0, 0.97)
        found = calibrate(
            self.design,
            photos,
            store,
            lights=self.lights,
            refining=self.refining,
            monitor=span,
        )
        monitor(0.97, "report")
        prepare(self.out, clear=FILES)
        write_calibration(self.out, found, photos.idle)
        write_atomically(self.out / OF, table)
        return self.out


def found_contact(name: str, image: np.ndarray, idle: np.ndarray, circle: Circle | None) -> Found:
    """The contact of a photograph (H, W, 3), looked for again once its drift is known."""
    try:
        circle, drift = seen_contact(name, image, idle, circle)
    except DesignError as error:
        return Found(photo=name, circle=None, reason=error.message)
    return Found(photo=name, circle=circle, drift=drift)


def _image(folder: Path, name: str) -> np.ndarray:
    try:
        return decoded(name, (folder / name).read_bytes())
    except OSError as error:
        raise DesignError(
            f"{name} cannot be read: {error.strerror or error}", hint="load it again"
        ) from error
