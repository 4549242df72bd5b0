"""Records that are made design by design: the command, and what is kept of those not named."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from workbench.core.base.errors import StoreError, WorkbenchError
from workbench.project.project import Project
from workbench.system.record import Record

DESIGNS = ("geltip", "pad", "trunk", "paw")
Measured = Callable[[str, Project], Any]
"""Figures of a design by its name, in a project."""


def record_by_design(
    record: Record, measured: Measured, about: str | None, words: Sequence[str] | None
) -> int:
    """Measure designs and record them; 1 where something failed.

    Args:
        record: Designs that are not named keep what it holds of them, by the same code.
        measured: Measures one.
        about: Text of the module, whose first line says what the command does.
        words: What was typed: a folder, and names of designs; None: those of the process.
    """
    parser = argparse.ArgumentParser(description=(about or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("designs", nargs="*", metavar="DESIGN")
    options = parser.parse_args(words)
    project = Project(options.folder)

    def figures() -> Iterator[tuple[str, Any]]:
        try:
            kept = {} if record.stale() else record.figures()["designs"]
        except StoreError:
            kept = {}
        for name in DESIGNS:
            if name in (options.designs or DESIGNS):
                yield name, measured(name, project)
            elif name in kept:
                yield name, kept[name]

    try:
        record.make(lambda: {"designs": dict(figures())})
    except WorkbenchError as error:
        print(f"error: {error.message}; {error.hint}", file=sys.stderr)
        return 1
    return 0
