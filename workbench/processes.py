"""Whether another process of this machine is still there."""

from __future__ import annotations

import os
from pathlib import Path

ENDED = ("Z", "X")
"""States of a process that has ended (proc(5)): zombie and dead."""


def is_alive(pid: int) -> bool:
    """Whether there is a process of this number; it may belong to another user.

    One that has ended stays in the table until its parent asks for its exit status, which some
    never do: it holds nothing any more.
    """
    if pid <= 0:
        # To the system such a number is a group of processes, not one.
        return False
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        # The second: a number that no process can have, from a damaged file.
        return False
    except PermissionError:
        return True
    return _state(pid) not in ENDED


def started(pid: int) -> str:
    """When a process began, as Linux counts (starttime of proc(5)); "" where that is not known."""
    # Field 22 of the line, and the third is the first one after the name in brackets.
    return _stat(pid, 22 - 3)


def _state(pid: int) -> str:
    """State letter of a process; "" where that is not known."""
    return _stat(pid, 0)


def _stat(pid: int, number: int) -> str:
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except (OSError, UnicodeDecodeError):
        return ""
    return fields[number]
