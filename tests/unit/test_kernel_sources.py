"""Sources of kernels are read once, and what Taichi says of a wrong one stays what it was."""

from __future__ import annotations

import inspect
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from workbench.pipeline.kernel_sources import RememberedWrapper

PROGRAM = """
import contextlib, inspect, io, sys
import taichi as ti
from workbench.pipeline.kernel_sources import remember_sources

if sys.argv[1] == "remembered":
    remember_sources()
    remember_sources()
with contextlib.redirect_stdout(io.StringIO()):
    ti.init(arch=ti.cpu, log_level=ti.ERROR)
reads, read = [], inspect.getsourcelines
inspect.getsourcelines = lambda thing: reads.append(thing.__name__) or read(thing)

@ti.func
def twice(x):
    return x + x

@ti.kernel
def fourfold(x: ti.f32) -> ti.f32:
    return twice(twice(x) + twice(0.0 * x))

@ti.kernel
def wrong(x: ti.f32) -> ti.f32:
    return twice(x) + a_name_that_is_not_there + 1.0 * twice(
        x)

print(fourfold(1.5), reads.count("twice"))
try:
    wrong(1.0)
except ti.TaichiCompilationError as error:
    print(error)
"""


def said(folder: Path, how: str) -> list[str]:
    """What the program prints: a value and the times that `twice` was read, and a message."""
    path = folder / "program.py"
    path.write_text(PROGRAM)
    done = subprocess.run(
        [sys.executable, str(path), how], capture_output=True, text=True, check=True
    )
    # Taichi greets.
    return [line for line in done.stdout.splitlines() if not line.startswith("[Taichi]")]


def test_a_source_is_read_once_and_messages_stay(tmp_path: Path) -> None:
    """4 x 1.5 = 6 by both; `twice` is read once and not three times; one message of both."""
    plain, remembered = (said(tmp_path, how) for how in ("plain", "remembered"))
    assert plain[0] == "6.0 3"
    assert remembered[0] == "6.0 1"
    assert plain[1:] == remembered[1:]
    assert "a_name_that_is_not_there" in "".join(remembered[1:])


@pytest.mark.parametrize("width", [20, 80])
def test_lines_are_wrapped_as_before(width: int) -> None:
    """Every line of a file, twice: what `textwrap` makes of it, in a list of the caller's own."""
    lines = inspect.getsource(inspect).splitlines()[:300]
    plain, wrapper = textwrap.TextWrapper(width=width), RememberedWrapper(width=width)
    for line in [*lines, *lines]:
        wrapper.wrap(line).append("mine")
        assert wrapper.wrap(line) == plain.wrap(line)
