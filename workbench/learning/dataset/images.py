"""The cameras of a data set: the sensor's first one, with and without markers on the skin."""

from __future__ import annotations

import dataclasses

import numpy as np

from workbench.core.design.optics import Optics
from workbench.core.result.force_field import ForceField
from workbench.core.result.light import LightField, NormalTable
from workbench.core.result.results import MembraneMesh
from workbench.report.image_files import png_bytes


class Cameras:
    """Two views of one sensor, opened once: without markers, and with those of the design."""

    def __init__(
        self, mesh: MembraneMesh, light: LightField, optics: Optics, table: NormalTable | None
    ) -> None:
        """Open both.

        Raises:
            DesignError: If the camera is outside the cavity or sees nothing of the skin.
            OpticsError: If no light reaches what the camera sees.
        """
        from sim.optics.studio.render import Studio

        self._inner_seen = bool(len(mesh.tips_mm))
        self._vertices = len(mesh.seen.points_mm)
        views = [
            dataclasses.replace(optics, markers=dataclasses.replace(optics.markers, visible=shown))
            for shown in (False, True)
        ]
        self._studios = [Studio(mesh, light, view, table=table) for view in views]

    def images(self, field: ForceField, frame: int) -> tuple[bytes, bytes]:
        """Images of one frame as PNG files, without and with markers.

        Raises:
            OpticsError: If a displacement is not finite.
        """
        seen = field.inner_mm if self._inner_seen else field.displacement_mm
        return self._shoot(seen[frame])

    def at_rest(self) -> tuple[bytes, bytes]:
        """Images of the undeformed skin."""
        return self._shoot(np.zeros((self._vertices, 3), np.float32))

    def _shoot(self, displacement_mm: np.ndarray) -> tuple[bytes, bytes]:
        plain, marked = (
            png_bytes(studio.images(displacement_mm[None])[0]) for studio in self._studios
        )
        return plain, marked
