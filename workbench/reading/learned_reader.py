"""The learned reader of a design in use: one photograph after the other, without tracing light."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.reading.network.reader_file import ReaderFile
from sim.reading.network.rest_view import RestView
from sim.reading.pixel_maps import PixelMaps, pressed
from workbench.core.design.camera import Camera
from workbench.core.result.results import MembraneMesh
from workbench.reading.design_reader import expect_light, expect_size
from workbench.reading.read_photo import known

ROW = 512
"""Vertices in a row, where maps are asked for at vertices."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LearnedReading:
    """Of one photograph."""

    photo: str
    maps: PixelMaps
    pressure_MPa: np.ndarray
    """Contact pressure by pixel, shape (H, W), float32; NaN where no skin is seen."""
    surface_mm: np.ndarray
    """Inward displacement of the vertices of the seen skin, shape (V,); 0 of unseen ones."""
    surface_sigma_mm: np.ndarray
    """Its standard deviation, shape (V,); NaN of unseen ones."""
    force_N: np.ndarray
    """On the membrane in the sensor frame, shape (3,)."""
    force_sigma_N: float
    """Standard deviation of its size."""
    contact_area_mm2: float
    ball_radius_mm: float
    """Of the ball that fits the dent; NaN where none does."""
    seconds: float

    @property
    def more(self) -> dict[str, np.ndarray]:
        """Further arrays of its file."""
        return {"pressure_MPa": self.pressure_MPa}

    @property
    def figures(self) -> dict[str, Any]:
        """What `reading.json` says of it; null where nothing is known."""
        return {
            "photo": self.photo,
            "peak_depth_mm": float(self.surface_mm.max(initial=0.0)),
            "contact_area_mm2": self.contact_area_mm2,
            "ball_radius_mm": known(self.ball_radius_mm),
            "force_N": [known(value) for value in self.force_N.tolist()],
            "force_sigma_N": known(self.force_sigma_N),
            "seconds": self.seconds,
        }


class LearnedReader:
    """Reads photographs of one sensor."""

    def __init__(
        self, reader: ReaderFile, camera: Camera, mesh: MembraneMesh, idle: np.ndarray, device: str
    ) -> None:
        """Open it.

        Args:
            reader: Weights that were learned for the design.
            camera: Of the design.
            mesh: Of the design.
            idle: Photograph of the untouched sensor, shape (H, W, 3), uint8.
            device: Where PyTorch computes.

        Raises:
            DesignError: If the photograph has another size than the camera's images, or is
                saturated.
        """
        from geometry.surface.surface import vertex_areas_mm2
        from sim.reading.network.predictor import Predictor, in_size

        self._camera = camera
        self._spec = reader.spec
        self._rest: RestView = reader.rest
        self._predictor = Predictor(reader, device)
        self._seen = _wide(reader.rest.sees, camera) > 0.5
        expect_size("the idle photo", idle, camera)
        expect_light("the idle photo", idle, self._seen.ravel())
        self._idle = in_size([idle], reader.spec.columns, reader.spec.rows)[0]
        self._normals = reader.rest.normals()
        self._points_mm = mesh.seen.points_mm
        self._inward = -np.asarray(mesh.seen.normals)
        self._areas_mm2 = vertex_areas_mm2(mesh.seen.points_mm, mesh.seen.faces)

    def read(self, name: str, photo: np.ndarray) -> LearnedReading:
        """Read a photograph (H, W, 3), uint8.

        Raises:
            DesignError: If it has another size or is saturated.
        """
        from sim.reading.ball import ball_radius_mm
        from sim.reading.network.predictor import in_size

        expect_size(name, photo, self._camera)
        expect_light(name, photo, self._seen.ravel())
        begun = time.perf_counter()
        told = self._predictor.read(
            self._idle, in_size([photo], self._spec.columns, self._spec.rows)
        )
        normal = _wide(self._normals + told.turn[0], self._camera)
        normal /= np.sqrt(np.maximum(np.einsum("hwc,hwc->hw", normal, normal), 1e-12))[:, :, None]
        normal[~self._seen] = np.nan
        sigma_mm = told.sigma_mm[0]
        surface_mm = self._at_vertices(told.surface_mm[0])
        surface_sigma_mm = self._at_vertices(sigma_mm)
        seconds = time.perf_counter() - begun
        seen = np.isfinite(surface_mm)
        surface_mm = np.nan_to_num(surface_mm)
        chosen = np.flatnonzero(seen & pressed(surface_mm, surface_sigma_mm))
        return LearnedReading(
            photo=name,
            maps=PixelMaps(
                depth_mm=self._shown(told.depth_mm[0]),
                normal=normal,
                contact=self._seen & (_wide(told.contact[0], self._camera) > 0.5),
                sigma_mm=self._shown(sigma_mm),
            ),
            pressure_MPa=self._shown(told.pressure_MPa[0]),
            surface_mm=surface_mm,
            surface_sigma_mm=surface_sigma_mm,
            force_N=told.force_N[0].astype(np.float64),
            force_sigma_N=float(told.force_sigma_N[0]),
            contact_area_mm2=float(self._areas_mm2[chosen].sum()),
            ball_radius_mm=ball_radius_mm(
                self._points_mm[chosen], self._inward[chosen], surface_mm[chosen]
            ),
            seconds=seconds,
        )

    def _shown(self, values: np.ndarray) -> np.ndarray:
        """A map in the camera's size, NaN where no skin is seen, (H, W), float32."""
        found = _wide(values, self._camera)
        found[~self._seen] = np.nan
        return found

    def _at_vertices(self, values: np.ndarray) -> np.ndarray:
        """A map at the vertices, where the camera sees them at rest, shape (V,); NaN elsewhere."""
        import cv2

        count = len(self._rest.vertex_px)
        # OpenCV's images have at most 32,767 rows.
        places = np.zeros((-(-count // ROW) * ROW, 2), np.float32)
        places[:count] = np.nan_to_num(self._rest.vertex_px) - 0.5
        u, v = (np.ascontiguousarray(places[:, k].reshape(-1, ROW)) for k in range(2))
        found = cv2.remap(
            values.astype(np.float32), u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        ).ravel()[:count]
        return np.where(np.isfinite(self._rest.vertex_px[:, 0]), found, np.nan).astype(np.float64)


def _wide(values: np.ndarray, camera: Camera) -> np.ndarray:
    """A map in the camera's size, float32."""
    import cv2

    size = (camera.width_px, camera.height_px)
    return cv2.resize(values.astype(np.float32), size, interpolation=cv2.INTER_LINEAR)
