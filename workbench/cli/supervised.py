"""A command in a process of its own, so that Ctrl-C ends it whatever it is doing.

The CAD kernel, the mesher and the solvers run native code for up to a minute, during which Python
answers no signal, and a crash in it would take the command along without a word. So the process
that was started only waits: it forks before anything heavy is imported, passes on the exit code,
asks the child to stop when it is asked itself, and kills it when it does not listen. What the child
has stored by then is whole, because results are written under another name and renamed.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

GRACE_S = 2.0
"""Time that a command has to end by itself after Ctrl-C [s]."""
POLL_S = 0.02
PR_SET_PDEATHSIG = 1
"""Linux, prctl(2): the signal that a process gets when its parent dies."""


def supervised(command: Callable[[], int], *, ended: Callable[[int], int]) -> int:
    """Exit code of a command that runs in a child process.

    Where processes cannot fork it runs here; and on macOS, whose libraries may crash in a fork that
    goes on without starting another program.

    Args:
        command: What to run; it treats SIGTERM as Ctrl-C.
        ended: Told the signal that native code ended the child with; returns the exit code.
    """
    safe = hasattr(os, "fork") and sys.platform != "darwin"
    if not safe or threading.active_count() > 1:
        return command()
    parent = os.getpid()
    sys.stdout.flush()
    sys.stderr.flush()
    child = os.fork()
    if not child:
        # The terminal sends Ctrl-C to both; it is the parent that decides what comes of it.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        _end_with(parent)
        return command()
    asked = _Asked(child)
    before = {name: signal.signal(name, asked) for name in (signal.SIGINT, signal.SIGTERM)}
    try:
        status = asked.wait()
    finally:
        for name, handler in before.items():
            signal.signal(name, handler)
    if asked.since_s is not None:
        return 128 + signal.SIGINT
    code = os.waitstatus_to_exitcode(status)
    return ended(-code) if code < 0 else code


class _Asked:
    """Passes a request to stop on to the child, and insists."""

    def __init__(self, child: int) -> None:
        self.child = child
        self.since_s: float | None = None
        """When the first request came."""

    def __call__(self, number: int, frame: Any) -> None:
        """A signal came: ask the child once, and kill it at the second time of asking."""
        if self.since_s is None:
            self.since_s = time.monotonic()
            _send(self.child, signal.SIGTERM)
        else:
            _send(self.child, signal.SIGKILL)

    def wait(self) -> int:
        """Status of the child, once it has ended."""
        while True:
            done, status = os.waitpid(self.child, os.WNOHANG)
            if done:
                return status
            if self.since_s is not None and time.monotonic() - self.since_s > GRACE_S:
                _send(self.child, signal.SIGKILL)
            time.sleep(POLL_S)


def _send(child: int, number: int) -> None:
    try:
        os.kill(child, number)
    except ProcessLookupError:
        return


def _end_with(parent: int) -> None:
    """Let the system kill this process when its parent is killed."""
    if sys.platform != "linux":
        return
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)
