"""`workbench dataset export`: a data set as photographs with labels, or for LeRobot."""

from __future__ import annotations

import argparse
import dataclasses
import json
from pathlib import Path
from typing import TYPE_CHECKING

from workbench.cli.command import Command
from workbench.core.base.monitor import Monitor
from workbench.project.project import Project
from workbench.system.terminal import Progress, say

if TYPE_CHECKING:
    from workbench.learning.dataset.folder import DataSet


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("folder", type=Path, metavar="DIR", help="the data set")
    what = sub.add_mutually_exclusive_group(required=True)
    text = "write each image, with labels.csv, into a new folder"
    what.add_argument("--images", type=Path, metavar="DIR", help=text)
    text = "write the sequences of eight images that the recipe slip lists"
    what.add_argument("--windows", type=Path, metavar="DIR", help=text)
    text = "write it in the format of LeRobot v3.0: an episode for each press path"
    what.add_argument("--lerobot", type=Path, metavar="DIR", help=text)
    text = "images with markers; sequences always have them"
    sub.add_argument("--marked", action="store_true", help=text)
    sub.add_argument("--json", action="store_true", help="answer as JSON")


def run(options: argparse.Namespace, project: Project) -> int:
    """Write a data set as a folder of images with labels, or for LeRobot."""
    from workbench.learning.dataset.folder import DataSet
    from workbench.learning.dataset.photo_export import export_images, export_windows

    data = DataSet.open(options.folder)
    printer = Progress(as_json=options.json)

    def monitor(fraction: float, note: str = "") -> None:
        printer("export", fraction, note)

    if options.lerobot is not None:
        return _lerobot(data, options, monitor)
    if options.windows is not None:
        out, what = options.windows, "sequences"
        count = export_windows(data, out, monitor)
    else:
        out, what = options.images, "images"
        count = export_images(data, out, monitor, marked=options.marked)
    if options.json:
        say(json.dumps({"folder": str(out), what: count}))
    else:
        say(f"{count} {what} in {out}")
    return 0


def _lerobot(data: DataSet, options: argparse.Namespace, monitor: Monitor) -> int:
    from workbench.learning.lerobot.export import export_lerobot

    written = export_lerobot(data, options.lerobot, monitor, marked=options.marked)
    if options.json:
        say(json.dumps({"folder": str(options.lerobot), **dataclasses.asdict(written)}))
        return 0
    text = f"{written.episodes} episodes of {written.frames} frames in {options.lerobot}"
    rest = f"; {written.left_out} cases are not whole" if written.left_out else ""
    say(text + rest)
    return 0


COMMAND = Command(place=6, run=run, options=options)
