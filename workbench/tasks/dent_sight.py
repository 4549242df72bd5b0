"""The dent in a photograph, read by the design's own light: what a shape is told by.

A picture of a contact differs from place to place with the light there; the dent does not, and it
is the same in another light once the light is known. Nothing is learned for it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from workbench.core.base.monitor import silent
from workbench.core.design.design import SensorDesign
from workbench.pipeline.devices import open_device
from workbench.pipeline.store import Store
from workbench.tasks.networks.patch import GREY_PER_MM
from workbench.twin.first_camera import seen_at

if TYPE_CHECKING:
    # It needs the device that reading opens.
    from workbench.reading.design_reader import DesignReader


class DentSight:
    """Reads dents of one design's first camera; a reader of each photograph at rest is kept."""

    def __init__(self, design: SensorDesign, store: Store) -> None:
        """Take whose light it is.

        Args:
            design: Nominal or calibrated.
            store: Keeps mesh and light.
        """
        self._design, self._store = design, store
        self._readers: dict[bytes, DesignReader] = {}

    def __reduce__(self) -> tuple[type[DentSight], tuple[SensorDesign, Store]]:
        """As it goes to another process: without the readers that it has opened."""
        return DentSight, (self._design, self._store)

    def dent_grey(self, photo: np.ndarray, idle: np.ndarray) -> np.ndarray:
        """Inward displacement that each pixel sees, `GREY_PER_MM` for a millimetre.

        Args:
            photo: Of the touched sensor, shape (H, W, 3), uint8.
            idle: Of the untouched one, of the same size.

        Returns:
            Shape (H, W, 3), int16, three times the same; 0 where no skin is seen.

        Raises:
            DesignError: If either is saturated.
            WorkbenchError: From the stages that mesh and trace.
        """
        from workbench.reading.read_photo import read_photo

        found = read_photo(self._reader(idle), "a photograph", photo)
        grey = np.rint(GREY_PER_MM * np.nan_to_num(found.maps.depth_mm)).astype(np.int16)
        return np.repeat(grey[..., None], 3, axis=2)

    def _reader(self, idle: np.ndarray) -> DesignReader:
        from workbench.reading.design_reader import open_reader

        key = idle.tobytes()
        if key not in self._readers:
            open_device()
            height_px, width_px = idle.shape[:2]
            sized = seen_at(self._design, width_px, height_px)
            self._readers[key] = open_reader(sized, idle, self._store, monitor=silent)
        return self._readers[key]
