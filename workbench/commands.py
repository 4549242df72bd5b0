"""What each command does: calls the pipeline and prints. No logic of its own.

Each handler takes the parsed options and the project, and returns the exit code.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import time
from pathlib import Path
from typing import Any

from workbench.body_arguments import placed_design
from workbench.core.design import SensorDesign
from workbench.core.errors import DesignError, DeviceError, shown
from workbench.core.results import Solid
from workbench.core.units import human_seconds
from workbench.press_arguments import changed_design
from workbench.press_options import press_case
from workbench.project import Project
from workbench.stages import Outcome
from workbench.terminal import Progress, complain, say


@dataclasses.dataclass(frozen=True, kw_only=True)
class Start:
    """What a command starts from."""

    design: SensorDesign
    solid: Solid
    """The built body: what does not fit it is said before anything else is computed."""
    outcomes: tuple[Outcome, ...] = ()
    changed: str = ""
    """What was changed of the design, for people."""


def _start(
    design: SensorDesign, options: argparse.Namespace, project: Project, printer: Progress
) -> Start:
    """Build the body; one straight from its file gets LEDs that fit inside, others on request."""
    from workbench.fitting import fitted
    from workbench.pipeline import InlineRunner, PressCase, evaluate
    from workbench.typed_fields import sets

    runner, outcomes = InlineRunner(project.store), []
    for outcome in evaluate(design, PressCase(), runner, wanted=("build",), monitor=printer):
        printer.done(outcome)
        outcomes.append(outcome)
    solid = project.store.load("build", outcomes[-1].key)
    from_file = design.body is not None and not options.design.endswith(".toml")
    changed = ""
    if options.fit or (from_file and not sets(options.set, "optics.ring")):
        design, changed = fitted(design, solid)
    if changed:
        complain(changed)
    return Start(design=design, solid=solid, outcomes=tuple(outcomes), changed=changed)


def run(options: argparse.Namespace, project: Project) -> int:
    """Press a design and write images, forces and moulds."""
    from workbench.aim import default_target_mm
    from workbench.folder import RUN_FILES, prepare
    from workbench.foresight import expect_fit
    from workbench.named_designs import load_design
    from workbench.outputs import all_checks, write_all
    from workbench.partial import keeping_partial
    from workbench.pipeline import InlineRunner, evaluate, plan, results
    from workbench.source_files import asked_sources, with_weights, write_sources
    from workbench.touching_side import touching_notice
    from workbench.verdict import complain_of_red

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
    start = _start(design, options, project, printer)
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
        *_, picture = evaluate(design, case, runner, wanted=("picture",), monitor=printer)
        printer.done(picture)
        outcomes.append(picture)
    except DeviceError as error:
        complain(f"the report has no picture of the mould: {error.message}")
    summary = write_all(
        options.out,
        design,
        case,
        project.store,
        calls,
        outcomes,
        changed=start.changed,
        fields=options.image_fields,
    )
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


def export(options: argparse.Namespace, project: Project) -> int:
    """Write a design's bodies, mould and meshes; 1 where a check says they cannot be made."""
    from workbench.exports import clear_exports, export_design, scene_notice
    from workbench.foresight import optical_misfits
    from workbench.named_designs import load_design
    from workbench.outputs import all_checks, check_rows, part_rows
    from workbench.pipeline import PressCase, plan, results
    from workbench.typed_fields import with_typed
    from workbench.verdict import check_line, complain_of_red

    printer = Progress(as_json=options.json)
    design = placed_design(options, load_design(options.design, project=project))
    design = with_typed(design, options.set)
    notice = scene_notice(design) if options.mitsuba else ""
    if notice:
        complain(f"notice: {notice}")
    clear_exports(options.out, but=Path(options.design))
    start = _start(design, options, project, printer)
    for misfit in optical_misfits(start.solid, start.design.optics):
        complain(f"notice: {misfit}")
    extra = {"tets": options.tets, "mitsuba": options.mitsuba}
    for path in export_design(start.design, options.out, project.store, printer, **extra):
        say(json.dumps({"file": str(path)}) if options.json else path)
    calls = plan(start.design, PressCase())
    made = results(project.store, calls, ("mould", "housing", "recipe", "package"))
    checks = all_checks(made["mould"], made["housing"], made["recipe"])
    if options.json:
        parts = part_rows(made["mould"], made["housing"], made["package"])
        say(json.dumps({"checks": check_rows(checks), "parts": parts}, allow_nan=False))
    else:
        for check in checks:
            say(check_line(check))
    return complain_of_red(checks)


def presets(options: argparse.Namespace, project: Project) -> int:
    """List the shipped designs and the families."""
    from designs.family import families
    from workbench.named_designs import presets

    rows = [{"name": n, "kind": "preset", "purpose": p} for n, p in presets().items()]
    rows += [{"name": n, "kind": "family", "purpose": f.title} for n, f in families().items()]
    for row in rows:
        say(
            json.dumps(row)
            if options.json
            else f"{row['name']:12} {row['kind']:7} {row['purpose']}"
        )
    return 0


def compare(options: argparse.Namespace, project: Project) -> int:
    """Score the images of one run, or set of runs, against another's."""
    from workbench.folder import prepare
    from workbench.image_sets import compare_sets, page, table
    from workbench.whole_files import write_atomically

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


def validate(options: argparse.Namespace, project: Project) -> int:
    """Compare with closed forms."""
    from workbench.validate import ROOMS, room_of, with_data

    if options.reference:
        options.room = room_of(options.room, options.reference)
    rooms = ROOMS if options.data is None else with_data(options.room, options.data)
    return _print_rows(options, rooms)


def bench(options: argparse.Namespace, project: Project) -> int:
    """Measure speed."""
    from workbench.bench import ROOMS

    return _print_rows(options, ROOMS, record=options.record)


def _print_rows(
    options: argparse.Namespace, rooms: dict[str, Any], *, record: Path | None = None
) -> int:
    from workbench.core.mapping import suggest
    from workbench.rows import Row, as_json, as_text, gathered, listening

    started = time.monotonic()

    def heard(row: Row) -> None:
        state = "ok" if row.ok else "FAIL"
        complain(f"{state:4} {row.name} after {human_seconds(time.monotonic() - started)}")

    if options.room not in rooms:
        raise DesignError(
            f"there is no room {shown(options.room)}", hint=suggest(options.room, rooms), at="room"
        )
    with listening(heard):
        rows = gathered(options.room, rooms[options.room])
    if record is not None:
        from workbench.benchmarks.records import write_record

        write_record(record, options.room, rows)
    say(as_json(rows) if options.json else as_text(rows))
    return 0 if all(row.ok for row in rows) else 1


def doctor(options: argparse.Namespace, project: Project) -> int:
    """Show versions, device and folders."""
    from workbench.doctor import report

    lines, healthy = report(project.folder)
    say("\n".join(lines))
    return 0 if healthy else 3


def serve(options: argparse.Namespace, project: Project) -> int:
    """Open the workbench in a browser."""
    # The one arrow from the application to its front; everything else points the other way.
    from ui.app import serve

    return serve(options, project)
