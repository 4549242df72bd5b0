"""`workbench run`: press a design and write images, forces and moulds."""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path

from workbench.cli.body_arguments import add_body_options, placed_design
from workbench.cli.command import Command
from workbench.cli.options import DESIGN, OUT
from workbench.cli.press_arguments import add_fit_option, add_press_options, changed_design
from workbench.cli.press_options import press_case
from workbench.cli.started import started
from workbench.core.base.errors import DeviceError
from workbench.project.project import Project
from workbench.system.terminal import Progress, complain, say


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("design", metavar="NAME|FILE", help=DESIGN)
    add_body_options(sub)
    add_press_options(sub)
    add_fit_option(sub)
    text = "exit 1 where a check of mould, housing or recipe is red"
    sub.add_argument("--strict", action="store_true", help=text)
    text = "write depth, normals and masks of every pixel: frames.npz, some 4 MB an image"
    sub.add_argument("--image-fields", action="store_true", help=text)
    text = "forces side by side in sources.csv, sources.npz: mpm, learned (seconds), fem (minutes)"
    sub.add_argument("--sources", default="", metavar="S,S", help=text)
    text = "force network of --sources learned (default: what ships)"
    sub.add_argument("--weights", type=Path, metavar="FILE", help=text)
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help=OUT)
    sub.add_argument("--json", action="store_true", help="progress as one JSON object per line")


def run(options: argparse.Namespace, project: Project) -> int:
    """Press a design and write images, forces and moulds."""
    from workbench.cli.verdict import complain_of_red
    from workbench.pipeline.touching_side import touching_notice
    from workbench.planning.foresight import expect_fit
    from workbench.planning.plan import InlineRunner, evaluate, plan, results
    from workbench.project.aim import default_target_mm
    from workbench.project.named_designs import load_design
    from workbench.report.fabrication_tables import all_checks
    from workbench.report.outputs import FinishedRun, write_all
    from workbench.report.partial import keeping_partial
    from workbench.report.source_files import asked_sources, with_weights, write_sources
    from workbench.system.folder import RUN_FILES, prepare

    design = placed_design(options, load_design(options.design, project=project))
    design = changed_design(options, design)
    # What is wrong with the design or the options is said before anything is written or built.
    sources = asked_sources(options.sources)
    first = press_case(options, design, default_target_mm(design))
    first = with_weights(first, options.weights, sources)
    plan(design, first)
    touching = touching_notice(first.indenter)
    for notice in (design.material.notice, first.press.notice, touching):
        if notice:
            complain(f"notice: {notice}")
    prepare(options.out, clear=RUN_FILES)
    project.sweep()
    printer = Progress(as_json=options.json)
    start = started(design, options, project, printer)
    design = start.design
    case = press_case(options, design, default_target_mm(design, start.solid))
    case = dataclasses.replace(case, learned=first.learned)
    if case.indenter.mesh is not None and case.indenter.mesh.notice:
        complain(case.indenter.mesh.notice)
    expect_fit(start.solid, design.optics, case)
    calls = plan(design, case)
    runner, outcomes = InlineRunner(project.store), list(start.outcomes)
    known = {outcome.key for outcome in outcomes}
    settled = (options.out, design, case, project.store, outcomes)
    with keeping_partial(*settled, monitor=printer):
        for outcome in evaluate(design, case, runner, monitor=printer):
            if outcome.key not in known:
                printer.done(outcome)
                outcomes.append(outcome)
    try:
        *_, drawing = evaluate(design, case, runner, wanted=("picture",), monitor=printer)
        printer.done(drawing)
        outcomes.append(drawing)
    except DeviceError as error:
        complain(f"the report has no drawing of the mould: {error.message}")
    finished = FinishedRun(
        design=design, case=case, calls=calls, outcomes=outcomes, changed=start.changed
    )
    summary = write_all(options.out, finished, project.store, fields=options.image_fields)
    if "target" in summary["notices"]:
        complain(f"notice: {summary['notices']['target']}")
    if not options.json:
        force = summary["contact"]
        depth_mm = force["frames"][-1]["depth_mm"]
        say(
            f"{force['normal_N']:.3f} N along the normal at {depth_mm:.3g} mm; "
            f"residual {force['residual']:.1e}, penetration {1e3 * force['penetration_mm']:.0f} um"
        )
        say(f"open {options.out / 'report.html'}")
    if sources:
        write_sources(options.out, sources, design, case, project.store, printer)
    made = results(project.store, calls, ("mould", "housing", "recipe"))
    code = complain_of_red(all_checks(made["mould"], made["housing"], made["recipe"]))
    return code if options.strict else 0


COMMAND = Command(place=2, run=run, options=options)
