"""A designer's own body: the file it comes from, and which of its faces are what."""

from __future__ import annotations

import enum
import hashlib
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from workbench.core.base.check import expect
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import to_table

IMPORTED = "imported"
"""Name of the family whose body comes from a file."""
FOLDER = "bodies"
"""Of a project, where it keeps such files."""


class FileKind(enum.StrEnum):
    """Formats that can be read."""

    STL = "stl"
    STEP = "step"


class LengthUnit(enum.StrEnum):
    """Unit of the numbers in a file."""

    AUTO = "auto"
    """As the file says, or the only unit that gives a body of a sensor's size."""
    MM = "mm"
    CM = "cm"
    M = "m"
    INCH = "inch"


@dataclass(frozen=True, kw_only=True, slots=True)
class BodyFile:
    """The bytes of a file; equal files are equal whatever their names."""

    name: str = field(compare=False, metadata={"cosmetic": True})
    """Name for people."""
    kind: FileKind
    sha256: str
    data: np.ndarray = field(compare=False, repr=False, metadata={"cosmetic": True})
    """Content, shape (bytes,), uint8; `sha256` stands for it in keys."""


def body_file(name: str, data: bytes) -> BodyFile:
    """A file as the designer gave it.

    Raises:
        DesignError: If its name ends in no known format.
    """
    ending = name.lower().rsplit(".", 1)[-1]
    kinds = {"stl": FileKind.STL, "step": FileKind.STEP, "stp": FileKind.STEP}
    if ending not in kinds:
        raise DesignError(
            f"{name} is neither an STL nor a STEP file",
            hint="export the body as .step, .stp or .stl",
            at="body.outer",
        )
    return BodyFile(
        name=name,
        kind=kinds[ending],
        sha256=hashlib.sha256(data).hexdigest(),
        data=np.frombuffer(data, dtype=np.uint8),
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Pick:
    """A face of the file that the designer named."""

    patch: int
    """Number of the face, as `ReadBody.patch` counts."""
    region: str
    """`actuator_i`, or `base` for a face that is not sensed."""

    def __post_init__(self) -> None:
        head, _, number = self.region.partition("_")
        numbered = head == "actuator" and number.isascii() and number.isdigit()
        if self.region != "base" and not (numbered and len(number) < 4):
            raise DesignError(
                f"a picked face cannot be {shown(self.region)}",
                hint="choose base, actuator_0, actuator_1 ... actuator_999",
                at="body.picks",
            )


@dataclass(frozen=True, kw_only=True, slots=True)
class ImportedBody:
    """What the designer brought."""

    outer: BodyFile
    """The sensing side, as a closed body."""
    inner: BodyFile | None = None
    """The body that hollows it; without it the wall is `layers.elastomer_mm` everywhere."""
    unit: LengthUnit = LengthUnit.AUTO
    picks: tuple[Pick, ...] = ()
    repair: bool = False
    """Whether a file that cannot be used as it is may be remeshed; see `RepairOffer`."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RepairOffer:
    """What a remesh would do to a damaged file, said before it is accepted."""

    step_mm: float
    """Width of the grid of the remesh [mm]."""
    deviation_mm: float
    """Largest distance between the file's outer faces and the new surface [mm]."""
    farthest: tuple[float, float, float]
    """Where that is, in the file's own coordinates."""
    closed_mm: float
    """About the width of the widest hole that it closes [mm]; 0 without one."""

    @property
    def words(self) -> str:
        """One clause for people."""
        holes = f", holes up to {self.closed_mm:.2g} mm wide closed" if self.closed_mm else ""
        lost = ""
        if self.deviation_mm > self.step_mm:
            x, y, z = self.farthest
            lost = (
                f", because what is thinner than about {2.0 * self.step_mm:.2g} mm may be lost, as "
                f"near ({x:.3g}, {y:.3g}, {z:.3g}) in the file's own coordinates"
            )
        return (
            f"the body is remeshed at {self.step_mm:.2g} mm, deviation at most "
            f"{_rounded_up(self.deviation_mm):.6g} mm{lost}{holes}"
        )


def _rounded_up(value: float) -> float:
    """To two digits, or a tenth: who accepts a deviation must not find a larger one."""
    if value <= 0.0:
        return 0.0
    unit = min(0.1, 10.0 ** (math.floor(math.log10(value)) - 1))
    return math.ceil(value / unit - 1e-9) * unit


@dataclass(frozen=True, kw_only=True, slots=True)
class ReadSurface:
    """One closed surface as read and repaired, in its file's own frame."""

    points_mm: np.ndarray
    """Vertices [mm], shape (N, 3), float64."""
    faces: np.ndarray
    """Triangles, shape (M, 3), int32, counter-clockwise from outside."""
    patch: np.ndarray
    """Face of the CAD file, or smooth patch of the STL, of each triangle, shape (M,), int32."""

    def __post_init__(self) -> None:
        expect(self.points_mm, "N 3", name="points")
        expect(self.faces, "M 3", name="faces")
        expect(self.patch, "M", name="patches")


@dataclass(frozen=True, kw_only=True, slots=True)
class ReadBody:
    """Result of the stage `intake`."""

    outer: ReadSurface
    inner: ReadSurface | None
    unit: str
    """Unit that was used."""
    notice: str
    """What was inferred or repaired, for the designer; empty when nothing."""


def body_table(body: ImportedBody) -> dict[str, Any]:
    """The `[body]` table of a design file; names files as the project keeps them."""
    table: dict[str, Any] = {
        "outer": kept_name(body.outer),
        "outer_name": body.outer.name,
        "unit": body.unit.value,
        "picks": [to_table(pick) for pick in body.picks],
        "repair": body.repair,
    }
    if body.inner is not None:
        table |= {"inner": kept_name(body.inner), "inner_name": body.inner.name}
    return table


def kept_name(file: BodyFile) -> str:
    """Where a project keeps a file, relative to its folder."""
    return f"{FOLDER}/{file.sha256[:32]}.{file.kind.value}"
