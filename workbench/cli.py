"""The command line: what may be typed, and what its errors look like.

Exit codes: 0 done, 1 done but not good (a red check of `export` or `run --strict`, a row of
`validate` or `bench` beyond its limit), 2 bad input (a busy port included), 3 failed computation,
full disk or device, 130 cancelled. Anything else is a bug: a traceback, and a crash file in the
project folder.
"""

from __future__ import annotations

import argparse
import errno
import json
import os
import signal
import sys
import threading
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from workbench import (
    __version__,
    commands,
    dataset_command,
    evaluate_command,
    sweep_command,
    train_command,
)
from workbench.body_arguments import add_body_options
from workbench.core.errors import Cancelled, DesignError, Stopped, StoreError, WorkbenchError, shown
from workbench.fem_arguments import add_fem_commands
from workbench.press_arguments import (
    add_fit_option,
    add_press_options,
    add_set_option,
    add_unit_option,
)
from workbench.project import Project
from workbench.supervised import supervised
from workbench.terminal import complain, say

NUMBERS = (
    "--target",
    "--shear-mm",
    "--twist-deg",
    "--depth-mm",
    "--size-mm",
    "--object-pose",
    "--turn-deg",
    "--body-turn-deg",
    "--from",
    "--to",
)
"""Options whose value may begin with a minus sign."""
LONGEST_COMPLAINT, HEAD, TAIL = 600, 160, 60
"""Characters of a complaint about options; of a longer one those of both ends."""


def entry() -> int:
    """Entry point of the `workbench` command; returns the exit code.

    What computes here does so in a process of its own; the server has its lanes for that.
    """
    words = sys.argv[1:]
    if "serve" in words[:1]:
        return main(words)
    return supervised(
        lambda: main(words), ended=lambda number: _print_ended(number, as_json="--json" in words)
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command in this process; returns the exit code."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    options = parser().parse_args(_join_negative(words))
    project = Project(options.project)
    # Taichi greets on stdout when it is imported, which belongs to the answer (`--json`).
    os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
    as_json = getattr(options, "json", False)
    request = _Terminable()
    try:
        with request:
            return options.handler(options, project)
    except Stopped as stopped:
        return _print_cancelled(stopped.message)
    except WorkbenchError as error:
        return _print_error(error, as_json=as_json)
    except KeyboardInterrupt:
        return _print_cancelled()
    except MemoryError:
        return _print_error(
            WorkbenchError(
                "this machine ran out of memory", hint="use a coarser mesh or grid, or fewer frames"
            ),
            as_json=as_json,
        )
    except Exception as bug:
        # A native module that is interrupted while it is imported makes an ImportError of it.
        if request.asked:
            return _print_cancelled()
        if isinstance(bug, OSError) and bug.errno in (errno.ENOSPC, errno.EDQUOT):
            full = StoreError(f"the disk is full: {bug}", hint="free some space and run again")
            return _print_error(full, as_json=as_json)
        if isinstance(bug, OSError) and bug.errno == errno.ENAMETOOLONG:
            long = DesignError(
                f"the path {shown(bug.filename)} is longer than the file system takes",
                hint="give a shorter one",
            )
            return _print_error(long, as_json=as_json)
        return _print_bug(project)


class _Terminable:
    """Treats SIGTERM as Ctrl-C while a command runs, and remembers that it came."""

    def __init__(self) -> None:
        self.asked = False

    def __enter__(self) -> _Terminable:
        if threading.current_thread() is threading.main_thread():
            self._before = signal.signal(signal.SIGTERM, self._hear)
        return self

    def __exit__(self, *error: object) -> None:
        if threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGTERM, self._before)

    def _hear(self, number: int, frame: object) -> None:
        self.asked = True
        raise KeyboardInterrupt


class Parser(argparse.ArgumentParser):
    """A parser whose complaints repeat no more of a value than its ends."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong with the options and exit with 2."""
        cut = len(message) > LONGEST_COMPLAINT
        super().error(f"{message[:HEAD]}...{message[-TAIL:]}" if cut else message)


def _join_negative(words: list[str]) -> list[str]:
    """`--target -3,0,35` as `--target=-3,0,35`, which argparse would take for an option."""
    joined: list[str] = []
    for word in words:
        if joined and joined[-1] in NUMBERS and word[:1] == "-" and word[1:2] in "0123456789.":
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def _print_cancelled(words: str = "cancelled; finished results are kept") -> int:
    complain(words)
    return Cancelled.exit_code


def _print_error(error: WorkbenchError, *, as_json: bool) -> int:
    if as_json:
        say(json.dumps(error.as_dict()))
    complain(f"error: {error.message}")
    if error.at:
        complain(f"   at: {error.at}")
    if error.hint:
        complain(f" hint: {error.hint}")
    return error.exit_code


def _print_ended(number: int, *, as_json: bool) -> int:
    """Say that native code ended the command."""
    name = signal.strsignal(number) or "unknown"
    error = WorkbenchError(
        f"the computation was ended by signal {number} ({name}): native code crashed, or the "
        "system needed its memory",
        hint="finished results are kept; run again with a coarser mesh or grid, or after changing "
        "the last parameter a little",
    )
    return _print_error(error, as_json=as_json)


def _print_bug(project: Project) -> int:
    """Show the traceback of the exception being handled, and keep it where that is possible."""
    text = traceback.format_exc()
    complain(text, end="")
    try:
        complain(f"this is a bug; please report it with {project.write_crash(text)}")
    except WorkbenchError as error:
        complain(f"this is a bug; please report it with the lines above ({error.message})")
    return 1


def parser() -> argparse.ArgumentParser:
    """The whole command line."""
    top = Parser(prog="workbench", description=__doc__)
    top.add_argument("--version", action="version", version=__version__)
    common = Parser(add_help=False)
    common.add_argument(
        "--project", metavar="DIR", help="project folder (default $WORKBENCH_PROJECT or .workbench)"
    )
    subparsers = top.add_subparsers(dest="command", required=True)

    def command(handler: Any) -> argparse.ArgumentParser:
        text = (handler.__doc__ or "").splitlines()[0]
        name = handler.__name__
        sub = subparsers.add_parser(name, help=text, description=text, parents=[common])
        sub.set_defaults(handler=handler)
        return sub

    _serve_options(command(commands.serve))
    _run_options(command(commands.run))
    export = command(commands.export)
    export.add_argument("design", metavar="NAME|FILE")
    add_body_options(export)
    add_set_option(export)
    add_fit_option(export)
    export.add_argument("--out", required=True, type=Path, metavar="DIR")
    export.add_argument("--tets", action="store_true", help="also tetrahedra: about a minute")
    text = "also mitsuba/scene.xml, the sensor at rest for the renderer Mitsuba 3"
    export.add_argument("--mitsuba", action="store_true", help=text)
    export.add_argument("--json", action="store_true")
    command(commands.presets).add_argument("--json", action="store_true")
    for handler in (commands.validate, commands.bench):
        sub = command(handler)
        sub.add_argument("room", metavar="ROOM")
        sub.add_argument("--json", action="store_true")
        if handler is commands.validate:
            text = "an independent program to compare with: mitsuba, for optics"
            sub.add_argument("--reference", metavar="NAME", help=text)
            text = "for forces: a data set to score learned forces on, instead of what ships"
            sub.add_argument("--data", type=Path, metavar="DATA", help=text)
        else:
            text = "also keep the rows with this machine's name and the date"
            sub.add_argument("--record", type=Path, metavar="FILE", help=text)
    compare = command(commands.compare)
    compare.add_argument("images", type=Path, metavar="DIR")
    compare.add_argument("reference", type=Path, metavar="DIR")
    compare.add_argument("--out", type=Path, metavar="DIR", help="also comparison.html and .json")
    compare.add_argument("--json", action="store_true")
    _sweep_options(command(sweep_command.sweep))
    text = "Make, check and show data sets of presses for learning."
    sets = subparsers.add_parser("dataset", help=text, description=text)
    dataset_command.add_dataset_commands(sets, common)
    evaluate_command.add_evaluate_options(command(evaluate_command.evaluate))
    text = "Train networks on data sets of presses."
    training = subparsers.add_parser("train", help=text, description=text)
    train_command.add_train_commands(training, common)
    text = "Solve presses by finite elements, or have another program check them."
    fem = subparsers.add_parser("fem", help=text, description=text)
    add_fem_commands(fem, common)
    command(commands.doctor)
    return top


def _sweep_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("design", metavar="NAME|FILE", help="a file brings its press")
    add_body_options(sub)
    text = "for example design.shape.length_mm or case.press.depth_mm"
    sub.add_argument("--field", required=True, metavar="FIELD", help=text)
    sub.add_argument("--from", dest="start", required=True, type=float, metavar="VALUE")
    sub.add_argument("--to", dest="stop", required=True, type=float, metavar="VALUE")
    sub.add_argument("--steps", type=int, default=5, help="2 to 15, both ends included (default 5)")
    sub.add_argument("--metric", metavar="NAME", help="figure of the plot (default: mean change)")
    sub.add_argument("--parts", action="store_true", help="also mould and housing, for checks")
    add_press_options(sub)
    sub.add_argument("--out", required=True, type=Path, metavar="DIR")
    sub.add_argument("--json", action="store_true", help="progress as one JSON object per line")


def _serve_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("design", nargs="?", metavar="NAME|FILE", help="default: where you left")
    add_unit_option(sub)
    sub.add_argument("--host", default="127.0.0.1", help="default 127.0.0.1; others need a token")
    sub.add_argument("--port", type=int, default=8080)
    sub.add_argument("--open", action="store_true", help="open the system's browser")
    sub.add_argument("--fast-scene", action="store_true", help="no shadows: software rendering")
    sub.add_argument("--no-tour", action="store_true", help="no tour for a browser that is new")


def _run_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("design", metavar="NAME|FILE")
    add_body_options(sub)
    add_press_options(sub)
    add_fit_option(sub)
    text = "exit 1 where a check of mould, housing or recipe is red"
    sub.add_argument("--strict", action="store_true", help=text)
    text = "write depth, normals and masks of every pixel: frames.npz, some 4 MB an image"
    sub.add_argument("--image-fields", action="store_true", help=text)
    text = "totals side by side in sources.csv: mpm, learned (seconds), fem (minutes)"
    sub.add_argument("--sources", default="", metavar="S,S", help=text)
    text = "force network of --sources learned (default: what ships)"
    sub.add_argument("--weights", type=Path, metavar="FILE", help=text)
    sub.add_argument("--out", required=True, type=Path, metavar="DIR")
    sub.add_argument("--json", action="store_true", help="progress as one JSON object per line")


if __name__ == "__main__":
    sys.exit(entry())
