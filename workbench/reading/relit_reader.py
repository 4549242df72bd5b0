"""A built sensor read by the reader that was learned for its design as it was drawn.

Its photographs are relit (`relight`) and what the reader says is laid back onto their pixels. So a
calibrated sensor needs no training of its own. Vertices are those of the same skin in both. A gel
that was found to be stiffer or softer than drawn bears as much more or less in the same dent.
"""

from __future__ import annotations

import dataclasses
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from designs.family import families
from sim.reading.network.reader_file import ReaderFile
from workbench.calibration.stored import lit_studio, stored
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.store import Store
from workbench.project.named_designs import load_design, presets
from workbench.project.project import Project
from workbench.reading.design_reader import expect_light, expect_size, looked_up, open_reader
from workbench.reading.learned_reader import LearnedReader, LearnedReading
from workbench.reading.reader_digest import reader_digest
from workbench.reading.relight import Relight
from workbench.reading.same_places import SamePlaces
from workbench.system.names import is_name

if TYPE_CHECKING:
    # It needs the device that reading opens.
    from sim.reading.pixel_maps import PixelMaps
    from sim.reading.untouched import Untouched

LEAST_SHARED = 0.5
"""Share of the skin that the drawn camera sees which the built one has to see too."""
LESS_SURE = 1.5
"""Factor on the standard deviation of a depth: of what a calibration leaves the reader knows
nothing. With it 70 % of the errors in a calibrated finger's twin are within one, 55 in a pad's."""


def drawn_design(design: SensorDesign, project: Project) -> SensorDesign | None:
    """What a calibrated design was drawn as: of the same name, in the project or a preset.

    None where it is not calibrated, or there is none of that name that is not calibrated itself.

    Raises:
        DesignError: If its file in the project is not valid.
    """
    if design.optics.unit is None:
        return None
    if is_name(design.name):
        path = project.design_path(design.name)
        kept = load_design(path, project=project) if path.is_file() else None
        if kept is not None and kept.optics.unit is None:
            return kept
    if design.name in (*presets(), *families()):
        return load_design(design.name)
    return None


@dataclass(frozen=True, kw_only=True, slots=True)
class RelitReader:
    """Reads photographs of one built sensor."""

    built: Untouched
    relight: Relight
    reader: LearnedReader
    """Of the design as it was drawn."""
    back: SamePlaces
    """Where the drawn camera sees the places that the built one's pixels see."""
    stiffer: float
    """Young's modulus of the built one over that of the drawn one."""

    def read(self, name: str, photo: np.ndarray) -> LearnedReading:
        """Read a photograph (H, W, 3), uint8.

        Raises:
            DesignError: If it has another size or is saturated.
        """
        expect_size(name, photo, self.built.camera)
        expect_light(name, photo, self.built.sees)
        begun = time.perf_counter()
        found = self.reader.read(name, self.relight.photo(photo))
        visible = self.built.studio.visible
        return dataclasses.replace(
            found,
            surface_mm=np.where(visible, found.surface_mm, 0.0),
            surface_sigma_mm=np.where(visible, found.surface_sigma_mm, np.nan),
            maps=self._laid_back(found.maps),
            pressure_MPa=self.stiffer * self._of_seen(found.pressure_MPa),
            force_N=self.stiffer * found.force_N,
            force_sigma_N=self.stiffer * found.force_sigma_N,
            seconds=time.perf_counter() - begun,
        )

    def _laid_back(self, maps: PixelMaps) -> PixelMaps:
        """Maps on the pixels of the built sensor's camera."""
        normal = self._of_seen(maps.normal)
        normal /= np.linalg.norm(normal, axis=2, keepdims=True)
        return dataclasses.replace(
            maps,
            depth_mm=self._of_seen(maps.depth_mm),
            normal=normal,
            contact=self._of_seen(maps.contact.astype(np.float32)) > 0.5,
            sigma_mm=self._of_seen(maps.sigma_mm),
        )

    def _of_seen(self, values: np.ndarray) -> np.ndarray:
        """A map of the drawn camera on the built one's pixels; NaN where not both see the skin."""
        found = self.back.brought(values)
        found[~self.back.seen] = np.nan
        return found


def open_relit(
    pair: tuple[SensorDesign, SensorDesign],
    weights: ReaderFile,
    idle: np.ndarray,
    store: Store,
    *,
    monitor: Monitor,
    device: str,
) -> RelitReader:
    """Open the reader of a drawn design for a sensor that was built from it.

    Args:
        pair: The built sensor, calibrated, and its design as it was drawn.
        weights: What was learned for the latter.
        idle: Photograph of the built sensor untouched, shape (H, W, 3), uint8.
        store: Keeps mesh and light.
        monitor: Progress and cancellation.
        device: Where PyTorch computes.

    Raises:
        DesignError: If the photograph has another size than the camera's images, or the sensor was
            not built from the drawn design.
        WorkbenchError: From the stages that mesh and trace.
    """
    design, drawn = pair[0], _seen_as(pair[1], pair[0])
    _expect_same(design, drawn, weights)
    built = open_reader(design, idle, store, monitor=part(monitor, 0.0, 0.5)).reader.rest
    mesh = stored(drawn, PressCase(), "mesh", store, part(monitor, 0.5, 0.6))
    as_drawn, grey = _as_drawn(drawn, mesh, store, part(monitor, 0.6, 1.0))
    relight = Relight(built, as_drawn)
    shared = np.count_nonzero(relight.places.seen) / max(np.count_nonzero(as_drawn.sees), 1)
    if shared < LEAST_SHARED:
        raise DesignError(
            f"the built camera sees {100.0 * shared:.0f} % of the skin that the drawn one does; "
            f"at least {100.0 * LEAST_SHARED:.0f} % is needed",
            hint="train a reader for this one: `workbench reader train`, or use --reader table",
            at="optics.cameras",
        )
    return RelitReader(
        built=built,
        relight=relight,
        reader=LearnedReader(_less_sure(weights), drawn.optics.camera, mesh, grey, device),
        back=SamePlaces.of(built, as_drawn),
        stiffer=design.material.young_MPa / drawn.material.young_MPa,
    )


def _less_sure(weights: ReaderFile) -> ReaderFile:
    scales = weights.scales
    less = scales.with_factors(sigma=LESS_SURE * scales.sigma, force_sigma=scales.force_sigma)
    return dataclasses.replace(weights, scales=less)


def _expect_same(design: SensorDesign, drawn: SensorDesign, weights: ReaderFile) -> None:
    """Refuse a sensor that was not built from a drawn design, or whose images have another shape.

    Raises:
        DesignError: If it differs in more than light, camera and Young's modulus.
    """
    material = dataclasses.replace(design.material, young_MPa=drawn.material.young_MPa)
    as_drawn = dataclasses.replace(design, optics=drawn.optics, material=material)
    if not reader_digest(as_drawn) == reader_digest(drawn) == weights.digest:
        raise DesignError(
            f"{shown(drawn.name)} as it was drawn has another body, wall, material or shape of "
            "images than this sensor, or is calibrated itself",
            hint="name the design that was cast: --drawn FILE; or use --reader table",
            at="--drawn",
        )


def _seen_as(drawn: SensorDesign, built: SensorDesign) -> SensorDesign:
    """A drawn design whose first camera takes images of the built one's size."""
    size = built.optics.camera
    camera = dataclasses.replace(
        drawn.optics.camera, width_px=size.width_px, height_px=size.height_px
    )
    optics = dataclasses.replace(drawn.optics, camera=camera, cameras=())
    return dataclasses.replace(drawn, optics=optics)


def _as_drawn(
    drawn: SensorDesign, mesh: MembraneMesh, store: Store, monitor: Monitor
) -> tuple[Untouched, np.ndarray]:
    """A design as it was drawn, untouched, and its image at rest, (H, W, 3), uint8."""
    design = looked_up(drawn)
    studio = lit_studio(design, mesh, store, part(monitor, 0.0, 0.5), "light as it was drawn")
    from sim.optics.raster.display import shown as displayed
    from sim.reading.sight import at_rest
    from sim.reading.untouched import open_untouched

    camera = design.optics.camera
    light = at_rest(studio).light * studio.exposure.reshape(-1, 3)
    grey = np.round(255.0 * displayed(light, camera.sensor)).reshape(*studio.imager.shape, 3)
    idle = grey.astype(np.uint8)
    return open_untouched(studio, camera, idle, monitor=part(monitor, 0.5, 1.0)), idle
