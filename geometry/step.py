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

from geometry.csg_brep import translated
from workbench.core.errors import GeometryError, StoreError

SAME_SHARE = 0.005
"""Largest relative difference of the volume that is read back from that of the triangles."""


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


def read_back(data: bytes) -> ReadBack:
    """What a STEP file holds.

    Raises:
        GeometryError: If it cannot be read.
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
            reader.TransferRoots()
        return list(Compound.cast(reader.OneShape()).solids()) if reader.NbShapes() else []

    solids = translated(found)
    return ReadBack(
        solids=len(solids),
        valid=all(solid.is_valid for solid in solids),
        volume_mm3=float(sum(solid.volume for solid in solids)),
    )


def expect_read_back(data: bytes, volumes_mm3: Sequence[float], *, what: str) -> float:
    """The volume of a STEP file that holds what it should [mm3].

    Args:
        volumes_mm3: Volume of the triangles of each solid that it should hold.

    Raises:
        GeometryError: Saying what a reader finds instead.
    """
    found, wanted_mm3 = read_back(data), sum(volumes_mm3)
    off = abs(found.volume_mm3 - wanted_mm3) > SAME_SHARE * wanted_mm3
    if found.solids != len(volumes_mm3) or not found.valid or off:
        raise GeometryError(
            f"{what} as STEP reads back as {found.solids} "
            f"{'valid' if found.valid else 'invalid'} solids of {found.volume_mm3:.6g} mm3, "
            f"{len(volumes_mm3)} of {wanted_mm3:.6g} mm3 are meant",
            hint="use its STL or 3MF file",
            at="mould",
        )
    return found.volume_mm3


def _unwritten(path: Path) -> StoreError:
    return StoreError(
        f"cannot write {path}", hint="check that the folder exists and has room", at="out"
    )
