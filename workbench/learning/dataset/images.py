"""The cameras of a data set: the sensor's first one, with and without markers on the skin."""

from __future__ import annotations

import dataclasses
import io
from dataclasses import dataclass

import numpy as np

from workbench.core.design.optics import Optics
from workbench.core.result.force_field import ForceField
from workbench.core.result.light import LightField, NormalTable
from workbench.core.result.results import MembraneMesh
from workbench.report.image_files import png_bytes


@dataclass(frozen=True, kw_only=True, slots=True)
class Views:
    """What the camera sees of one frame."""

    png: bytes = b""
    """Image without markers as a PNG file."""
    png_markers: bytes = b""
    """The same with markers."""
    markers_px: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros((0, 2), np.float32))
    """u, v of the markers [px], shape (M, 2), float32; NaN where one is out of sight."""

    @property
    def markers_npy(self) -> bytes:
        """`markers_px` as an NPY file."""
        buffer = io.BytesIO()
        np.save(buffer, self.markers_px)
        return buffer.getvalue()


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
        self._plain, self._marked = (
            Studio(
                mesh,
                light,
                dataclasses.replace(
                    optics, markers=dataclasses.replace(optics.markers, visible=shown)
                ),
                table=table,
            )
            for shown in (False, True)
        )

    def views(self, field: ForceField, frame: int) -> Views:
        """Images and markers of one frame.

        Raises:
            OpticsError: If a displacement is not finite.
        """
        seen = field.inner_mm if self._inner_seen else field.displacement_mm
        return self.seen(seen[frame])

    def at_rest(self) -> Views:
        """Images and markers of the undeformed skin."""
        return self.seen(np.zeros((self._vertices, 3), np.float32))

    def image(self, displacement_mm: np.ndarray, *, marked: bool) -> np.ndarray:
        """One of both images of the skin moved by (V, 3) [mm], shape (H, W, 3), uint8.

        Raises:
            OpticsError: If a displacement is not finite.
        """
        studio = self._marked if marked else self._plain
        return studio.images(displacement_mm[None])[0]

    def seen(self, displacement_mm: np.ndarray) -> Views:
        """Images and markers of the skin that the camera looks at, moved by (V, 3) [mm].

        Raises:
            OpticsError: If a displacement is not finite.
        """
        plain = self._plain.images(displacement_mm[None])[0]
        marked, markers_px = self._marked.marked(displacement_mm)
        return Views(png=png_bytes(plain), png_markers=png_bytes(marked), markers_px=markers_px)
