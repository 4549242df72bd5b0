"""`workbench read`: photographs of the built sensor as depth, contact and force."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from workbench.cli.command import Command
from workbench.cli.options import DESIGN, OUT
from workbench.cli.press_arguments import add_set_option
from workbench.core.base.errors import DesignError
from workbench.project.project import Project
from workbench.system.terminal import Progress, complain, say

if TYPE_CHECKING:
    # They need a device or PyTorch, which other commands need not wait for.
    from workbench.core.base.monitor import Monitor
    from workbench.core.design.design import SensorDesign
    from workbench.reading.learned_reader import LearnedReading
    from workbench.reading.read_photo import Reading
    from workbench.twin.scored_readings import ScoredReadings

LEARNED = "learned"
READERS = ("table", LEARNED)
Read = Callable[[str, np.ndarray], "Reading | LearnedReading"]
"""Name of a photograph, and its grey levels, to what it says."""


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("design", metavar="NAME|FILE", help=DESIGN)
    text = "photographs of the touched sensor, in the order of time"
    sub.add_argument("photos", nargs="+", type=Path, metavar="PHOTO", help=text)
    text = "photograph of the untouched sensor, by the same camera in the same light"
    sub.add_argument("--idle", required=True, type=Path, metavar="PHOTO", help=text)
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help=OUT)
    text = "table: the design's own light, without training; learned: a network (default: table)"
    sub.add_argument("--reader", choices=READERS, default=READERS[0], help=text)
    text = "file of `reader train` (default: the project's for this design, or one that ships)"
    sub.add_argument("--weights", type=Path, metavar="FILE", help=text)
    text = "of a calibrated design: the one it was drawn as, whose learned reader reads it too "
    text += "(default: the project's or the preset of its name)"
    sub.add_argument("--drawn", metavar="NAME|FILE", help=text)
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
    from workbench.project.named_designs import load_design
    from workbench.reading.outputs import TABLE, names_of, write_reading, write_table
    from workbench.system.folder import prepare

    if options.weights is not None and options.reader != LEARNED:
        raise DesignError(
            "--weights are for the learned reader", hint="add --reader learned", at="--weights"
        )
    if options.drawn is not None and options.reader != LEARNED:
        raise DesignError(
            "--drawn is for the learned reader", hint="add --reader learned", at="--drawn"
        )
    if options.ball and options.reader == LEARNED:
        raise DesignError(
            "--ball is for the reader by the design's light", hint="add --reader table", at="--ball"
        )
    design = with_typed(load_design(options.design, project=project), options.set)
    idle = _photo(options.idle)
    photos = [_photo(path) for path in options.photos]
    scored = _scored(options, design, idle, project)
    prepare(options.out, clear=(TABLE,))
    project.sweep()
    printer = Progress(as_json=options.json)
    opened = _OPENED[options.reader](design, idle, options, project, printer)
    # Of a long video only figures are kept, and what the next image begins with.
    rows, lines = [], []
    for number, (name, path, photo) in enumerate(
        zip(names_of(options.photos), options.photos, photos, strict=True)
    ):
        printer("read", 0.5 + 0.5 * number / len(photos), path.name)
        found = opened(path.name, photo)
        write_reading(options.out, name, found)
        rows.append(found.figures | scored.figures(found, path.stem))
        lines.append(_line(found))
    write_table(options.out, rows)
    if options.json:
        say(json.dumps(rows, allow_nan=False))
        return 0
    for line in (*lines, *scored.lines()):
        say(line)
    say(f"open {options.out / TABLE}")
    return 0


def _opened_table(
    design: SensorDesign,
    idle: np.ndarray,
    options: argparse.Namespace,
    project: Project,
    printer: Progress,
) -> Read:
    """The reader by the design's light; of a video it begins where the photo before ended."""
    from workbench.pipeline.devices import open_device
    from workbench.reading.design_reader import open_reader
    from workbench.reading.read_photo import read_photo, with_ball

    open_device()
    opened = open_reader(design, idle, project.store, monitor=_half(printer))
    if not opened.tells_force:
        complain(
            "notice: the wall of this design rests on gel or air, or has pins: no force is told"
        )
    before = None

    def read(name: str, photo: np.ndarray) -> Reading:
        nonlocal before
        found = read_photo(opened, name, photo, before)
        before = found.touch if options.video else None
        return with_ball(opened, found, photo) if options.ball else found

    return read


def _opened_learned(
    design: SensorDesign,
    idle: np.ndarray,
    options: argparse.Namespace,
    project: Project,
    printer: Progress,
) -> Read:
    """The reader that was trained; each photo is read on its own.

    A built sensor for which none was is read by that of its design as it was drawn.
    """
    from workbench.calibration.stored import stored
    from workbench.core.press.press_case import PressCase
    from workbench.pipeline.devices import torch_device
    from workbench.reading.find_reader import find_reader
    from workbench.reading.learned_reader import LearnedReader
    from workbench.reading.relit_reader import drawn_design

    named = _drawn(options, design, project)
    if named is not None:
        return _opened_relit((design, named), idle, options, project, printer)
    try:
        weights = find_reader(design, project, options.weights)
    except DesignError:
        drawn = drawn_design(design, project)
        if drawn is None:
            raise
        return _opened_relit((design, drawn), idle, options, project, printer)
    mesh = stored(design, PressCase(), "mesh", project.store, _half(printer))
    return LearnedReader(weights, design.optics.camera, mesh, idle, torch_device()).read


def _drawn(
    options: argparse.Namespace, design: SensorDesign, project: Project
) -> SensorDesign | None:
    """The design that is named as the one that this sensor was built from.

    Raises:
        DesignError: If one is, but the sensor is not calibrated.
    """
    from workbench.project.named_designs import load_design

    if options.drawn is None:
        return None
    if design.optics.unit is None:
        raise DesignError(
            f"{design.name} is not calibrated, so it is not known how it differs from a drawn one",
            hint="calibrate it first: `workbench calibrate`",
            at="--drawn",
        )
    drawn = load_design(options.drawn, project=project)
    if drawn.optics.unit is not None:
        raise DesignError(
            f"{options.drawn} is of a built sensor itself",
            hint="name the design that it was cast from",
            at="--drawn",
        )
    return drawn


def _opened_relit(
    pair: tuple[SensorDesign, SensorDesign],
    idle: np.ndarray,
    options: argparse.Namespace,
    project: Project,
    printer: Progress,
) -> Read:
    """The reader of a drawn design for the sensor that was built from it."""
    from workbench.pipeline.devices import open_device, torch_device
    from workbench.reading.find_reader import find_reader
    from workbench.reading.relit_reader import open_relit

    weights = find_reader(pair[1], project, options.weights)
    open_device()
    complain(
        f"notice: photographs of this built sensor are relit as {pair[1].name} was drawn, and read "
        "by the reader of that"
    )
    opened = open_relit(
        pair, weights, idle, project.store, monitor=_half(printer), device=torch_device()
    )
    return opened.read


_OPENED = {"table": _opened_table, LEARNED: _opened_learned}


def _scored(
    options: argparse.Namespace, design: SensorDesign, idle: np.ndarray, project: Project
) -> ScoredReadings:
    """What readings are scored by: nothing without `--truth`."""
    from workbench.twin.scored_readings import ScoredReadings
    from workbench.twin.truth import read_truth

    stems = [path.stem for path in options.photos] if options.truth else []
    truths = {stem: read_truth(options.truth / f"{stem}.npz") for stem in stems}
    return ScoredReadings(design, idle, truths, project.store)


def _half(printer: Progress) -> Monitor:
    return lambda fraction, note="": printer("read", 0.5 * fraction, note)


def _line(reading: Reading | LearnedReading) -> str:
    """A reading in one line."""
    size_N = float(np.linalg.norm(reading.force_N))
    force = f"{size_N:.2f} +- {reading.force_sigma_N:.2f} N"
    line = (
        f"{reading.photo:20} {reading.surface_mm.max():5.2f} mm deep, "
        f"{reading.contact_area_mm2:6.1f} mm2, "
        f"{force if np.isfinite(size_N) else 'force unknown'}"
    )
    misfit = reading.figures.get("misfit")
    return line if misfit is None else f"{line}, misfit {misfit:.1f}"


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
