"""The photographs' contacts on the skin, and light that is drawn there and fitted to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.raster.display import light_of, shown
from workbench.calibration.ball_presses import BallPress, carried
from workbench.calibration.light_basis import LightBasis, around, open_basis
from workbench.calibration.powers import Powers, Targets, fit_powers
from workbench.calibration.seen.drift import SeenPhoto, shifted
from workbench.calibration.seen.photo_set import PhotoSet
from workbench.calibration.seen.seen_places import SeenPlaces
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import Lamp
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.store import Store


@dataclass(frozen=True, kw_only=True, slots=True)
class Contacts:
    """All photographs with their contacts, and the presses there."""

    seen: Sequence[SeenPhoto]
    presses: Sequence[BallPress]


@dataclass(frozen=True, kw_only=True, slots=True)
class Light:
    """Lights alone, with their powers."""

    basis: LightBasis
    powers: Powers


@dataclass(frozen=True, kw_only=True, slots=True)
class Work:
    """What all steps read."""

    design: SensorDesign
    photos: PhotoSet
    store: Store
    mesh: MembraneMesh
    solved: tuple[BallPress, ...]
    """Of all photographs, where they were solved."""

    @property
    def fitted(self) -> list[int]:
        """Numbers of the photographs that are fitted to."""
        return [k for k, each in enumerate(self.photos.photos) if not each.held_out]

    def light(self, contacts: Contacts, lights: Sequence[Lamp], monitor: Monitor) -> Light:
        """Lights alone, with the powers that fit best."""
        pairs = [(contacts.presses[k], contacts.seen[k].circle) for k in self.fitted]
        traced, solving = part(monitor, 0.0, 0.9), part(monitor, 0.9, 1.0)
        basis = open_basis(self.design, self.mesh, lights, pairs, self.store, traced)
        return self.powers(contacts, basis, solving)

    def powers(self, contacts: Contacts, basis: LightBasis, monitor: Monitor) -> Light:
        """The powers that fit best."""
        sensor = self.design.optics.camera.sensor
        targets = self.targets(contacts.seen, basis)
        return Light(basis=basis, powers=fit_powers(basis, targets, sensor, monitor))

    def targets(self, seen: Sequence[SeenPhoto], basis: LightBasis) -> Targets:
        """The photographs at the samples of a basis."""
        sensor, idle = self.design.optics.camera.sensor, self.photos.idle.astype(np.float64)
        flat = idle.reshape(-1, 3)
        at_rest = around(light_of(flat / 255.0, sensor), idle.shape[1])
        return Targets(
            idle=255.0 * shown(at_rest[basis.rest_pixel], sensor),
            presses=[
                (seen[k].at_rest.reshape(-1, 3)[samples.pixel], flat[samples.pixel])
                for k, samples in zip(self.fitted, basis.presses, strict=True)
            ],
        )

    def where_seen(self, seen: Sequence[SeenPhoto], places: SeenPlaces) -> Contacts:
        """Contacts where the camera of the design sees them, wherever a stage says they are."""
        presses = [
            press if one.photo.place_mm is None else self._carried(press, one, places)
            for press, one in zip(self.solved, seen, strict=True)
        ]
        return Contacts(seen=seen, presses=presses)

    def moved(self, seen: Sequence[SeenPhoto], away_px: np.ndarray, places: SeenPlaces) -> Contacts:
        """Contacts moved along columns and rows, (J, 2) of the fitted ones.

        Held-out photographs share what is common to all: how circles are drawn or found.
        """
        shifts = dict.fromkeys(range(len(seen)), np.median(away_px, axis=0))
        shifts.update(zip(self.fitted, away_px, strict=True))
        there = [shifted(each, shifts[k], self.photos.idle) for k, each in enumerate(seen)]
        presses = [
            self._carried(press, one, places) for press, one in zip(self.solved, there, strict=True)
        ]
        return Contacts(seen=there, presses=presses)

    def _carried(self, press: BallPress, one: SeenPhoto, places: SeenPlaces) -> BallPress:
        there = places.place(one.circle, one.photo.name)
        return carried(press, one.photo, there, self.mesh)
