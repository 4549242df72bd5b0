"""`workbench reader export`: a reader that runs without the workbench."""

from __future__ import annotations

import argparse
from pathlib import Path

from workbench.cli.command import Command
from workbench.cli.options import OUT
from workbench.project.project import Project
from workbench.system.terminal import say


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("file", type=Path, metavar="FILE", help="file of `reader train`")
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help=OUT)


def run(options: argparse.Namespace, project: Project) -> int:
    """Write a reader as TorchScript, with a script that reads cameras, videos and photographs."""
    from sim.reading.network.reader_file import load_reader
    from workbench.reading.export_reader import export_reader
    from workbench.system.folder import prepare

    reader = load_reader(options.file)
    prepare(options.out)
    network, script = export_reader(reader, options.out)
    say(f"wrote {network} and {script}; they need PyTorch, NumPy and OpenCV alone")
    return 0


COMMAND = Command(place=2, run=run, options=options)
