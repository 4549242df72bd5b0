"""A design and its press as one thing: what a session, a variant and an autosave keep.

The press stands in the design's TOML as the table `press_case`. The mesh of an STL indenter is too
large for it: the project keeps it by its hash, so that a restart finds the same results.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import from_table, to_table
from workbench.core.design.design import SensorDesign
from workbench.core.press.fem import FemSettings
from workbench.core.press.indenter import Indenter
from workbench.core.press.learned import LearnedSettings
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.pipeline.chosen_weights import from_project, to_project
from workbench.project.aim import default_target_mm
from workbench.project.design_toml import design_from_toml, parse_toml
from workbench.project.kept_indenters import indenter_table, read_indenter
from workbench.project.project import Project

PARTS = {
    "indenter": Indenter,
    "press": Press,
    "settings": ContactSettings,
    "fem": FemSettings,
    "learned": LearnedSettings,
}


@dataclass(frozen=True, kw_only=True, slots=True)
class State:
    """All that undo, a variant and a restart bring back."""

    design: SensorDesign
    case: PressCase


def fresh_state(design: SensorDesign, case: PressCase | None = None) -> State:
    """A design with a press (the default one) aimed where its family says."""
    case = PressCase() if case is None else case
    press = dataclasses.replace(case.press, target_mm=default_target_mm(design))
    return State(design=design, case=dataclasses.replace(case, press=press))


def case_table(case: PressCase, project: Project) -> dict[str, Any]:
    """A press as a table; the mesh of an STL indenter is written beside the designs.

    Raises:
        StoreError: If the mesh cannot be written.
    """
    table = to_table(dataclasses.replace(case, indenter=Indenter()))
    table["indenter"] = indenter_table(case.indenter, project)
    table["learned"] = to_project(case.learned, project.folder)
    return table


def read_state(text: str, project: Project, *, source: str, enclosed: bool = False) -> State:
    """A design and its press from a design file; a file without a press gets the default one.

    Args:
        text: The file.
        project: Where the files that it names are kept.
        source: Its name, for messages.
        enclosed: Whether it may name only files inside the project.

    Raises:
        DesignError: If the text is not valid, or names an STL indenter this project does not have.
    """
    table = parse_toml(text, source=source).get("press_case", {})
    if not isinstance(table, Mapping):
        raise DesignError(
            f"press_case is {shown(table)}, expected a table", hint="remove it", at="press_case"
        )
    known = {
        name: from_table(kind, table[name], at=f"press_case.{name}")
        for name, kind in PARTS.items()
        if name in table and name != "indenter"
    }
    if "indenter" in table:
        known["indenter"] = read_indenter(table["indenter"], project)
    if "learned" in known:
        known["learned"] = from_project(known["learned"], project.folder, enclosed=enclosed)
    roots = (project.folder,)
    design = design_from_toml(text, source=source, roots=roots, enclosed=enclosed)
    return State(design=design, case=PressCase(**known))
