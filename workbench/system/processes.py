"""Processes of this machine: whether one is still there, how many may compute, how one ends."""

from __future__ import annotations

import contextlib
import ctypes
import multiprocessing
import os
import signal
import sys
import threading
from pathlib import Path
from typing import Any

ENDED = ("Z", "X")
"""States of a process that has ended (proc(5)): zombie and dead."""
SYNCHRONIZE, ACCESS_DENIED, STILL_RUNNING = 0x0010_0000, 5, 0x102
"""Windows: the right to wait for a process, the error without it, and the answer WAIT_TIMEOUT."""
LARGEST_WINDOWS_PID = 2**32 - 1


def cores() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def is_alive(pid: int) -> bool:
    """Whether there is a process of this number; it may belong to another user.

    One that has ended stays in the table until its parent asks for its exit status, which some
    never do: it holds nothing any more.
    """
    if pid <= 0:
        # To the system such a number is a group of processes, not one.
        return False
    if sys.platform == "win32":
        return _is_alive_on_windows(pid)
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


def _is_alive_on_windows(pid: int) -> bool:
    """The same where `os.kill` has no signal that only asks: 0 is Ctrl-C there."""
    if pid > LARGEST_WINDOWS_PID:
        return False
    windows: Any = ctypes
    system = windows.WinDLL("kernel32", use_last_error=True)
    system.OpenProcess.restype = ctypes.c_void_p
    handle = ctypes.c_void_p(system.OpenProcess(SYNCHRONIZE, False, pid))
    if not handle:
        return windows.get_last_error() == ACCESS_DENIED
    try:
        return system.WaitForSingleObject(handle, 0) == STILL_RUNNING
    finally:
        system.CloseHandle(handle)


def _state(pid: int) -> str:
    """State letter of a process; "" where that is not known."""
    return _stat(pid, 0)


def _stat(pid: int, number: int) -> str:
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except (OSError, UnicodeDecodeError):
        return ""
    return fields[number]


def follow_parent() -> None:
    """Leave no orphan: end this process when the server dies, whatever it is doing.

    The kernel's own signal ends it where that can be had: a thread gets no turn while a CAD kernel
    computes with Python's lock held.
    """
    parent = multiprocessing.parent_process()
    if parent is None:
        return
    with contextlib.suppress(ImportError, AttributeError, OSError, ValueError):
        import fcntl

        # What nobody writes to any more tells its reader, by SIGIO, whose default action is to end.
        signal.signal(signal.SIGIO, signal.SIG_DFL)
        fcntl.fcntl(parent.sentinel, fcntl.F_SETOWN, os.getpid())
        flags = fcntl.fcntl(parent.sentinel, fcntl.F_GETFL)
        fcntl.fcntl(parent.sentinel, fcntl.F_SETFL, flags | os.O_ASYNC)

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
