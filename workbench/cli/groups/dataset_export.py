"""`workbench dataset export`: a data set as a folder of photographs with labels."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from workbench.cli.command import Command
from workbench.project.project import Project
from workbench.system.terminal import Progress, say


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("folder", type=Path, metavar="DIR", help="the data set")
    what = sub.add_mutually_exclusive_group(required=True)
    text = "write each image, with labels.csv, into a new folder"
    what.add_argument("--images", type=Path, metavar="DIR", help=text)
    text = "write the sequences of eight images that the recipe slip lists"
    what.add_argument("--windows", type=Path, metavar="DIR", help=text)
    text = "images with markers; sequences always have them"
    sub.add_argument("--marked", action="store_true", help=text)
    sub.add_argument("--json", action="store_true", help="answer as JSON")


def run(options: argparse.Namespace, project: Project) -> int:
    """Write a data set as a folder of images with labels, for networks of one's own."""
    from workbench.learning.dataset.folder import DataSet
    from workbench.learning.dataset.photo_export import export_images, export_windows

    data = DataSet.open(options.folder)
    printer = Progress(as_json=options.json)

    def monitor(fraction: float, note: str = "") -> None:
        printer("export", fraction, note)

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


COMMAND = Command(place=6, run=run, options=options)
