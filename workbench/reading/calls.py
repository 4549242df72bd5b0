"""What the page asks about photographs of touch: one read, or the next frame of a camera.

They are answered in a lane, which keeps the open reader from one photograph to the next: the first
takes the seconds that the light of the design takes.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.live.preview_call import OwnCall
from workbench.photographs.photo_files import decoded
from workbench.pipeline.store import Store
from workbench.reading.camera_frames import CameraFrames
from workbench.reading.kept_readings import IDLE
from workbench.reading.shown_reading import Look, ShownReading, Told, turned

READING, CAMERA = "reading", "camera"
"""The jobs."""
_READER, _FRAMES = "open reader", "open camera"
"""Names by which a lane keeps them."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ReadPhoto(OwnCall):
    """One photograph of a folder; a `PreviewCall`."""

    design: SensorDesign
    folder: Path
    photo: str
    out: Path

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "reading a photo"

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> ShownReading:
        """Read it, and write what `workbench read` writes of it.

        Raises:
            DesignError: If a file is gone, has another size or is saturated.
            WorkbenchError: From the stages that mesh and trace.
        """
        from workbench.reading.outputs import write_reading

        reader = _reader(self.design, self.folder, store, kept, part(monitor, 0.0, 0.9))
        image = _image(self.folder, self.photo)
        found = reader.read(self.photo, image, video=False)
        write_reading(self.out, Path(self.photo).stem, found)
        return shown(reader, image, found)


@dataclass(frozen=True, kw_only=True, slots=True)
class ReadFrame(OwnCall):
    """The next frame of a camera or a video; a `PreviewCall`."""

    design: SensorDesign
    folder: Path
    """Where the photograph at rest lies."""
    source: str
    """As `CameraFrames` takes it."""
    project: Path

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "reading a frame"

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> ShownReading | None:
        """Read it; it begins where the frame before ended. None where a video is over.

        Raises:
            DesignError: If the source does not open or its frames have another size.
            WorkbenchError: From the stages that mesh and trace.
        """
        reader = _reader(self.design, self.folder, store, kept, part(monitor, 0.0, 0.9))
        image = _frames(self.source, self.project, kept).next()
        if image is None:
            kept.pop(_FRAMES)
            return None
        return shown(reader, image, reader.read(self.source, image, video=True))


@dataclass(frozen=True, kw_only=True, slots=True)
class TakeIdle(OwnCall):
    """The mean of some frames of the untouched sensor; a `PreviewCall`."""

    source: str
    project: Path

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "taking the idle photo"

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> np.ndarray:
        """Shape (H, W, 3), uint8.

        Raises:
            DesignError: If the source does not open or gives no frame.
        """
        return _frames(self.source, self.project, kept).mean()


class _LaneReader:
    """The open reader of a lane, and what its last frame said."""

    def __init__(self, key: str, opened: Any) -> None:
        self.key, self.opened = key, opened
        self._before: Any = None

    def read(self, name: str, image: np.ndarray, *, video: bool) -> Any:
        """A `Reading` of an image (H, W, 3), uint8."""
        from workbench.reading.read_photo import read_photo

        found = read_photo(self.opened, name, image, self._before if video else None)
        self._before = found.touch if video else None
        return found


def _reader(
    design: SensorDesign, folder: Path, store: Store, kept: dict[str, Any], monitor: Monitor
) -> _LaneReader:
    """The reader of the lane, opened anew for another design or another photograph at rest."""
    from workbench.pipeline.devices import open_device

    open_device()
    from workbench.reading.design_reader import open_reader

    idle = _image(folder, IDLE)
    key = digest((design, idle))
    now: _LaneReader | None = kept.get(_READER)
    if now is None or now.key != key:
        now = _LaneReader(key, open_reader(design, idle, store, monitor=monitor))
        kept[_READER] = now
    return now


def _frames(source: str, project: Path, kept: dict[str, Any]) -> CameraFrames:
    """The camera of the lane, opened anew for another source."""
    now: CameraFrames | None = kept.get(_FRAMES)
    if now is None or now.source != source:
        kept[_FRAMES] = now = CameraFrames(source, project)
    return now


def _image(folder: Path, name: str) -> np.ndarray:
    try:
        return decoded(name, (folder / name).read_bytes())
    except OSError as error:
        raise DesignError(
            f"{name} cannot be read: {error.strerror or error}",
            hint="load the photographs again; the sensor with nothing on it is idle.png",
        ) from error


def shown(lane: _LaneReader, image: np.ndarray, found: Any) -> ShownReading:
    """What the page shows of a reading."""
    from sim.reading.maps import seen_by_pixels, touched

    reader = lane.opened.reader
    skin, touch, maps = reader.rest.skin, found.touch, found.maps
    moved_mm = skin.points_mm + reader.displaced_mm(touch)
    tilt = _degrees(np.einsum("vc,vc->v", found.normals, skin.inward))
    told = {
        Look.DEPTH: Told(pixels=maps.depth_mm, vertices=touch.inward_mm),
        Look.TILT: Told(pixels=seen_by_pixels(reader, touch, tilt)[:, :, 0], vertices=tilt),
        Look.CONTACT: Told(
            pixels=maps.contact.astype(np.float32), vertices=touched(touch).astype(np.float32)
        ),
        Look.DEVIATION: Told(pixels=maps.sigma_mm, vertices=touch.sigma_mm),
    }
    return ShownReading(
        name=found.photo,
        image=image,
        figures=found.figures,
        skin=turned(lane.opened.mesh.seen, moved_mm, -found.normals),
        place_mm=seen_by_pixels(reader, touch, moved_mm),
        told=told,
    )


def _degrees(cosine: np.ndarray) -> np.ndarray:
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
