"""Whether another process of this machine is still there."""

from __future__ import annotations

import os
from pathlib import Path


def is_alive(pid: int) -> bool:
    """Whether there is a process of this number; it may belong to another user."""
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
    return True


def started(pid: int) -> str:
    """When a process began, as Linux counts (starttime of proc(5)); "" where that is not known."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except (OSError, UnicodeDecodeError):
        return ""
    # Field 22 of the line, and the third is the first one after the name in brackets.
    return fields[19]
