"""Starts workbench servers as forks of one process that has imported all that they need.

A server and its three workers import for ten seconds of a processor's time before they do
anything; a fork has all of it from the first moment. A worker that is killed comes back as it does
for a user, by itself.
"""

from __future__ import annotations

import contextlib
import importlib
import multiprocessing
import os
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from workbench.system.processes import is_alive


class Fork:
    """A running fork, with what tests ask of a `subprocess.Popen`."""

    def __init__(self, pid: int) -> None:
        self.pid = pid

    def poll(self) -> int | None:
        """None while it runs; its exit code is not known."""
        return None if is_alive(self.pid) else 0

    def send_signal(self, number: int) -> None:
        """Send a signal, unless it has ended."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.pid, number)

    def kill(self) -> None:
        """kill -9."""
        self.send_signal(signal.SIGKILL)

    def wait(self, timeout: float) -> None:
        """Wait for its end [s].

        Raises:
            subprocess.TimeoutExpired: If it does not end in time.
        """
        deadline = time.monotonic() + timeout
        while self.poll() is None:
            if time.monotonic() > deadline:
                raise subprocess.TimeoutExpired(f"fork {self.pid}", timeout)
            time.sleep(0.02)


class WarmStart:
    """The process that forks."""

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, child = context.Pipe()
        # Not a daemon: servers start processes of their own.
        self._process = context.Process(target=_wait_for_orders, args=(child,))
        self._process.start()
        child.close()

    def start(self, words: Sequence[str], project: Path, log: Path) -> Fork:
        """Run `workbench WORDS` on a project, its output in a log."""
        self._pipe.send((list(words), project, log))
        return Fork(self._pipe.recv())

    def close(self) -> None:
        """End the process; forks that still run go on."""
        self._pipe.close()
        self._process.join(10.0)


def _wait_for_orders(pipe: Any) -> None:
    import ui.app
    from workbench.live.lanes import WARM_UP

    for module in {*ui.app.DRAWING, *(name for names in WARM_UP.values() for name in names)}:
        importlib.import_module(module)
    # Nobody asks how a fork ended: without this it would stay in the table of processes.
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    with contextlib.suppress(EOFError):
        while True:
            words, project, log = pipe.recv()
            child = os.fork()
            if not child:
                pipe.close()
                _serve(words, project, log)
            pipe.send(child)


def _serve(words: list[str], project: Path, log: Path) -> NoReturn:
    from workbench.cli.command_line import main

    code = 70
    try:
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        out = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(out, 1)
        os.dup2(out, 2)
        sys.stdout = open(1, "w", buffering=1, closefd=False)
        sys.stderr = open(2, "w", buffering=1, closefd=False)
        _fork_workers(project)
        code = main(words)
    finally:
        os._exit(code)


def _fork_workers(project: Path) -> None:
    """Fork the workers now, while this process has a single thread; later ones are spawned."""
    import ui.app
    from workbench.live import lanes
    from workbench.project.project import Project

    contexts = {name: multiprocessing.get_context(name) for name in ("fork", "spawn")}
    serve = lanes.serve

    def serve_alone(name: str, modules: Sequence[str], root: Path, pipe: Any, flag: Any) -> None:
        # The other workers' pipes: a worker ends when its own is closed by all who hold it.
        for number in map(int, os.listdir("/proc/self/fd")):
            with contextlib.suppress(OSError):
                if number != pipe.fileno() and stat.S_ISSOCK(os.fstat(number).st_mode):
                    os.close(number)
        serve(name, modules, root, pipe, flag)

    class Forked(lanes.Lane):
        def _start(self) -> None:
            self._context = contexts["fork"]
            lanes.serve = serve_alone
            super()._start()
            lanes.serve, self._context = serve, contexts["spawn"]
            self.__class__ = lanes.Lane

    plain, lanes.Lane = lanes.Lane, Forked
    runner = lanes.LaneRunner(Project(project).store)
    lanes.Lane = plain

    def made(store: Any) -> lanes.LaneRunner:
        runner.store = store
        return runner

    ui.app.LaneRunner = made
