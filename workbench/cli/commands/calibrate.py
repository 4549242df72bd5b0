"""`workbench calibrate`: a design's light fitted to photographs of the sensor built from it."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from workbench.cli.command import Command
from workbench.cli.options import DESIGN, OUT
from workbench.cli.press_arguments import add_set_option
from workbench.project.project import Project
from workbench.system.terminal import Progress, say

REFINE = ("all", "powers")
LIGHTS = ("auto", "known", "unknown")


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("design", metavar="NAME|FILE", help=DESIGN)
    text = "folder with idle.png, photographs of balls, and presses.csv"
    sub.add_argument("--photos", required=True, type=Path, metavar="DIR", help=text)
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help=OUT)
    text = "photographs that are predicted and not fitted to"
    sub.add_argument("--hold-out", default="", metavar="NAME,NAME", help=text)
    text = "the design's lights, candidates around the body, or those that explain (default: auto)"
    sub.add_argument("--lights", choices=LIGHTS, default="auto", help=text)
    text = "all: camera, places of known lights, lobe, coating as well; powers: these alone (all)"
    sub.add_argument("--refine", choices=REFINE, default="all", help=text)
    add_set_option(sub)
    sub.add_argument("--json", action="store_true", help="progress and figures as JSON lines")


def run(options: argparse.Namespace, project: Project) -> int:
    """Fit a design's light to photographs of balls pressed into the built sensor."""
    from workbench.calibration.calibrate import calibrate
    from workbench.calibration.outputs import FILES, REPORT, write_calibration
    from workbench.calibration.seen.photo_set import read_photo_set
    from workbench.edit.typed_fields import with_typed
    from workbench.project.named_designs import load_design
    from workbench.system.folder import prepare

    design = with_typed(load_design(options.design, project=project), options.set)
    held_out = tuple(name.strip() for name in options.hold_out.split(",") if name.strip())
    photos = read_photo_set(options.photos, held_out)
    prepare(options.out, clear=FILES)
    project.sweep()
    printer = Progress(as_json=options.json)
    found = calibrate(
        design,
        photos,
        project.store,
        lights=options.lights,
        refining=options.refine,
        monitor=lambda fraction, note="": printer("calibrate", fraction, note),
    )
    figures, scored = write_calibration(options.out, found, photos.idle)
    if options.json:
        say(json.dumps(figures, allow_nan=False))
        return 0
    for each in scored.photos:
        held = " held out" if each.held_out else ""
        say(
            f"{each.photo:20} {each.depth_mm:5.2f} mm  {each.psnr_dB:5.1f} dB  polynomial "
            f"{each.polynomial_psnr_dB:5.1f}  null {each.null_psnr_dB:5.1f}{held}"
        )
    for each in figures["left_out"]:
        say(f"left out: {each['why']}")
    _say_known(figures["fitted"])
    say(f"open {options.out / REPORT}")
    return 0


def _say_known(fitted: dict[str, Any]) -> None:
    """What the photographs determine, in a few lines."""
    young, known = fitted["young"], fitted["parameters"]
    if young is not None:
        say(f"Young's modulus {young['young_MPa']:.3f} MPa, known to {young['sd_MPa']:.3f}")
    if known:
        sure = [each["name"] for each in known if each["determined"]]
        say(f"determined: {len(sure)} of {len(known)} unknowns")
    for each in known:
        if not each["determined"]:
            say(f"{each['name']:28} {each['value']:+.3f} {each['unit']}  {each['words']}")


COMMAND = Command(place=4, run=run, options=options)
