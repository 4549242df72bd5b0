"""`workbench train pack`: data sets as one small file that training reads."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

from sim.forces.network.spec import Target
from workbench.core.base.errors import DesignError
from workbench.project.project import Project
from workbench.system.terminal import say

if TYPE_CHECKING:
    pass
from workbench.cli.command import Command
from workbench.cli.training import add_data_options, read


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    add_data_options(sub)
    text = "what shall be learned from it (default: all; stress takes the most room)"
    targets = [target.value for target in Target]
    sub.add_argument("--target", nargs="+", choices=targets, default=targets, help=text)


def run(options: argparse.Namespace, project: Project) -> int:
    """Pack data sets into one small file that training reads, for another machine."""
    from workbench.learning.training.packed import SUFFIX, write_packed

    if options.out.suffix != SUFFIX:
        raise DesignError(
            f"{options.out} does not end in {SUFFIX}",
            hint=f"call it {options.out.with_suffix(SUFFIX)}",
            at="--out",
        )
    presses = read(options, [Target(each) for each in options.target])
    write_packed(options.out, presses)
    size = options.out.stat().st_size
    cases = len({state.case for state in presses.states})
    if options.json:
        found = {"file": str(options.out), "bytes": size, "samples": len(presses.states)}
        say(json.dumps({**found, "cases": cases, "key": presses.key}))
    else:
        say(f"{options.out}: {len(presses.states)} samples of {cases} cases, {size / 1e6:.1f} MB")
    return 0


COMMAND = Command(place=4, run=run, options=options)
