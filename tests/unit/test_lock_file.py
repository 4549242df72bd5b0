"""The lock of a folder: one living process holds it; the dead and the damaged are taken over."""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from workbench.system.lock_file import LockFile
from workbench.system.processes import started


def written(lock: LockFile, **changes: object) -> None:
    """A lock that another process left."""
    lock.path.parent.mkdir(parents=True, exist_ok=True)
    lock.path.write_text(json.dumps({**dataclasses.asdict(lock.own), "mark": "other", **changes}))


def ended() -> int:
    """Number of a process that has ended."""
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def test_the_second_learns_who_has_it(tmp_path: Path) -> None:
    """It names the first, until that gives the folder back."""
    first, second = LockFile(tmp_path, link="http://here/"), LockFile(tmp_path)
    assert first.take() is None
    assert second.take() == first.own
    assert (first.is_own, second.is_own) == (True, False)
    second.release()
    assert first.is_own
    first.release()
    assert second.take() is None


def test_who_takes_it_over_has_it(tmp_path: Path) -> None:
    """The one before sees it, and does not give back what is not its own."""
    first, second = LockFile(tmp_path), LockFile(tmp_path)
    first.take()
    second.seize()
    assert (first.is_own, second.is_own) == (False, True)
    first.release()
    assert second.is_own


@pytest.mark.parametrize("what", ["dead", "not reaped", "number used again", "garbage", "empty"])
def test_nobody_is_held_up_by_what_is_gone(what: str, tmp_path: Path) -> None:
    """A dead process, a living one that is another, a file that says nothing."""
    lock = LockFile(tmp_path)
    if what == "dead":
        written(lock, pid=ended())
    elif what == "not reaped":
        # Its parent has not asked how it ended, and in some containers nobody ever does.
        process = subprocess.Popen([sys.executable, "-c", "print('on')"], stdout=subprocess.PIPE)
        began = started(process.pid)
        assert process.stdout is not None
        process.stdout.read()
        time.sleep(0.2)
        written(lock, pid=process.pid, started=began)
    elif what == "number used again":
        if not started(os.getpid()):
            pytest.skip("the system does not tell when a process began")
        written(lock, started="1")
    else:
        lock.path.write_bytes(b"\x00garbage" if what == "garbage" else b"")
    assert lock.take() is None
    assert lock.is_own


def test_another_machine_keeps_it_until_it_is_taken_over(tmp_path: Path) -> None:
    """Its processes cannot be seen from here."""
    lock = LockFile(tmp_path)
    written(lock, host="elsewhere", pid=ended())
    holder = lock.take()
    assert holder is not None and holder.elsewhere
    lock.seize()
    assert lock.is_own
