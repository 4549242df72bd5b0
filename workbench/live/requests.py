"""What the browser asks of the pipeline, by job, and the events that tell how it goes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from workbench.core.base.errors import WorkbenchError
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.live.preview_call import PreviewCall
from workbench.pipeline.stage import Outcome

SHAPE = "shape"
"""The job of the body that follows the sliders."""
LIVE = "live"
"""The job of live presses: each request stops the one before."""
TOUCH = "touch"
"""The job of what follows the hand at once while a press is live."""
COMPLIANCE = "compliance"
"""The job of what live presses need of a skin, made while nothing else is asked for."""
IMAGE_PREVIEW = "image preview"
"""The job of the image preview that follows the sliders."""
FORESIGHT = "foresight"
"""The job of what will be refused."""
CUT = "cut"
"""The job of the section view."""
DRAWN = "drawn object"
"""The job of the object's shape in the 3D view."""
PREDICTION = "prediction"
"""The job of learned forces that nobody asked for: they follow a press that is done."""
FOLLOWING = (SHAPE, TOUCH, FORESIGHT, IMAGE_PREVIEW, CUT, DRAWN, PREDICTION)
"""Jobs too quick for a bar or a Cancel, unless one takes longer than `PATIENCE_S`."""
PATIENCE_S = 4.0
"""What follows the hand and still runs after this gives way to a newer request [s]."""
QUIET = (*FOLLOWING, LIVE, COMPLIANCE)
"""Jobs that follow the designer's hand: nothing is logged of them."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Request:
    """What to compute."""

    design: SensorDesign
    case: PressCase
    wanted: tuple[str, ...]
    preview: PreviewCall | None = None
    """What is asked for once the stages are stored."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Progress:
    """A running stage."""

    job: str
    stage: str
    fraction: float
    note: str
    eta_s: float | None
    seconds: float = 0.0
    """Since the request began [s]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class StageDone:
    """A stage that finished."""

    job: str
    outcome: Outcome
    request: Request


@dataclass(frozen=True, kw_only=True, slots=True)
class PreviewDone:
    """A preview that was answered."""

    job: str
    preview: Any
    request: Request


@dataclass(frozen=True, kw_only=True, slots=True)
class Finished:
    """A request that ended; `error` is None when all of it was computed."""

    job: str
    request: Request
    error: WorkbenchError | None
    seconds: float
    superseded: bool = False
    """Whether it was stopped for a newer request, which is nothing to tell the designer."""
    failed: str = ""
    """Stage that raised the error; empty without one, or when no stage had begun."""


Event = Progress | StageDone | PreviewDone | Finished
