"""`workbench presets`: list the shipped designs and the families."""

from __future__ import annotations

import argparse
import json

from workbench.cli.command import Command
from workbench.project.project import Project
from workbench.system.terminal import say


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("--json", action="store_true", help="one JSON object per line")


def run(options: argparse.Namespace, project: Project) -> int:
    """List the shipped designs and the families."""
    from designs.family import families
    from workbench.project.named_designs import presets

    rows = [{"name": n, "kind": "preset", "purpose": p} for n, p in presets().items()]
    rows += [{"name": n, "kind": "family", "purpose": f.title} for n, f in families().items()]
    for row in rows:
        say(
            json.dumps(row)
            if options.json
            else f"{row['name']:12} {row['kind']:7} {row['purpose']}"
        )
    return 0


COMMAND = Command(place=4, run=run, options=options)
