"""STEP files: written, and read back before anyone is handed them.

The CAD kernel can write a body that is another one when it is read: a surface of revolution of an
ellipse comes back with its axes exchanged, half a body's volume off, and nothing is said. So a file
counts only if a reader finds in it what was meant: the solids, each valid, of the volume that their
triangles have.
"""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from geometry.body.csg_brep import translated
from workbench.core.base.errors import GeometryError, StoreError

SAME_SHARE = 0.005
"""Largest relative difference of the volume that is read back from that of the triangles."""
REPAIRS = (
    "FixSolidMode",
    "FixFreeShellMode",
    "FixFreeFaceMode",
    "FixFreeWireMode",
    "FixSameParameterMode",
    "FixVertexPositionMode",
)
"""What OCCT's reader mends: flat facets need none of it, B-reps with seams do."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ReadBack:
    """What another program finds in a STEP file."""

    solids: int
    valid: bool
    """Whether the kernel calls every solid valid."""
    volume_mm3: float
    """Of all solids together [mm3]; negative where they are inside out."""


def step_bytes(bodies: Sequence[Any], name: str) -> bytes:
    """A STEP file: of one body as it is, of several as an assembly of named parts."""
    # OCCT writes STEP to named files only.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.step"
        write_step(bodies, name, path)
        return path.read_bytes()


def write_step(bodies: Sequence[Any], name: str, path: Path) -> None:
    """Write a STEP file.

    Raises:
        StoreError: If the file cannot be written.
        GeometryError: If the kernel cannot turn a body into STEP.
    """
    from build123d import Compound, export_step

    def written() -> bool:
        shape = bodies[0] if len(bodies) == 1 else Compound(label=name, children=list(bodies))
        try:
            return export_step(shape, str(path), timestamp="2000-01-01T00:00:00")
        except (OSError, RuntimeError) as error:
            raise _unwritten(path) from error

    if not translated(written, what=name):
        raise _unwritten(path)


def read_back(data: bytes, *, repaired: bool = True) -> ReadBack:
    """What a STEP file holds.

    Args:
        repaired: Whether the reader mends what it reads, as all do unless told otherwise. What is
            sound as it is written needs none of it, and is read in a sixth of the time.

    Raises:
        GeometryError: If it cannot be read.
    """
    from OCP.BRepCheck import BRepCheck_Analyzer

    solids = _solids(data, repaired=repaired)
    return ReadBack(
        solids=len(solids),
        # On all cores: it takes twice as long as reading what needs no repair.
        valid=all(BRepCheck_Analyzer(solid.wrapped, True, True).IsValid() for solid in solids),
        volume_mm3=float(sum(solid.volume for solid in solids)),
    )


def _solids(data: bytes, *, repaired: bool) -> list[Any]:
    """The solids that a reader finds, none where it finds no STEP file.

    Raises:
        GeometryError: If the kernel fails.
    """
    from build123d.topology import Compound
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPControl import STEPControl_Reader

    def found() -> list[Any]:
        reader = STEPControl_Reader()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "part.step"
            path.write_bytes(data)
            if reader.ReadFile(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
                return []
            if not repaired:
                reader.SetShapeFixParameters(_no_repairs())
            reader.TransferRoots()
        return list(Compound.cast(reader.OneShape()).solids()) if reader.NbShapes() else []

    return translated(found)


def _no_repairs() -> Any:
    """Parameters of a reader that mends nothing (OCCT, `ShapeFix_Shape`)."""
    from OCP.collections import DataMap_TCollection_AsciiString_TCollection_AsciiString as Map
    from OCP.TCollection import TCollection_AsciiString as Text

    none = Map()
    for repair in REPAIRS:
        none.Bind(Text(f"FixShape.{repair}"), Text("0"))
    return none


def expect_read_back(data: bytes, wanted_mm3: float, *, what: str, repaired: bool = True) -> float:
    """The volume of a STEP file that holds one valid solid, as it should [mm3].

    Args:
        wanted_mm3: Volume of the triangles of the solid.
        repaired: As for `read_back`.

    Raises:
        GeometryError: Saying what a reader finds instead.
    """
    found = read_back(data, repaired=repaired)
    if found.solids != 1 or not found.valid or not _same(found.volume_mm3, wanted_mm3):
        raise GeometryError(
            f"{what} as STEP reads back as {found.solids} "
            f"{'valid' if found.valid else 'invalid'} solids of {found.volume_mm3:.6g} mm3, "
            f"1 of {wanted_mm3:.6g} mm3 is meant",
            hint="use its STL or 3MF file",
            at="mould",
        )
    return found.volume_mm3


def expect_assembly(data: bytes, volumes_mm3: Sequence[float], *, what: str) -> None:
    """Expect each part in the STEP file of an assembly, as it is written in its own file.

    Nothing is mended, and whether the solids are valid is not asked again: they are the same lines
    of text.

    Args:
        volumes_mm3: What was read from the parts' own files, as they are written.

    Raises:
        GeometryError: Saying what a reader finds instead.
    """
    found_mm3 = sorted(float(solid.volume) for solid in _solids(data, repaired=False))
    wanted_mm3 = sorted(volumes_mm3)
    if len(found_mm3) != len(wanted_mm3) or not all(map(_same, found_mm3, wanted_mm3)):
        raise GeometryError(
            f"{what} as STEP reads back as solids of {_listed(found_mm3)} mm3, "
            f"{_listed(wanted_mm3)} mm3 are meant",
            hint="use the files of its parts",
            at="mould",
        )


def _same(found_mm3: float, wanted_mm3: float) -> bool:
    return abs(found_mm3 - wanted_mm3) <= SAME_SHARE * abs(wanted_mm3)


def _listed(volumes_mm3: Sequence[float]) -> str:
    return ", ".join(f"{volume:.6g}" for volume in volumes_mm3) or "no"


def _unwritten(path: Path) -> StoreError:
    return StoreError(
        f"cannot write {path}", hint="check that the folder exists and has room", at="out"
    )
