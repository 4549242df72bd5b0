"""The stage `portrait`: thumbnails of the membrane at rest, for lists."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.result.results import Picture, Solid
from workbench.pipeline.stage import Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class ThumbnailInputs:
    """What is drawn."""

    solid: Solid


def thumbnail(given: ThumbnailInputs, *, monitor: Monitor) -> Picture:
    """The drawing; a DeviceError where nothing can render."""
    from geometry.drawing.thumbnails import at_rest

    return Picture(png=at_rest(given.solid))


STAGE = Stage(
    # Thumbnails lie in stores and in keys under this name.
    name="portrait",
    label="Thumbnail",
    version=1,
    place=21,
    lane="cad",
    run=thumbnail,
    shown=False,
)
