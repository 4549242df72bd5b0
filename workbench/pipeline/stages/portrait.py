"""The stage `portrait`: the membrane at rest, small, for lists."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.result.results import Picture, Solid
from workbench.pipeline.stage import Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class PortraitInputs:
    """What is drawn."""

    solid: Solid


def portrait(given: PortraitInputs, *, monitor: Monitor) -> Picture:
    """The drawing; a DeviceError where nothing can render."""
    from geometry.picture.portraits import at_rest

    return Picture(png=at_rest(given.solid))


STAGE = Stage(
    name="portrait", label="Thumbnail", version=1, place=21, lane="cad", run=portrait, shown=False
)
