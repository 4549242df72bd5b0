"""Which learned reader belongs to a design: a named one, the project's, or one that ships."""

from __future__ import annotations

from pathlib import Path

from sim.reading.network.reader_file import SUFFIX, ReaderFile, load_reader
from workbench.core.base.errors import DesignError, shown
from workbench.core.design.design import SensorDesign
from workbench.project.project import Project
from workbench.reading.reader_digest import reader_digest
from workbench.system.names import is_name

SHIPPED = Path(__file__).parent / "shipped_readers"
"""Readers that come with the workbench."""
FOLDER = "readers"
"""Of a project, where its readers are kept."""
REMEDY = "train one with `workbench reader train DESIGN`, or use --reader table"


def reader_path(design: SensorDesign, project: Project) -> Path:
    """Where a design's reader is kept if no other file is named."""
    name = design.name if is_name(design.name) else "reader"
    return project.folder / FOLDER / f"{name}{SUFFIX}"


def find_reader(design: SensorDesign, project: Project, named: Path | None) -> ReaderFile:
    """The reader of a design.

    Args:
        design: The sensor.
        project: Its readers are looked through first, the newest before others.
        named: A file, which then is the one.

    Raises:
        StoreError: If a file cannot be read, or is damaged.
        DesignError: If no reader was learned for this design as it is now.
    """
    key = reader_digest(design)
    if named is not None:
        reader = load_reader(named)
        if reader.digest != key:
            raise DesignError(
                f"{named} was learned for {shown(reader.design)}, which differs from this design "
                "in shape, material or optics",
                hint=REMEDY,
                at="--weights",
            )
        return reader
    outdated = False
    for path in _kept(project):
        reader = load_reader(path)
        if reader.digest == key:
            return reader
        outdated |= reader.design == design.name
    what = (
        f"{design.name} has changed in shape, material or optics since its reader was learned"
        if outdated
        else f"no learned reader knows {design.name}"
    )
    raise DesignError(what, hint=REMEDY, at="--reader")


def _kept(project: Project) -> list[Path]:
    own = sorted((project.folder / FOLDER).glob(f"*{SUFFIX}"), key=_age)
    return own + sorted(SHIPPED.glob(f"*{SUFFIX}"))


def _age(path: Path) -> float:
    return -path.stat().st_mtime
