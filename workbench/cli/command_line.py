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
from typing import Any, NoReturn

from workbench.cli.command import Command, Group, commands, members
from workbench.cli.supervised import supervised
from workbench.core.base.errors import (
    Cancelled,
    DesignError,
    Stopped,
    StoreError,
    WorkbenchError,
    shown,
)
from workbench.core.base.packages import PackageError, naming_packages
from workbench.core.base.version import VERSION
from workbench.project.project import Project
from workbench.system.terminal import complain, say

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
        with request, naming_packages():
            return options.handler(options, project)
    except Stopped as stopped:
        return _print_cancelled(stopped.message)
    except PackageError as error:
        # A module that is interrupted while it is imported may say that it lacks another.
        return _print_cancelled() if request.asked else _print_error(error, as_json=as_json)
    except WorkbenchError as error:
        return _print_error(error, as_json=as_json)
    except KeyboardInterrupt:
        return _print_cancelled()
    except MemoryError:
        hint = "use a coarser mesh or grid, or fewer frames"
        memory = WorkbenchError("this machine ran out of memory", hint=hint)
        return _print_error(memory, as_json=as_json)
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
    top.add_argument("--version", action="version", version=VERSION)
    common = Parser(add_help=False)
    common.add_argument(
        "--project", metavar="DIR", help="project folder (default $WORKBENCH_PROJECT or .workbench)"
    )
    words = top.add_subparsers(dest="command", required=True)
    for name, command in commands().items():
        if isinstance(command, Group):
            group = words.add_parser(name, help=command.help, description=command.help)
            seconds = group.add_subparsers(dest=f"{name}_command", required=True)
            for second, member in members(name).items():
                _add(seconds, second, member, common)
        else:
            _add(words, name, command, common)
    return top


def _add(words: Any, name: str, command: Command, common: argparse.ArgumentParser) -> None:
    sub = words.add_parser(name, help=command.help, description=command.help, parents=[common])
    sub.set_defaults(handler=command.run)
    command.options(sub)
