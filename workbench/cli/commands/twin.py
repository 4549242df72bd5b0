"""`workbench twin`: photographs of a sensor as it might really have been built, with the truth."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from workbench.cli.command import Command
from workbench.cli.options import DESIGN, OUT
from workbench.cli.press_arguments import add_set_option
from workbench.project.project import Project
from workbench.system.terminal import Progress, say

SOLVERS = ("fem", "gent", "mpm")
LIGHTS = ("photons", "mitsuba")
USUAL = {"seed": 1, "calibration": 20, "presses": 140, "slides": 100}
"""Named here too, because the plan's own would import the whole program; a test compares."""


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("design", metavar="NAME|FILE", help=DESIGN)
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help=OUT)
    text = "which twin: another seed is another sensor (default: 1)"
    sub.add_argument("--seed", type=int, default=USUAL["seed"], metavar="N", help=text)
    text = "photographs of a ball for `calibrate` (default: 20)"
    count = USUAL["calibration"]
    sub.add_argument("--calibration", type=int, default=count, metavar="N", help=text)
    text = "photographs of objects pressed in (default: 140)"
    sub.add_argument("--presses", type=int, default=USUAL["presses"], metavar="N", help=text)
    text = "sequences of objects that are dragged, half of them with slip (default: 100)"
    sub.add_argument("--slides", type=int, default=USUAL["slides"], metavar="N", help=text)
    text = "fem: finite elements; gent: the same of a gel that hardens by another law; mpm: the "
    text += "contact solver, quicker (default: fem)"
    sub.add_argument("--contact", choices=SOLVERS, default=SOLVERS[0], help=text)
    text = "photons: the tracer of the workbench; mitsuba: Mitsuba 3, with another coating and "
    text += "mirror images in the wall (default: photons)"
    sub.add_argument("--light", choices=LIGHTS, default=LIGHTS[0], help=text)
    text = "millions of photons of an image (default: 64 on a GPU, else 4; of Mitsuba 16)"
    sub.add_argument("--photons", type=int, default=0, metavar="N", help=text)
    text = "width of the images [px], their shape kept (default: the design's)"
    sub.add_argument("--width", type=int, default=0, metavar="PX", help=text)
    text = "processes that press side by side (default: 1)"
    sub.add_argument("--jobs", type=int, default=1, metavar="N", help=text)
    add_set_option(sub)
    sub.add_argument("--json", action="store_true", help="progress and figures as JSON lines")


def run(options: argparse.Namespace, project: Project) -> int:
    """Photograph a sensor as it might really have been built, by hidden parameters."""
    from workbench.edit.typed_fields import with_typed
    from workbench.project.named_designs import load_design
    from workbench.twin.make import make_twin
    from workbench.twin.twin_plan import Light, Solver, TwinPlan

    plan = TwinPlan(
        seed=options.seed,
        calibration=options.calibration,
        presses=options.presses,
        slides=options.slides,
        contact=Solver(options.contact),
        light=Light(options.light),
        photons_millions=options.photons,
        width_px=options.width,
        jobs=options.jobs,
    )
    design = with_typed(load_design(options.design, project=project), options.set)
    project.sweep()
    printer = Progress(as_json=options.json)
    made = make_twin(
        design,
        options.out,
        plan,
        project.store,
        lambda fraction, note="": printer("twin", fraction, note),
    )
    photos = {kind.value: count for kind, count in made.photos.items()}
    if options.json:
        say(json.dumps({"folder": str(made.folder), "photos": photos, "failed": made.failed}))
        return 0
    told = ", ".join(f"{count} of {kind}" for kind, count in photos.items())
    say(f"photographs: {told}; {len(made.failed)} paths failed")
    say(f"open {made.folder / 'card.json'}")
    return 0


COMMAND = Command(place=5, run=run, options=options)
