"""Options of `workbench fem`: solve, export and import."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from workbench import fem_command
from workbench.body_arguments import add_body_options
from workbench.press_arguments import add_press_options


def add_fem_commands(top: argparse.ArgumentParser, common: argparse.ArgumentParser) -> None:
    """The commands below `workbench fem`."""
    subparsers = top.add_subparsers(dest="fem_command", required=True)

    def command(name: str, handler: Any) -> argparse.ArgumentParser:
        text = (handler.__doc__ or "").splitlines()[0]
        sub = subparsers.add_parser(name, help=text, description=text, parents=[common])
        sub.set_defaults(handler=handler)
        return sub

    solve = command("solve", fem_command.solve)
    _case_options(solve)
    solve.add_argument("--out", required=True, type=Path, metavar="DIR")
    solve.add_argument("--json", action="store_true", help="progress as one JSON object per line")
    export = command("export", fem_command.export)
    _case_options(export)
    elements = ("C3D8", "C3D8I", "C3D20R")
    export.add_argument("--element", choices=elements, default="C3D20R", help="default C3D20R")
    export.add_argument("--out", required=True, type=Path, metavar="CASE.inp")
    reading = command("import", fem_command.import_results)
    reading.add_argument("deck", type=Path, metavar="CASE.inp", help="what export wrote")
    text = "CalculiX's .dat, or step,node,ux,uy,uz,fx,fy,fz as .csv"
    reading.add_argument("result", type=Path, metavar="RESULT", help=text)
    reading.add_argument("--json", action="store_true")


def _case_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("design", metavar="NAME|FILE", help="a file brings its press")
    add_body_options(sub)
    add_press_options(sub)
    sub.add_argument("--draft", action="store_true", help="0.9 mm mesh: about 10 %% too stiff")
    text = "part that takes part, about the target (default 12); 0: all"
    sub.add_argument("--radius-mm", type=float, help=text)
