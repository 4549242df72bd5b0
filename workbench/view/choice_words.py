"""What designers read for each choice of a design or a press; files keep the technical names.

A light model is called what the first line of its file begins with, up to the colon. Of a member
without words the underscores go.
"""

from __future__ import annotations

import enum
from collections.abc import Iterable, Mapping
from importlib import import_module
from typing import TypeVar

from workbench.core.design.camera import LensModel
from workbench.core.design.imported import LengthUnit
from workbench.core.design.lighting import LampKind, LedMount, LightModel
from workbench.core.design.optics import Composition, MarkerPattern
from workbench.core.press.motion import Mover, Stroke, StrokeKind
from workbench.core.press.press import Extent, Method
from workbench.core.press.texture import Pattern

MODELS = "sim.optics.field.models"
Choice = TypeVar("Choice", bound=enum.StrEnum)
WORDS: dict[type[enum.StrEnum], Mapping[str, str]] = {
    LensModel: {
        LensModel.PINHOLE: "ordinary lens",
        LensModel.EQUIDISTANT: "fisheye",
        LensModel.OPENCV: "ordinary, calibrated",
        LensModel.OPENCV_FISHEYE: "fisheye, calibrated",
    },
    LedMount: {
        LedMount.CAVITY: "in the air behind the skin",
        LedMount.SHELL: "in the clear support",
    },
    LampKind: {LampKind.POINT: "point", LampKind.LINE: "line", LampKind.AREA: "area"},
    MarkerPattern: {
        MarkerPattern.EVEN: "even over the skin",
        MarkerPattern.GRID: "grid about the tip",
        MarkerPattern.RINGS: "rings about the tip",
        MarkerPattern.PICTURE: "from a picture",
    },
    Composition: {
        Composition.OVER_BACKGROUND: "contact over background",
        Composition.ABSOLUTE: "all anew, with shadows",
    },
    Pattern: {
        Pattern.NONE: "smooth",
        Pattern.GRID: "crossed ridges",
        Pattern.DOTS: "round bumps",
        Pattern.WAVES: "waves",
        Pattern.LETTERS: "letters",
        Pattern.IMAGE: "from a picture",
    },
    StrokeKind: {
        StrokeKind.PRESS: "press deeper",
        StrokeKind.SLIDE: "slide",
        StrokeKind.TWIST: "twist",
        StrokeKind.ROLL: "roll",
        StrokeKind.LIFT: "lift",
        StrokeKind.RELEASE: "let go",
        StrokeKind.HOLD: "hold still",
        StrokeKind.MOVE: "move any way",
    },
    Mover: {Mover.OBJECT: "the object", Mover.SENSOR: "the sensor"},
    Extent: {Extent.ACTIVE: "around the contact", Extent.FULL: "the whole skin"},
    Method: {Method.LATTICE: "the workbench's own", Method.PARTICLES: "as published"},
    LengthUnit: {
        LengthUnit.AUTO: "as the file says",
        LengthUnit.MM: "mm",
        LengthUnit.CM: "cm",
        LengthUnit.M: "m",
        LengthUnit.INCH: "inch",
    },
}
"""By enumeration and member."""


def words(choice: enum.StrEnum) -> str:
    """What a designer reads for a choice."""
    plain = choice.value.replace("_", " ")
    if isinstance(choice, LightModel):
        said, colon, _ = (import_module(f"{MODELS}.{choice}").__doc__ or "").partition(":")
        return said[0].lower() + said[1:] if colon else plain
    return WORDS.get(type(choice), {}).get(choice, plain)


def named(choices: Iterable[Choice]) -> dict[str, Choice]:
    """Choices by what a designer reads, in their order."""
    return {words(choice): choice for choice in choices}


def stroke_words(stroke: Stroke) -> str:
    """A stroke with its numbers, in the units of the command line."""
    _, _, amount = stroke.text.partition(":")
    return f"{words(stroke.kind)} {amount}".strip()
