"""Makes the general law of hardening from the presses of four designs.

    python -m workbench.proof.validation.sensor.general_law_figures FOLDER

FOLDER is a project; what lies in its store is not pressed again.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from sim.condensed import general_law
from workbench.core.base.errors import WorkbenchError
from workbench.core.press.press_case import PressCase
from workbench.core.result.condensed import Hardening
from workbench.live.live_press import live_design
from workbench.pipeline.devices import open_device
from workbench.planning.plan import InlineRunner, evaluate, plan
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.proof.validation.sensor.by_design import DESIGNS

if TYPE_CHECKING:
    from sim.condensed.hardening import PlayedPress


def presses_of(name: str, project: Project) -> list[PlayedPress]:
    """The presses that the hardening of a design is fitted to, by both solvers."""
    from sim.condensed.assemble import condensed
    from sim.condensed.fast_contact import FastContact
    from sim.condensed.lessons import lessons, played
    from sim.condensed.tiles import reach_mm
    from workbench.pipeline.fast.hardening import parts

    design, store = live_design(load_design(name, project=project)), project.store
    for _ in evaluate(design, PressCase(), InlineRunner(store), wanted=("hardening",)):
        pass
    given = plan(design, PressCase())["hardening"].inputs
    calls = parts(given, store)
    tiles, contacts = (
        [store.load(call.stage, call.key) for call in calls[part]]
        for part in ("columns", "contacts")
    )
    nodes = store.load(given.nodes.stage, given.nodes.key)
    skin = condensed(nodes, tiles, reach_mm(given.wall_mm))
    fast = FastContact(skin, Hardening(), given.material)
    objects = [indenter for indenter, _ in lessons((0.0, 0.0, 0.0), given.wall_mm)]
    return [played(fast, thing, contact) for thing, contact in zip(objects, contacts, strict=True)]


def main(words: Sequence[str] | None = None) -> int:
    """Measure and record; 1 where something failed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    project = Project(parser.parse_args(words).folder)
    open_device()
    try:
        general_law.RECORD.make(
            lambda: general_law.generalised({name: presses_of(name, project) for name in DESIGNS})
        )
    except WorkbenchError as error:
        print(f"error: {error.message}; {error.hint}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
