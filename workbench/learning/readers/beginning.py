"""Where a training of a reader stands, and which reader it begins from.

A calibrated design differs from its design by what the hands of a builder left: the reader that was
learned for the design knows most of it. So a training for a calibrated design begins from that
reader, and learns what this one sensor shows.
"""

from __future__ import annotations

from pathlib import Path

from sim.reading.network.reader_file import SUFFIX, ReaderFile, load_reader
from sim.reading.network.spec import spec_for
from workbench.core.base.errors import DesignError, shown
from workbench.core.design.design import SensorDesign
from workbench.project.project import Project
from workbench.reading.find_reader import SHIPPED, reader_path

DIGITS = 8
"""Of the digest of a built sensor's file, in the name of its reader."""


def is_calibrated(design: SensorDesign) -> bool:
    """Whether a design is of the one sensor that was built."""
    return design.optics.unit is not None


def usual_path(design: SensorDesign, project: Project) -> Path:
    """Where a training writes unless it is told: each built sensor of a design has its own file."""
    path = reader_path(design, project)
    unit = design.optics.unit
    if unit is None:
        return path
    return path.with_name(f"{path.name.removesuffix(SUFFIX)}-{unit.sha256[:DIGITS]}{SUFFIX}")


def training_folder(out: Path) -> Path:
    """Where a training keeps what it makes on the way."""
    return out.with_name(f"{out.name.removesuffix(SUFFIX)}-training")


def usual_start(design: SensorDesign, project: Project, size: str) -> ReaderFile | None:
    """The reader that a training begins from unless it is told; None: from nothing.

    It is that of the design as it was drawn, not of another sensor that was built from it: so it
    stays the same when a training goes on after others have ended.

    Args:
        design: The sensor.
        project: Its reader comes before the one that ships.
        size: A name of `SIZES`; empty: any.

    Raises:
        StoreError: If a reader's file is damaged.
    """
    if not is_calibrated(design):
        return None
    drawn = reader_path(design, project)
    for path in (drawn, SHIPPED / drawn.name):
        if path.is_file():
            reader = load_reader(path)
            if reader.design == design.name and _fits(reader, design, size):
                return reader
    return None


def named_start(path: Path, design: SensorDesign, size: str) -> ReaderFile:
    """The reader of a file, to begin from.

    Raises:
        StoreError: If the file cannot be read, or is damaged.
        DesignError: If its network is of another size.
    """
    reader = load_reader(path)
    if not _fits(reader, design, size):
        rows, columns = reader.spec.rows, reader.spec.columns
        raise DesignError(
            f"{path} was learned for {shown(reader.design)} at {columns} x {rows} pixels by a "
            f"network of widths {reader.spec.widths}, which is not what is asked for",
            hint="leave --size out, or begin from nothing: --from nothing",
            at="--from",
        )
    return reader


def _fits(reader: ReaderFile, design: SensorDesign, size: str) -> bool:
    """Whether images have the network's rows, and it has the size that is asked for."""
    camera, spec = design.optics.camera, reader.spec
    wanted = spec_for(size or "small", camera.width_px, camera.height_px)
    return spec.rows == wanted.rows and (not size or spec.widths == wanted.widths)
