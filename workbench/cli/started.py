"""What a command of a whole design starts from: its built body."""

from __future__ import annotations

import argparse
import dataclasses

from workbench.core.design.design import SensorDesign
from workbench.core.result.results import Solid
from workbench.pipeline.stage import Outcome
from workbench.project.project import Project
from workbench.system.terminal import Progress, complain


@dataclasses.dataclass(frozen=True, kw_only=True)
class Start:
    """What a command starts from."""

    design: SensorDesign
    solid: Solid
    """The built body: what does not fit it is said before anything else is computed."""
    outcomes: tuple[Outcome, ...] = ()
    changed: str = ""
    """What was changed of the design, for people."""


def started(
    design: SensorDesign, options: argparse.Namespace, project: Project, printer: Progress
) -> Start:
    """Build the body; one straight from its file gets LEDs that fit inside, others on request."""
    from workbench.core.press.press_case import PressCase
    from workbench.edit.typed_fields import sets
    from workbench.planning.fitting import fitted
    from workbench.planning.plan import InlineRunner, evaluate

    runner, outcomes = InlineRunner(project.store), []
    for outcome in evaluate(design, PressCase(), runner, wanted=("build",), monitor=printer):
        printer.done(outcome)
        outcomes.append(outcome)
    solid = project.store.load("build", outcomes[-1].key)
    from_file = design.body is not None and not options.design.endswith(".toml")
    changed = ""
    if options.fit or (from_file and not sets(options.set, "optics.ring")):
        design, changed = fitted(design, solid)
    if changed:
        complain(changed)
    return Start(design=design, solid=solid, outcomes=tuple(outcomes), changed=changed)
