"""A worker ends with its server, even while it computes with Python's lock held."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

PARENT = """
import multiprocessing, os, sys
from tests.unit.test_orphans import compute

if __name__ == "__main__":
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    child = context.Process(target=compute, args=(there,))
    child.start()
    print(here.recv(), flush=True)
    sys.stdin.read()
"""


def compute(pipe: object) -> None:
    """One call that lasts a minute and gives no other thread a turn, as a CAD kernel's boolean."""
    from workbench.system.processes import follow_parent

    follow_parent()
    pipe.send(os.getpid())  # type: ignore[attr-defined]
    pow(7, 3 * 10**8)


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processes are read from /proc")
def test_a_worker_that_holds_the_lock_dies_with_its_server(tmp_path: Path) -> None:
    """Killed by -9, the server leaves nothing behind."""
    script = tmp_path / "server.py"
    script.write_text(PARENT)
    root = Path(__file__).parents[2]
    server = subprocess.Popen(
        [sys.executable, str(script)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(root)},
    )
    assert server.stdout is not None
    worker = int(server.stdout.readline())
    time.sleep(0.3)
    server.kill()
    server.wait()
    try:
        until = time.monotonic() + 5.0
        while running(worker) and time.monotonic() < until:
            time.sleep(0.05)
        assert not running(worker)
    finally:
        if running(worker):
            os.kill(worker, signal.SIGKILL)


def running(pid: int) -> bool:
    """Whether a process is there and has not ended."""
    from workbench.system.processes import is_alive

    return is_alive(pid)
