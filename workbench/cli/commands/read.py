"""`workbench read`: photographs of the built sensor as depth, contact and force."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.cli.command import Command
from workbench.cli.options import DESIGN, OUT
from workbench.cli.press_arguments import add_set_option
from workbench.core.base.errors import DesignError
from workbench.project.project import Project
from workbench.system.terminal import Progress, complain, say

if TYPE_CHECKING:
    # It needs a device, which other commands need not wait for.
    from workbench.reading.design_reader import DesignReader
    from workbench.reading.read_photo import Reading
    from workbench.twin.scoring import ReadingScore
    from workbench.twin.truth import Truth

READERS = ("table",)


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("design", metavar="NAME|FILE", help=DESIGN)
    text = "photographs of the touched sensor, in the order of time"
    sub.add_argument("photos", nargs="+", type=Path, metavar="PHOTO", help=text)
    text = "photograph of the untouched sensor, by the same camera in the same light"
    sub.add_argument("--idle", required=True, type=Path, metavar="PHOTO", help=text)
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help=OUT)
    text = "table: the design's own light, without training (default: table)"
    sub.add_argument("--reader", choices=READERS, default=READERS[0], help=text)
    text = "each photo follows the one before at once: begin where that one ended"
    sub.add_argument("--video", action="store_true", help=text)
    text = "fit a ball to each photo as a model of its image: place, radius, depth; seconds more"
    sub.add_argument("--ball", action="store_true", help=text)
    text = "of photographs of a twin: its folder truth, and each reading is scored by it"
    sub.add_argument("--truth", type=Path, metavar="DIR", help=text)
    add_set_option(sub)
    sub.add_argument("--json", action="store_true", help="progress and figures as JSON lines")


def run(options: argparse.Namespace, project: Project) -> int:
    """Read touch from photographs of the sensor built from a design."""
    from workbench.edit.typed_fields import with_typed
    from workbench.pipeline.devices import open_device
    from workbench.project.named_designs import load_design
    from workbench.reading.design_reader import open_reader
    from workbench.reading.outputs import TABLE, names_of, write_reading, write_table
    from workbench.reading.read_photo import read_photo, with_ball
    from workbench.system.folder import prepare

    design = with_typed(load_design(options.design, project=project), options.set)
    idle = _photo(options.idle)
    photos = [_photo(path) for path in options.photos]
    truths = _truths(options.truth, options.photos)
    prepare(options.out, clear=(TABLE,))
    project.sweep()
    open_device()
    printer = Progress(as_json=options.json)
    opened = open_reader(
        design,
        idle,
        project.store,
        monitor=lambda fraction, note="": printer("read", 0.5 * fraction, note),
    )
    if not opened.tells_force:
        complain(
            "notice: the wall of this design rests on gel or air, or has pins: no force is told"
        )
    # Of a long video only figures are kept, and what the next image begins with.
    rows, lines, before = [], [], None
    scored = _Scored(opened, truths)
    for number, (name, path, photo) in enumerate(
        zip(names_of(options.photos), options.photos, photos, strict=True)
    ):
        printer("read", 0.5 + 0.5 * number / len(photos), path.name)
        found = read_photo(opened, path.name, photo, before)
        if options.ball:
            found = with_ball(opened, found, photo)
        write_reading(options.out, name, found)
        rows.append(found.figures | scored.figures(found, path))
        lines.append(_line(found))
        before = found.touch if options.video else None
    write_table(options.out, rows)
    if options.json:
        say(json.dumps(rows, allow_nan=False))
        return 0
    for line in (*lines, *scored.lines()):
        say(line)
    say(f"open {options.out / TABLE}")
    return 0


class _Scored:
    """Readings beside what is known of them."""

    def __init__(self, opened: DesignReader, truths: dict[Path, Truth]) -> None:
        from workbench.twin.scoring import Scorer

        self._scorer, self._truths = Scorer(opened), truths
        self._scores: list[ReadingScore] = []

    def figures(self, reading: Reading, path: Path) -> dict[str, Any]:
        """The score of a reading as `reading.json` holds it; empty where nothing is known."""
        if path not in self._truths:
            return {}
        self._scores.append(self._scorer.score(reading, self._truths[path]))
        return {"score": self._scores[-1].figures}

    def lines(self) -> list[str]:
        """The mean of all scores, for people."""
        from workbench.twin.scoring import mean_score

        if not self._scores:
            return []
        mean = mean_score(self._scores)
        return [
            f"depth off by {mean.depth_mm:.3f} mm (nothing read: {mean.depth_null_mm:.3f}, normals "
            f"known: {mean.depth_ceiling_mm:.3f}), normals by {mean.normal_deg:.1f} degrees "
            f"({mean.normal_null_deg:.1f}), contact IoU {mean.contact_iou:.2f}, force off by "
            f"{100.0 * mean.force_error:.0f} %, {100.0 * mean.within_sigma:.0f} % of depths within "
            "one standard deviation"
        ]


def _truths(folder: Path | None, photos: list[Path]) -> dict[Path, Truth]:
    """What is known of each photograph, by its path."""
    from workbench.twin.truth import read_truth

    if folder is None:
        return {}
    return {path: read_truth(folder / f"{path.stem}.npz") for path in photos}


def _line(reading: Reading) -> str:
    """A reading in one line."""
    size_N = float(np.linalg.norm(reading.force_N))
    force = f"{size_N:.2f} +- {reading.force_sigma_N:.2f} N"
    return (
        f"{reading.photo:20} {reading.touch.inward_mm.max():5.2f} mm deep, "
        f"{reading.contact_area_mm2:6.1f} mm2, "
        f"{force if np.isfinite(size_N) else 'force unknown'}, misfit {reading.touch.misfit:.1f}"
    )


def _photo(path: Path) -> np.ndarray:
    """A photograph's grey levels, shape (H, W, 3), uint8.

    Raises:
        DesignError: If there is none.
    """
    from workbench.photographs.photo_files import decoded

    try:
        data = path.read_bytes()
    except OSError as error:
        raise DesignError(
            f"{path} cannot be read: {error.strerror or error}",
            hint="name a photograph that exists, as PNG or JPEG",
            at="photo",
        ) from error
    return decoded(path.name, data)


COMMAND = Command(place=5, run=run, options=options)
