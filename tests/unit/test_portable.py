"""What Windows and macOS lack is not needed: modules, signals, calls, and the letters of a file."""

from __future__ import annotations

import ast
import ctypes
import io
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from workbench.cli import supervised
from workbench.system import processes, terminal

ROOT = Path(__file__).parents[2]
PACKAGES = ("workbench", "designs", "geometry", "sim", "ui")
FIXED = ("/tmp", "/dev/", "/usr/", "/bin/", "/var/")
WITHOUT_POSIX = """
import importlib, importlib.abc, os, signal, sys

class Refuse(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name in {"fcntl", "resource", "pwd", "grp", "termios"}:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

import multiprocessing.spawn, subprocess, tempfile  # use them where they are
for name in {"fcntl", "resource", "pwd", "grp", "termios"}:
    sys.modules.pop(name, None)
sys.meta_path.insert(0, Refuse())
for module, names in (
    (os, ("fork", "sched_getaffinity", "getuid", "getloadavg", "statvfs")),
    (signal, ("SIGALRM", "SIGPROF", "SIGIO", "SIGKILL", "SIGHUP", "setitimer", "alarm")),
):
    for name in names:
        delattr(module, name)
"""
"""Python as it is on Windows, as far as our modules can tell."""
STARTED = """
from geometry.intake import cad_child, cad_file
from workbench.cli import command_line
from workbench.system.processes import cores, follow_parent
import ui.app, workbench.learning.making.collect, workbench.project.project
from sim.optics.transport import wavefront

cad_child._confine(1.0)
follow_parent()
assert cores() >= 1
assert "more than 7 s" in cad_file._died("a.step", -14, 7.0).message
assert "exit status 1" in cad_file._died("a.step", 1, 7.0).message
sys.argv[1:] = ["presets"]
sys.exit(command_line.entry())
"""


def sources() -> list[Path]:
    """Every module of ours."""
    return [path for top in PACKAGES for path in sorted((ROOT / top).rglob("*.py"))]


def test_it_starts_where_there_is_no_posix() -> None:
    """No fcntl, resource, fork nor alarms: modules import, and a command answers."""
    code = WITHOUT_POSIX + STARTED
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, env=env, check=False)
    assert done.returncode == 0, done.stderr
    assert "geltip" in done.stdout


def test_text_files_say_their_encoding_and_no_path_is_fixed() -> None:
    """Windows would read them by its code page; and only POSIX has /tmp, and a shell."""
    found: list[str] = []
    for file in sources():
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                words = {word.arg: ast.unparse(word.value) for word in node.keywords}
                is_text = node.func.attr in ("read_text", "write_text")
                if (is_text and "encoding" not in words) or words.get("shell") == "True":
                    found.append(f"{file}: {ast.unparse(node)}")
            if isinstance(node, ast.Constant) and str(node.value).startswith(FIXED):
                found.append(f"{file}: {node.value!r}")
    assert not found


def test_names_of_files_differ_by_more_than_case() -> None:
    """`Press.py` and `press.py` are one file on Windows and macOS."""
    command = ["git", "ls-files"]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    names = listed.stdout.splitlines()
    assert len(names) > 500
    assert len({name.lower() for name in names}) == len(names)


@pytest.mark.parametrize(
    ("handle", "waited", "error", "alive"),
    [(7, 0x102, 0, True), (7, 0, 0, False), (0, 0, 5, True), (0, 0, 87, False)],
    ids=["running", "ended", "of another user", "no such process"],
)
def test_windows_is_asked_without_a_signal(
    monkeypatch: pytest.MonkeyPatch, handle: int, waited: int, error: int, alive: bool
) -> None:
    """`os.kill(pid, 0)` sends Ctrl-C there; a handle's wait says the same and harms nobody."""
    closed: list[int] = []

    class OpenProcess:
        def __call__(self, right: int, inherit: bool, pid: int) -> int:
            assert pid == 42
            return handle

    system = SimpleNamespace(
        OpenProcess=OpenProcess(),
        WaitForSingleObject=lambda found, wait_ms: waited,
        CloseHandle=lambda found: closed.append(found.value),
    )
    monkeypatch.setattr(ctypes, "WinDLL", lambda *a, **k: system, raising=False)
    monkeypatch.setattr(ctypes, "get_last_error", lambda: error, raising=False)
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setattr(os, "kill", lambda *a: pytest.fail("a signal was sent"))
    assert processes.is_alive(42) is alive
    assert closed == ([handle] if handle else [])
    assert not processes.is_alive(10**30)


def test_macos_does_not_fork(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its libraries may crash in a child that only forked."""
    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.setattr(os, "fork", lambda: pytest.fail("it forked"))
    assert supervised.supervised(lambda: 5, ended=lambda number: 0) == 5


def test_a_console_without_the_letters_still_gets_the_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """An unknown letter becomes a question mark, not a crash."""
    raw = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(raw, encoding="ascii"))
    terminal.say("5 µm")
    assert raw.getvalue() == f"5 ?m{os.linesep}".encode()
