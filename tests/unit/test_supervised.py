"""Ctrl-C ends a command within seconds, whatever it is doing, and nothing is left running."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest

from workbench.cli.supervised import GRACE_S

SLACK_S = 4.0
"""Of a busy machine, over the time that a command is given."""


def start(body: str, tmp_path: Path) -> subprocess.Popen[str]:
    """A supervised command in a fresh process; it writes the number of its child to a file."""
    text = f"""
        import os, signal, sys, time
        from pathlib import Path
        from workbench.cli.supervised import supervised

        def command():
            Path({str(tmp_path / "child")!r}).write_text(str(os.getpid()))
            signal.signal(signal.SIGTERM, signal.default_int_handler)
            return work()

        def work():
            print("ready", flush=True)
{textwrap.indent(textwrap.dedent(body), " " * 12)}

        def ended(number):
            print("ended by", number, flush=True)
            return 3

        sys.exit(supervised(command, ended=ended))
    """
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(text)],
        stdout=subprocess.PIPE,
        text=True,
        cwd=Path(__file__).parents[2],
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    return process


def child_of(tmp_path: Path) -> int:
    return int((tmp_path / "child").read_text())


def is_gone(number: int) -> bool:
    """Whether a process ends within the slack."""
    until = time.monotonic() + SLACK_S
    while time.monotonic() < until:
        try:
            os.kill(number, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.05)
    return False


@pytest.mark.parametrize("code", [0, 2, 3])
def test_the_exit_code_is_passed_on(code: int, tmp_path: Path) -> None:
    """A command's own code and what it prints."""
    process = start(f"print('done', flush=True)\nreturn {code}", tmp_path)
    # Not `communicate`: it does not know of what was read with the first line.
    assert process.stdout is not None
    out = process.stdout.read()
    assert (process.wait(30), out) == (code, "done\n")


@pytest.mark.parametrize("asked", [signal.SIGINT, signal.SIGTERM])
def test_a_command_that_listens_ends_by_itself(asked: int, tmp_path: Path) -> None:
    """It hears KeyboardInterrupt, tidies up, and the code is 130."""
    body = """
        try:
            time.sleep(60)
        except KeyboardInterrupt:
            print("tidy", flush=True)
        return 0
        """
    process = start(body, tmp_path)
    time.sleep(0.5)
    began = time.monotonic()
    process.send_signal(asked)
    out, _ = process.communicate(timeout=30)
    assert (process.returncode, out) == (130, "tidy\n")
    assert time.monotonic() - began < SLACK_S


@pytest.mark.parametrize("asked", [signal.SIGINT, signal.SIGTERM])
def test_native_code_that_hears_nothing_is_killed(asked: int, tmp_path: Path) -> None:
    """A C function that holds the interpreter for a minute: 130 within the grace."""
    # PyDLL keeps the interpreter's lock during the call, as the CAD kernel does.
    process = start("import ctypes\nctypes.PyDLL(None).sleep(60)\nreturn 0", tmp_path)
    time.sleep(0.5)
    began = time.monotonic()
    process.send_signal(asked)
    process.communicate(timeout=30)
    assert process.returncode == 130
    assert time.monotonic() - began < GRACE_S + SLACK_S
    assert is_gone(child_of(tmp_path))


def test_a_crash_of_native_code_is_told(tmp_path: Path) -> None:
    """Signal 11 in the child: the parent lives and names it."""
    process = start("os.kill(os.getpid(), signal.SIGSEGV)\ntime.sleep(60)", tmp_path)
    out, _ = process.communicate(timeout=30)
    assert (process.returncode, out) == (3, "ended by 11\n")


@pytest.mark.skipif(sys.platform != "linux", reason="the system ends orphans on Linux alone")
def test_a_killed_parent_leaves_no_child(tmp_path: Path) -> None:
    """kill -9 of the process that was started ends the one that computes."""
    process = start("import ctypes\nctypes.PyDLL(None).sleep(60)\nreturn 0", tmp_path)
    process.kill()
    process.communicate(timeout=30)
    assert is_gone(child_of(tmp_path))
