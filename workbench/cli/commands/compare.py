"""`workbench compare`: score the images of one run against those of another."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from workbench.cli.command import Command
from workbench.project.project import Project
from workbench.system.terminal import say


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("images", type=Path, metavar="DIR", help="a run, or a folder of runs")
    text = "what it is compared with; its background is the null"
    sub.add_argument("reference", type=Path, metavar="REFERENCE", help=text)
    sub.add_argument("--out", type=Path, metavar="DIR", help="also comparison.html and .json")
    sub.add_argument("--json", action="store_true", help="the scores as JSON")


def run(options: argparse.Namespace, project: Project) -> int:
    """Score the images of one run, or set of runs, against another's."""
    from workbench.system.folder import prepare
    from workbench.system.whole_files import write_atomically
    from workbench.variants.image_sets import compare_sets, page, table

    if options.out is not None:
        prepare(options.out, clear=())
    scores = compare_sets(options.images, options.reference)
    if options.out is not None:
        title = f"{options.images} beside {options.reference}"
        write_atomically(options.out / "comparison.html", page(scores, title).encode())
        text = json.dumps(table(scores), indent=1)
        write_atomically(options.out / "comparison.json", text.encode())
    if options.json:
        say(json.dumps(table(scores)))
        return 0
    say(f"{'group':28} {'images':>6} {'SSIM':>7} {'null':>7} {'PSNR':>7} {'null':>7} {'MAE':>7}")
    for row in scores:
        name = f"{row.group} {row.value}".strip()
        say(
            f"{name:28} {row.pairs:6} {row.ssim_1:7.4f} {row.null_ssim_1:7.4f} "
            f"{row.psnr_dB:7.2f} {row.null_psnr_dB:7.2f} {row.mae_grey:7.3f}"
        )
    return 0


COMMAND = Command(place=7, run=run, options=options)
