"""Whether another process of this machine is still there."""

from __future__ import annotations

import os


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
