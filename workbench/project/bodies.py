"""Body files of imported designs: read from disk, kept in the project, written into design files.

A design file names its body's files, relative to itself or to the project folder. A project keeps
each file once, by its hash, so that designs and variants stay small and find it again.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import from_table
from workbench.core.design.design import SensorDesign
from workbench.core.design.imported import (
    IMPORTED,
    BodyFile,
    ImportedBody,
    LengthUnit,
    Pick,
    body_file,
    kept_name,
)
from workbench.system.named_files import BRING_IT, find_file

LARGEST_FILE_MB = 64
ENDINGS = (".stl", ".step", ".stp")


def design_of_file(path: Path, unit: str = "auto") -> SensorDesign:
    """A design around the body of an STL or STEP file.

    Raises:
        DesignError: If the file cannot be read, or the unit is unknown.
    """
    table = {"outer": str(path), "unit": unit}
    body = read_body_table(table, roots=(Path(),))
    return SensorDesign(name=path.stem[:80], family=IMPORTED, body=body)


def read_body_table(table: Any, *, roots: Sequence[Path], enclosed: bool = False) -> ImportedBody:
    """The body that a `[body]` table names.

    Args:
        table: `outer`, and optionally `inner`, their names for people, `unit`, `picks` and
            `repair`.
        roots: Folders in which the files are looked for, in order.
        enclosed: Whether the files must lie inside these folders.

    Raises:
        DesignError: For an unknown field, a missing file, or one that is too large.
    """
    if not isinstance(table, Mapping) or "outer" not in table:
        raise DesignError(
            f"body is {shown(table)}, expected a table with the file of the outer body",
            hint="write [body] outer = 'file.step'",
            at="body.outer",
        )
    known = {"outer", "inner", "outer_name", "inner_name", "unit", "picks", "repair"}
    for name in table:
        if name not in known:
            raise DesignError(
                f"there is no field 'body.{name}'",
                hint=f"known: {', '.join(sorted(known))}",
                at=f"body.{name}",
            )
    read = functools.partial(_read, roots=roots, enclosed=enclosed)
    inner = None
    if "inner" in table:
        inner = read(table["inner"], table.get("inner_name"), at="body.inner")
    units = {unit.value: unit for unit in LengthUnit}
    unit, picks = table.get("unit", "auto"), table.get("picks", ())
    if not isinstance(unit, str) or unit not in units:
        raise DesignError(
            f"body.unit is {shown(unit)}", hint=f"choose one of {', '.join(units)}", at="body.unit"
        )
    repair = table.get("repair", False)
    if not isinstance(repair, bool):
        raise DesignError(
            f"body.repair is {repair!r}, expected true or false",
            hint="write repair = true to accept the remesh of a damaged file",
            at="body.repair",
        )
    if not isinstance(picks, Sequence) or isinstance(picks, str):
        raise DesignError(
            f"body.picks is {shown(picks)}, expected a list",
            hint="write picks = [{patch = 3, region = 'actuator_0'}]",
            at="body.picks",
        )
    return ImportedBody(
        outer=read(table["outer"], table.get("outer_name"), at="body.outer"),
        inner=inner,
        unit=units[unit],
        picks=tuple(from_table(Pick, pick, at="body.picks") for pick in picks),
        repair=repair,
    )


def kept_files(body: ImportedBody) -> dict[str, bytes]:
    """What a project must hold for a design, by path relative to its folder."""
    files = [file for file in (body.outer, body.inner) if file is not None]
    return {kept_name(file): file.data.tobytes() for file in files}


def without_body(design: SensorDesign) -> SensorDesign:
    """The design as plain numbers and texts only."""
    return dataclasses.replace(design, body=None)


def _read(name: Any, label: Any, *, roots: Sequence[Path], enclosed: bool, at: str) -> BodyFile:
    if not isinstance(name, str) or not name:
        raise DesignError(
            f"{at} is {shown(name)}, expected the path of a file", hint="write 'file.step'", at=at
        )
    try:
        path = find_file([(root, name) for root in roots], enclosed=enclosed)
        if path is None:
            looked = " and ".join(str(root / name) for root in roots)
            raise DesignError(
                f"there is no file {shown(str(label or name))} for the body of this design",
                hint=BRING_IT if enclosed else f"looked for {looked}; load the file again",
                at=at,
            )
        size_mb = path.stat().st_size / 1e6
        if size_mb > LARGEST_FILE_MB:
            raise DesignError(
                f"{path.name} has {size_mb:,.0f} MB, more than {LARGEST_FILE_MB} MB",
                hint="reduce the mesh, or export it as STEP",
                at=at,
            )
        return body_file(str(label or path.name), path.read_bytes())
    except DesignError as error:
        error.at = at
        raise
    except (OSError, ValueError) as error:
        # A path that is too long, or holds a zero, is refused by the system itself.
        raise DesignError(
            f"cannot read {name[:80]}: {getattr(error, 'strerror', None) or error}",
            hint="check the file",
            at=at,
        ) from error
