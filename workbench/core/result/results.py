"""Bodies, meshes and files that the stages return; `sensing` has what a press and a camera give.

Sensor frame; mm; float64 geometry, float32 fields. V outer-surface vertices, F faces, N mesh nodes.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from workbench.core.base.check import expect
from workbench.core.result.sensing import Contact


class Label(enum.IntFlag):
    """Region of a face, node or point; nodes on a rim carry several.

    Every face has exactly one of OUTER, INNER, BASE; the others mark parts of those regions.
    """

    OUTER = 1
    """The sensing side."""
    INNER = 2
    """The side that looks at the rigid support; bonded to it unless BACKED."""
    BASE = 4
    """Flat faces on the base plane."""
    ACTUATOR = 8
    """Driven by an actuator; which one is the face's number."""
    PIN = 16
    """Part of an internal pin; which one is the face's number."""
    BACKED = 32
    """Inner face with a gap to the support, filled with air or soft gel."""


NO_NUMBER = -1
"""Number of a face that is neither actuator nor pin."""


def _filled(values: np.ndarray | None, count: int, value: int, kind: Any) -> np.ndarray:
    return np.full(count, value, dtype=kind) if values is None else values


def region_masks(labels: np.ndarray, numbers: np.ndarray) -> dict[str, np.ndarray]:
    """Members of each region by name: outer, inner, base, backed, actuator_i, pin_j; (M,) bool.

    Regions without members are left out.
    """
    masks = {
        flag.name.lower(): (labels & flag) != 0
        for flag in (Label.OUTER, Label.INNER, Label.BASE, Label.BACKED)
        if flag.name is not None
    }
    for flag, name in ((Label.ACTUATOR, "actuator"), (Label.PIN, "pin")):
        marked = (labels & flag) != 0
        for number in np.unique(numbers[marked]):
            masks[f"{name}_{number}"] = marked & (numbers == number)
    return {name: mask for name, mask in masks.items() if mask.any()}


@dataclass(frozen=True, kw_only=True, slots=True)
class Skin:
    """A triangulated surface with vertex normals."""

    points_mm: np.ndarray
    """Vertices [mm], shape (V, 3), float64."""
    faces: np.ndarray
    """Triangles, shape (F, 3), int32, counter-clockwise seen from outside the sensor."""
    normals: np.ndarray
    """Unit vertex normals pointing out of the sensor, shape (V, 3), float64."""
    labels: np.ndarray = None  # pyright: ignore[reportAssignmentType]
    """`Label` bits of each face, shape (F,), uint8; 0 when left out."""
    numbers: np.ndarray = None  # pyright: ignore[reportAssignmentType]
    """Number of each face's actuator or pin, else -1, shape (F,), int16."""

    def __post_init__(self) -> None:
        expect(self.points_mm, "V 3", name="skin points")
        expect(self.faces, "F 3", name="skin faces")
        expect(self.normals, "V 3", name="skin normals")
        count = len(self.faces)
        object.__setattr__(self, "labels", _filled(self.labels, count, 0, np.uint8))
        object.__setattr__(self, "numbers", _filled(self.numbers, count, NO_NUMBER, np.int16))


@dataclass(frozen=True, kw_only=True, slots=True)
class LabelledSurface:
    """A closed triangle mesh whose faces know their region."""

    points_mm: np.ndarray
    """Vertices [mm], shape (N, 3), float64."""
    faces: np.ndarray
    """Triangles, shape (M, 3), int32, counter-clockwise from outside the material."""
    labels: np.ndarray
    """`Label` bits of each face, shape (M,), uint8."""
    numbers: np.ndarray = None  # pyright: ignore[reportAssignmentType]
    """Number of each face's actuator or pin, else -1, shape (M,), int16."""

    def __post_init__(self) -> None:
        expect(self.points_mm, "N 3", name="surface points")
        expect(self.faces, "M 3", name="surface faces")
        expect(self.labels, "M", name="surface labels")
        count = len(self.faces)
        object.__setattr__(self, "numbers", _filled(self.numbers, count, NO_NUMBER, np.int16))

    def has(self, label: Label) -> np.ndarray:
        """Faces that carry the label, shape (M,), bool."""
        return (self.labels & label) != 0


class BodyMethod(enum.StrEnum):
    """How a body came to be."""

    BREP = "brep"
    """By the CAD kernel."""
    SIGNED_DISTANCE = "signed_distance"
    """By marching cubes through a signed distance field, because the CAD kernel failed."""
    IMPORTED = "imported"
    """From the designer's own file."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Solid:
    """The body of a sensor."""

    membrane: LabelledSurface
    """Watertight elastomer body; every face has a region."""
    support: LabelledSurface
    """The rigid transparent part that carries it; its inner faces bound the cavity."""
    base: LabelledSurface
    """The rigid foot that carries camera and LEDs."""
    outer_brep: np.ndarray
    """OCCT text of the outer body before hollowing, shape (bytes,), uint8; empty if not B-rep."""
    core_brep: np.ndarray
    """OCCT text of the body that hollows it, shape (bytes,), uint8; empty if not B-rep."""
    membrane_brep: np.ndarray
    """OCCT text of the elastomer, shape (bytes,), uint8; empty if not B-rep."""
    support_brep: np.ndarray
    """OCCT text of the support, shape (bytes,), uint8; empty if not B-rep."""
    base_brep: np.ndarray
    """OCCT text of the foot, shape (bytes,), uint8; empty if not B-rep."""
    volume_mm3: float
    """Volume of the elastomer by the CAD kernel [mm3], or of the surface where there is none."""
    method: BodyMethod = BodyMethod.BREP
    patches: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int32))
    """Face of the outer file of each membrane triangle, -1 elsewhere, shape (M,), int32; empty
    for bodies that come from no file."""
    tips_mm: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Centres of the tips of internal pins, in the order of their numbers [mm], shape (T, 3)."""
    tip_radius_mm: float = 0.0
    backing_mm: float = 0.0
    """Gap between backed inner faces and the support [mm]; 0 when there are none."""
    notice: str = ""
    """What the builder had to change, for the user; empty when nothing."""


@dataclass(frozen=True, kw_only=True, slots=True)
class VolumeMesh:
    """Hexahedra through the wall, or tetrahedra."""

    points_mm: np.ndarray
    """Nodes [mm], shape (N, 3), float64."""
    cells: np.ndarray
    """Node numbers, shape (M, 8) or (M, 4), int32, VTK order."""
    labels: np.ndarray
    """Bit mask of `Label` per node, shape (N,), uint8."""
    quality: np.ndarray
    """Scaled Jacobian per cell in [-1, 1], shape (M,), float32."""
    layers: int
    """Cells through the wall; 0 for tetrahedra."""
    volume_mm3: float
    numbers: np.ndarray = None  # pyright: ignore[reportAssignmentType]
    """Number of each node's actuator or pin, else -1, shape (N,), int16."""
    groups: np.ndarray = field(default_factory=lambda: np.zeros((0, 8), dtype=np.int32))
    """Eight cells that make a larger one, by the corner of it that each has, shape (G, 8), int32;
    none where cells are not paired."""

    def __post_init__(self) -> None:
        count = len(self.points_mm)
        object.__setattr__(self, "numbers", _filled(self.numbers, count, NO_NUMBER, np.int16))


@dataclass(frozen=True, kw_only=True, slots=True)
class MembraneMesh:
    """All meshes of one body. Where there are hexahedra, the skins share their vertices."""

    hexes: VolumeMesh | None
    """None where the shape cannot be divided so: suckers, pins, some imported bodies."""
    outer: Skin
    """The sensing surface: what contact and images use."""
    inner: Skin
    """The face bonded to the rigid support, or backed by gel or air where so labelled."""
    cavity: Skin
    """Inner face of the support, where light leaves the air; normals point out of the sensor."""
    tips_mm: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Tips of internal pins [mm], shape (T, 3); tracked by contact, drawn as markers."""
    tip_radius_mm: float = 0.0
    backing_mm: float = 0.0
    """Gap between backed inner faces and the support [mm]."""
    notice: str = ""
    """Why there are no hexahedra, for the user; empty when there are."""

    @property
    def seen(self) -> Skin:
        """What the camera looks at: the coated outer skin, or the opaque inner one with pins."""
        return self.inner if len(self.tips_mm) else self.outer

    def seen_displacement_mm(self, contact: Contact) -> np.ndarray:
        """Displacement of the vertices of `seen` in each frame [mm], shape (K, V, 3)."""
        return contact.inner_mm if len(self.tips_mm) else contact.displacement_mm


@dataclass(frozen=True, kw_only=True, slots=True)
class MaterialPoints:
    """Material points on a reference lattice: 2x2x2 in each grid cell.

    Grid node (i, j, k) lies at grid_mm * (i, j, k); cell (i, j, k) is centred on that node and
    reaches half a cell to each side; point p = 4 bx + 2 by + bz lies at a quarter cell toward -
    (bit 0) or + (bit 1) on each axis.
    """

    grid_mm: float
    cells: np.ndarray
    """Integer node coordinates of cells that hold material, shape (C, 3), int32, sorted."""
    fractions: np.ndarray
    """Filled fraction of each of the 8 sub-cells, shape (C, 8), float32 in [0, 1]."""
    labels: np.ndarray = None  # pyright: ignore[reportAssignmentType]
    """`Label` bits of each point that lies next to a labelled face, shape (C, 8), uint8."""
    numbers: np.ndarray = None  # pyright: ignore[reportAssignmentType]
    """Number of each point's actuator or pin, else -1, shape (C, 8), int16."""

    def __post_init__(self) -> None:
        shape = self.fractions.shape
        if self.labels is None:  # pyright: ignore[reportUnnecessaryComparison]
            object.__setattr__(self, "labels", np.zeros(shape, dtype=np.uint8))
        if self.numbers is None:  # pyright: ignore[reportUnnecessaryComparison]
            object.__setattr__(self, "numbers", np.full(shape, NO_NUMBER, dtype=np.int16))

    @property
    def volume_mm3(self) -> float:
        """Volume of all points [mm3]."""
        return float(self.fractions.sum(dtype=np.float64)) * self.grid_mm**3 / 8

    @property
    def count(self) -> int:
        """Points with any volume."""
        return int(np.count_nonzero(self.fractions))


@dataclass(frozen=True, kw_only=True, slots=True)
class Picture:
    """A drawing; stored drawings name the class, so it keeps this word."""

    png: np.ndarray
    """Bytes of a PNG file, shape (bytes,), uint8."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Bundle:
    """Files ready to be written or downloaded."""

    files: dict[str, np.ndarray]
    """Bytes of each file by name, shape (bytes,), uint8."""
    step_volumes_mm3: dict[str, float] = field(default_factory=dict[str, float])
    """Volume that a reader finds in the STEP file of each part, by the part's name [mm3]."""
    notice: str = ""
    """What of the files is not as exact as asked for, for people."""
