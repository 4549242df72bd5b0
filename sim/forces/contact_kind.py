"""Kinds of contact by which errors of forces differ: what touches, how wide, pressed or sheared.

A smooth object spreads its force, an edge or a point gathers it where a grid, a mesh or a network
resolve it worst; a shear adds friction. Depth is no axis: of the presses that were held out of the
shipped network errors are alike at 0.5 and 1 mm (contact solver 35 and 28 % of the force field,
network 11 and 13 %), and differ more from object to object.

An object from a file, with a texture, soft, or tilted is of no kind: it may touch with anything.
Turned about its way into the skin it touches as it did.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass

from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press

WIDTHS_MM = (4.0, 8.0)
"""Between the classes of width: the data sets have objects of 3 to 12 mm."""


class Touch(enum.StrEnum):
    """What of an object meets the skin."""

    SMOOTH = "smooth"
    EDGED = "edged"
    POINTED = "pointed"


class Width(enum.StrEnum):
    """How wide an object is."""

    NARROW = f"below {WIDTHS_MM[0]:g} mm"
    MIDDLE = f"of {WIDTHS_MM[0]:g} to {WIDTHS_MM[1]:g} mm"
    WIDE = f"above {WIDTHS_MM[1]:g} mm"


@dataclass(frozen=True, kw_only=True, slots=True)
class ContactKind:
    """A kind of contact."""

    touch: Touch
    width: Width
    sheared: bool

    @property
    def words(self) -> str:
        """For people."""
        return f"{self.touch} objects {self.width}, {'sheared' if self.sheared else 'pressed'}"


def touch_of(indenter: Indenter) -> Touch | None:
    """What of an object meets the skin; None where nobody can say."""
    kind = indenter.record
    tilted = any(indenter.turn_deg[:2])
    unlike = tilted or indenter.texture.raised or indenter.soft is not None
    if kind.of_triangles or unlike:
        return None
    if kind.tip:
        return Touch.POINTED
    return Touch.SMOOTH if kind.edge_share is None else Touch.EDGED


def width_of(size_mm: float) -> Width:
    """The class of a width [mm]; limits belong to the middle one."""
    if size_mm < WIDTHS_MM[0]:
        return Width.NARROW
    return Width.MIDDLE if size_mm <= WIDTHS_MM[1] else Width.WIDE


def kind_of_contact(indenter: Indenter, *, sheared: bool) -> ContactKind | None:
    """The kind of a contact; None of an object that is of none."""
    touch = touch_of(indenter)
    if touch is None:
        return None
    return ContactKind(touch=touch, width=width_of(indenter.size_mm), sheared=sheared)


def kind_of_press(indenter: Indenter, press: Press) -> ContactKind | None:
    """The kind of a press as it ends; None of an object of none, and of a path that turns."""
    if press.trajectory is not None or press.actuations or press.twist_deg:
        return None
    u_mm, v_mm = press.shear_mm
    for stroke in press.strokes:
        if stroke.turn_deg:
            return None
        u_mm, v_mm = u_mm + stroke.shift_mm[0], v_mm + stroke.shift_mm[1]
    return kind_of_contact(indenter, sheared=bool(u_mm or v_mm))
