"""`workbench serve`: open the workbench in a browser."""

from __future__ import annotations

import argparse

from workbench.cli.command import Command
from workbench.cli.press_arguments import (
    add_unit_option,
)
from workbench.project.project import Project


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument(
        "design", nargs="?", metavar="NAME|FILE", help="what is opened (default: what you left)"
    )
    add_unit_option(sub)
    sub.add_argument("--host", default="127.0.0.1", help="default 127.0.0.1; others need a token")
    sub.add_argument("--port", type=int, default=8080, help="default 8080")
    sub.add_argument("--open", action="store_true", help="open the system's browser")
    sub.add_argument("--fast-scene", action="store_true", help="no shadows: software rendering")
    sub.add_argument("--no-tour", action="store_true", help="no tour for a browser that is new")


def run(options: argparse.Namespace, project: Project) -> int:
    """Open the workbench in a browser."""
    # The one arrow from the application to its front; everything else points the other way.
    from ui.app import serve

    return serve(options, project)


COMMAND = Command(place=1, run=run, options=options)
