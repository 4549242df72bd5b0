"""A process is there until it has ended and its parent knows; numbers of none are not."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from workbench.system.processes import is_alive


def test_a_process_is_alive_until_it_has_ended() -> None:
    """Ourselves, a child that waits for input, and the same child after its end."""
    assert is_alive(os.getpid())
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as child:
        assert is_alive(child.pid)
        child.communicate(b"\n")
    assert not is_alive(child.pid)


def test_a_process_of_another_user_is_alive(monkeypatch: pytest.MonkeyPatch) -> None:
    """The system refuses the signal, which it only does where there is somebody to refuse."""

    def refuse(pid: int, number: int) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "kill", refuse)
    assert is_alive(1)


@pytest.mark.parametrize("pid", [0, -1, 10**30])
def test_numbers_that_no_process_has_are_not_alive(pid: int) -> None:
    """A group of processes, all processes, and a number beyond the system's."""
    assert not is_alive(pid)
