"""Designs as TOML with a schema number, and what a design needs beyond its own fields.

The press, a variant's figures and a sweep's points stand in tables of the same file, which are read
where they belong (`state`, `variants`, `sweep_files`).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import from_table, to_table
from workbench.core.design.design import SCHEMA, SensorDesign, check_body
from workbench.core.design.imported import body_table
from workbench.project.bodies import kept_files, read_body_table, without_body
from workbench.project.moduli import with_moduli
from workbench.project.photos import (
    add_names,
    check_photos,
    kept_photos,
    take_photos,
    with_photos,
    without_photos,
)
from workbench.system.whole_files import toml_table

GUEST_TABLES = ("press_case", "variant", "sweep")
"""Tables of a design file that the design itself does not read."""


def design_from_toml(
    text: str, *, source: str = "the file", roots: Sequence[Path] = (), enclosed: bool = False
) -> SensorDesign:
    """Parse and check a design; tables that belong to a session or variant are left out.

    Args:
        text: The file.
        source: Its name, for messages.
        roots: Folders in which the files of an imported body and of pictures are looked for.
        enclosed: Whether they must lie inside these: for a design that somebody else may have made.

    Raises:
        DesignError: For broken TOML, a newer schema, unknown fields or refused values.
    """
    table = parse_toml(text, source=source)
    own = {name: value for name, value in table.items() if name not in GUEST_TABLES}
    body = own.pop("body", None)
    if "material" in own:
        own["material"] = with_moduli(own["material"])
    own, pictures = take_photos(own)
    design = from_table(SensorDesign, own)
    design = with_photos(design, pictures, roots=roots, enclosed=enclosed)
    if body is not None:
        read = read_body_table(body, roots=roots, enclosed=enclosed)
        design = dataclasses.replace(design, body=read)
    check_design(design)
    return design


def parse_toml(text: str, *, source: str) -> Mapping[str, Any]:
    """The tables of a design file, its schema checked.

    Raises:
        DesignError: For broken TOML or a newer schema.
    """
    try:
        table = toml_table(text)
    except ValueError as error:
        raise DesignError(
            f"{source} is not valid TOML: {error}", hint="correct the line named", at="design"
        ) from error
    schema = table.get("schema", SCHEMA)
    if not isinstance(schema, int) or isinstance(schema, bool) or schema < 1:
        raise DesignError(
            f"{source} has schema {shown(schema)}", hint=f"write schema = {SCHEMA}", at="schema"
        )
    if schema > SCHEMA:
        raise DesignError(
            f"{source} has schema {schema}, this program reads up to {SCHEMA}",
            hint="update the workbench, or save the design with the older version",
            at="schema",
        )
    return table


def check_design(design: SensorDesign) -> None:
    """Check what needs files or the family: its shape parameters and their fit with the layers.

    Raises:
        DesignError: Naming the field.
    """
    from designs.family import family, resolve_shape
    from geometry.body.silicones import silicone
    from sim.optics.light.places import check_lenses

    check_body(design)
    check_photos(design)
    check_lenses(design.optics)
    family(design.family).check(resolve_shape(design.family, design.shape), design.layers)
    silicone(design.casting.silicone)


def design_to_toml(design: SensorDesign, **extra: Any) -> str:
    """A design as readable TOML; `design_from_toml` gives the same design back."""
    import tomli_w

    return tomli_w.dumps({**design_table(design), **to_table(extra)})


def design_table(design: SensorDesign) -> dict[str, Any]:
    """A design as nested tables, an imported body and pictures by the names of their files."""
    table = to_table(without_photos(without_body(design)))
    add_names(table, design)
    return table if design.body is None else {**table, "body": body_table(design.body)}


def design_files(design: SensorDesign) -> dict[str, bytes]:
    """The files that a design's table names, by path relative to the project's folder."""
    bodies = {} if design.body is None else kept_files(design.body)
    return bodies | kept_photos(design)
