"""Runs commands by the hundred: each in a fork of one process that has imported everything.

A fork dies as the command does: its signal, its exit code, its time and its memory are seen.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Ended:
    """How a command ended."""

    code: int
    """Exit code; a signal is negative, one that took too long -9."""
    wall_s: float
    cpu_s: float
    """Of it and of what it started: what a quiet machine would have taken, or less."""
    memory_mb: float
    stdout: str
    stderr: str


class Forks:
    """One warm process that forks for every command."""

    def __init__(self, prepare: Callable[[], None]) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, child = context.Pipe()
        # Not a daemon: commands start processes of their own.
        self._process = context.Process(target=_serve, args=(child, prepare))
        self._process.start()
        child.close()

    def __enter__(self) -> Forks:
        return self

    def __exit__(self, *raised: object) -> None:
        self._pipe.close()
        self._process.join(10.0)

    def run(self, words: Sequence[str], folder: Path, *, limit_s: float) -> Ended:
        """Run one command with `folder` as its working directory."""
        self._pipe.send((list(words), folder, limit_s))
        code, wall_s, usage = self._pipe.recv()
        said = [(folder / name).read_text(errors="replace") for name in ("stdout", "stderr")]
        return Ended(
            code=code,
            wall_s=wall_s,
            cpu_s=usage.ru_utime + usage.ru_stime,
            memory_mb=usage.ru_maxrss / 1024,
            stdout=said[0],
            stderr=said[1],
        )


def _serve(pipe: Any, prepare: Callable[[], None]) -> None:

    prepare()
    with contextlib.suppress(EOFError):
        while True:
            words, folder, limit_s = pipe.recv()
            started = time.monotonic()
            child = os.fork()
            if not child:
                _command(words, folder)
            status, usage = _waited(child, started + limit_s)
            pipe.send((os.waitstatus_to_exitcode(status), time.monotonic() - started, usage))


def _waited(child: int, deadline: float) -> tuple[int, Any]:
    while True:
        done, status, usage = os.wait4(child, os.WNOHANG)
        if done:
            return status, usage
        if time.monotonic() > deadline:
            os.killpg(child, signal.SIGKILL)
        time.sleep(0.01)


def _command(words: list[str], folder: Path) -> None:
    """Run the command line in this fork, which ends here."""
    from workbench.cli.command_line import main

    code = 70
    try:
        os.setsid()
        os.chdir(folder)
        for name, number in (("stdout", 1), ("stderr", 2)):
            os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
        try:
            code = main(words)
        except SystemExit as ended:
            code = ended.code if isinstance(ended.code, int) else 0
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(code)
