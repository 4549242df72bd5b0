"""`workbench export`: write bodies, mould and meshes of a design."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable
from pathlib import Path

from workbench.cli.body_arguments import add_body_options, placed_design
from workbench.cli.command import Command
from workbench.cli.options import DESIGN, OUT
from workbench.cli.press_arguments import add_fit_option, add_set_option
from workbench.cli.started import started
from workbench.core.base.errors import DesignError
from workbench.core.design.design import SensorDesign
from workbench.project.project import Project
from workbench.report.export import chosen_exports, clear_exports, export_design, exports
from workbench.system.terminal import Progress, complain, say

PACK = """
write a pack: all that `wb.Sensor.load` needs, and MJCF and URDF; minutes for a new design
"""
TAXIM = """
write what Taxim, TacEx and Isaac Lab read of a flat sensor, fitted to its renders, with its error
"""


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("design", metavar="NAME|FILE", help=DESIGN)
    add_body_options(sub)
    add_set_option(sub)
    add_fit_option(sub)
    sub.add_argument("--out", type=Path, metavar="DIR", help=OUT)
    sub.add_argument("--pack", type=Path, metavar="DIR", help=PACK)
    sub.add_argument("--taxim", type=Path, metavar="DIR", help=TAXIM)
    sub.add_argument(
        "--width-px", type=int, metavar="N", help="width of a pack's images; the camera's own"
    )
    for option, text in _options().items():
        sub.add_argument(f"--{option}", action="store_true", help=text)
    sub.add_argument(
        "--json",
        action="store_true",
        help="one JSON object per line; the last has the checks and the parts",
    )


def _options() -> dict[str, str]:
    """Kinds of export that are asked for, and what each adds."""
    return {kind.option: kind.help for kind in exports().values() if kind.option}


def run(options: argparse.Namespace, project: Project) -> int:
    """Write a design's files, its pack, or both; 1 where a check says they cannot be made."""
    from workbench.edit.typed_fields import with_typed
    from workbench.planning.foresight import optical_misfits
    from workbench.project.named_designs import load_design
    from workbench.sensor.exporting import export_pack

    if options.out is None and options.pack is None and options.taxim is None:
        raise DesignError(
            "nothing says where the files go",
            hint="give --out DIR for bodies, moulds and meshes, --pack DIR for a pack, or both",
            at="--out",
        )
    printer = Progress(as_json=options.json)
    design = placed_design(options, load_design(options.design, project=project))
    design = with_typed(design, options.set)
    if options.out is not None:
        for notice in filter(
            None, (kind.notice(design) for kind in chosen_exports(_asked(options)))
        ):
            complain(f"notice: {notice}")
        clear_exports(options.out, but=Path(options.design))
    start = started(design, options, project, printer)
    for misfit in optical_misfits(start.solid, start.design.optics):
        complain(f"notice: {misfit}")
    code = 0 if options.out is None else _write_files(start.design, options, project, printer)
    if options.pack is not None:
        written = export_pack(
            start.design, options.pack, project, width_px=options.width_px, monitor=printer
        )
        _tell(written, options)
    if options.taxim is not None:
        from workbench.taxim.exporting import export_taxim

        written = export_taxim(
            start.design, options.taxim, project, width_px=options.width_px, monitor=printer
        )
        _tell(written, options)
    return code


def _asked(options: argparse.Namespace) -> list[str]:
    """Kinds of export that are asked for."""
    return [option for option in _options() if getattr(options, option)]


def _tell(paths: Iterable[Path], options: argparse.Namespace) -> None:
    for path in paths:
        say(json.dumps({"file": str(path)}) if options.json else path)


def _write_files(
    design: SensorDesign, options: argparse.Namespace, project: Project, printer: Progress
) -> int:
    """Bodies, mould and meshes; 1 where a check says they cannot be made."""
    from workbench.cli.verdict import check_line, complain_of_red
    from workbench.core.press.press_case import PressCase
    from workbench.planning.plan import plan, results
    from workbench.report.fabrication_tables import all_checks, check_rows, part_rows

    where = (options.out, project.store, printer)
    _tell(export_design(design, *where, _asked(options)), options)
    calls = plan(design, PressCase())
    made = results(project.store, calls, ("mould", "housing", "recipe", "package"))
    checks = all_checks(made["mould"], made["housing"], made["recipe"])
    if options.json:
        parts = part_rows(made["mould"], made["housing"], made["package"])
        say(json.dumps({"checks": check_rows(checks), "parts": parts}, allow_nan=False))
    else:
        for check in checks:
            say(check_line(check))
    return complain_of_red(checks)


COMMAND = Command(place=3, run=run, options=options)
