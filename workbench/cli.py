"""The command line: parses, calls the pipeline, prints. No logic of its own.

Exit codes: 0 done, 2 bad input (a busy port included), 3 failed computation, full disk or device,
130 cancelled. Anything else is a bug: a traceback, and a crash file in the project folder.
"""

from __future__ import annotations

import argparse
import contextlib
import errno
import json
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, TextIO

from workbench import __version__
from workbench.core.design import LightModel
from workbench.core.errors import Cancelled, DesignError, DeviceError, StoreError, WorkbenchError
from workbench.core.imported import LengthUnit
from workbench.core.monitor import seconds_left
from workbench.core.units import human_seconds
from workbench.project import Project

NUMBERS = ("--target", "--shear-mm", "--twist-deg", "--depth-mm", "--size-mm")
"""Options whose value may begin with a minus sign."""
INDENTERS = "sphere, cylinder_end, cylinder_side, cube, cone, or the path of an STL file"


def main(arguments: Sequence[str] | None = None) -> int:
    """Entry point of the `workbench` command; returns the exit code."""
    words = list(sys.argv[1:] if arguments is None else arguments)
    options = parser().parse_args(_join_negative(words))
    project = Project(options.project)
    # Taichi greets on stdout when it is imported, which belongs to the answer (`--json`).
    os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
    as_json = getattr(options, "json", False)
    try:
        with _terminable():
            return options.handler(options, project)
    except WorkbenchError as error:
        return _print_error(error, as_json=as_json)
    except KeyboardInterrupt:
        _complain("cancelled; finished results are kept")
        return Cancelled.exit_code
    except MemoryError:
        return _print_error(
            WorkbenchError(
                "this machine ran out of memory", hint="use a coarser mesh or grid, or fewer frames"
            ),
            as_json=as_json,
        )
    except Exception as bug:
        if isinstance(bug, OSError) and bug.errno in (errno.ENOSPC, errno.EDQUOT):
            full = StoreError(f"the disk is full: {bug}", hint="free some space and run again")
            return _print_error(full, as_json=as_json)
        return _print_bug(project)


@contextlib.contextmanager
def _terminable() -> Iterator[None]:
    """Treat SIGTERM as Ctrl-C while a command runs."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _say(text: object) -> None:
    """Print a line of the answer; a reader that went away (`| head -1`) changes nothing else."""
    _write(sys.stdout, f"{text}\n")


def _complain(text: str, *, end: str = "\n") -> None:
    """Print a line for people beside the answer."""
    _write(sys.stderr, text + end)


def _write(stream: TextIO, text: str) -> None:
    try:
        stream.write(text)
        stream.flush()
    except BrokenPipeError:
        # What is still buffered would raise again when the interpreter flushes it at exit.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def _join_negative(words: list[str]) -> list[str]:
    """`--target -3,0,35` as `--target=-3,0,35`, which argparse would take for an option."""
    joined: list[str] = []
    for word in words:
        if joined and joined[-1] in NUMBERS and word[:1] == "-" and word[1:2] in "0123456789.":
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def _print_error(error: WorkbenchError, *, as_json: bool) -> int:
    if as_json:
        _say(json.dumps(error.as_dict()))
    _complain(f"error: {error.message}")
    if error.at:
        _complain(f"   at: {error.at}")
    if error.hint:
        _complain(f" hint: {error.hint}")
    return error.exit_code


def _print_bug(project: Project) -> int:
    """Show the traceback of the exception being handled, and keep it where that is possible."""
    text = traceback.format_exc()
    _complain(text, end="")
    try:
        _complain(f"this is a bug; please report it with {project.write_crash(text)}")
    except WorkbenchError as error:
        _complain(f"this is a bug; please report it with the lines above ({error.message})")
    return 1


def parser() -> argparse.ArgumentParser:
    """The whole command line."""
    top = argparse.ArgumentParser(prog="workbench", description=__doc__)
    top.add_argument("--version", action="version", version=__version__)
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument(
        "--project", metavar="DIR", help="project folder (default $WORKBENCH_PROJECT or .workbench)"
    )
    commands = top.add_subparsers(dest="command", required=True)

    def command(name: str, handler: Any, help_text: str) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=help_text, description=help_text, parents=[common])
        sub.set_defaults(handler=handler)
        return sub

    _serve_options(command("serve", _serve, "Open the workbench in a browser."))
    _run_options(command("run", _run, "Press a design and write images, forces and moulds."))
    export = command("export", _export, "Write the design's bodies, mould and meshes.")
    export.add_argument("design", metavar="NAME|FILE")
    _unit_option(export)
    export.add_argument("--out", required=True, type=Path, metavar="DIR")
    export.add_argument("--tets", action="store_true", help="also tetrahedra: about a minute")
    export.add_argument("--json", action="store_true")
    presets = command("presets", _presets, "List the shipped designs and the families.")
    presets.add_argument("--json", action="store_true")
    for name, handler in (("validate", _validate), ("bench", _bench)):
        text = "Compare with closed forms." if name == "validate" else "Measure speed."
        sub = command(name, handler, text)
        sub.add_argument("room", metavar="ROOM")
        sub.add_argument("--json", action="store_true")
    command("doctor", _doctor, "Show versions, device and folders.")
    return top


def _unit_option(sub: argparse.ArgumentParser) -> None:
    sub.add_argument(
        "--unit",
        default="auto",
        choices=[unit.value for unit in LengthUnit],
        help="unit of an STL design (default: inferred from its size)",
    )


def _serve_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("design", nargs="?", metavar="NAME|FILE", help="default: where you left")
    _unit_option(sub)
    sub.add_argument("--host", default="127.0.0.1", help="default 127.0.0.1; others need a token")
    sub.add_argument("--port", type=int, default=8080)
    sub.add_argument("--open", action="store_true", help="open the system's browser")
    sub.add_argument("--fast-scene", action="store_true", help="no shadows: software rendering")


def _run_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("design", metavar="NAME|FILE")
    _unit_option(sub)
    sub.add_argument("--indenter", default="sphere", help=INDENTERS)
    sub.add_argument("--size-mm", type=float, help="diameter, else the largest width (default 6)")
    sub.add_argument("--edge-radius-mm", type=float, help="rounding of edges (default 0.45)")
    sub.add_argument("--target", help="x,y,z near the skin [mm]; default: where the family says")
    sub.add_argument("--depth-mm", type=float, default=1.0)
    sub.add_argument("--shear-mm", default="0,0", metavar="U,V")
    sub.add_argument("--twist-deg", type=float, default=0.0)
    sub.add_argument("--frames", type=int, default=10)
    sub.add_argument("--grid-mm", type=float, help="grid cell of the contact solver (default 0.5)")
    sub.add_argument("--light-model", choices=[m.value for m in LightModel])
    sub.add_argument("--out", required=True, type=Path, metavar="DIR")
    sub.add_argument("--json", action="store_true", help="progress as one JSON object per line")


def _run(options: argparse.Namespace, project: Project) -> int:
    from workbench.aim import default_target_mm
    from workbench.outputs import prepare, write_all
    from workbench.pipeline import InlineRunner, evaluate, plan
    from workbench.project import load_design

    design = load_design(options.design, unit=options.unit)
    if options.light_model:
        design = design.replace("optics.light_model", LightModel(options.light_model))
    case = press_case(options, default_target_mm(design))
    calls = plan(design, case)
    prepare(options.out)
    project.store.sweep()
    printer = _Progress(as_json=options.json)
    runner = InlineRunner(project.store)
    outcomes = []
    if design.body is not None and options.target is None:
        # Where the top of an imported body is, is only known once it has been built.
        *_, built = evaluate(design, case, runner, wanted=("build",), monitor=printer)
        solid = project.store.load("build", built.key)
        case = press_case(options, default_target_mm(design, solid))
        calls = plan(design, case)
    for outcome in evaluate(design, case, runner, monitor=printer):
        printer.done(outcome)
        outcomes.append(outcome)
    try:
        *_, picture = evaluate(design, case, runner, wanted=("picture",), monitor=printer)
        printer.done(picture)
        outcomes.append(picture)
    except DeviceError as error:
        _complain(f"the report has no picture of the mould: {error.message}")
    summary = write_all(options.out, design, case.press, project.store, calls, outcomes)
    if not options.json:
        force = summary["contact"]
        _say(
            f"{force['normal_N']:.3f} N along the normal at {case.press.depth_mm:g} mm; "
            f"residual {force['residual']:.1e}, penetration {1e3 * force['penetration_mm']:.0f} um"
        )
        _say(f"open {options.out / 'report.html'}")
    return 0


def press_case(options: argparse.Namespace, target_mm: tuple[float, float, float]) -> Any:
    """The press that the options of `run` describe; `target_mm` where they name none.

    Raises:
        DesignError: If a value is refused or the indenter is unknown.
    """
    from workbench.core.press import ContactSettings, Press
    from workbench.indenter_choice import choose_indenter
    from workbench.pipeline import PressCase

    settings = {} if options.grid_mm is None else {"grid_mm": options.grid_mm}
    return PressCase(
        indenter=choose_indenter(
            options.indenter, size_mm=options.size_mm, edge_radius_mm=options.edge_radius_mm
        ),
        press=Press(
            target_mm=_numbers(options.target, 3, at="--target") if options.target else target_mm,
            depth_mm=options.depth_mm,
            shear_mm=_numbers(options.shear_mm, 2, at="--shear-mm"),
            twist_deg=options.twist_deg,
            frames=options.frames,
        ),
        settings=ContactSettings(**settings),
    )


def _numbers(text: str, count: int, *, at: str) -> Any:
    parts = text.split(",")
    try:
        values = tuple(float(part) for part in parts)
    except ValueError:
        values = ()
    if len(values) != count:
        raise DesignError(
            f"{at} is {text!r}, expected {count} numbers in mm separated by commas",
            hint=f"for example {at} {','.join(['0'] * count)}",
            at=at,
        )
    return values


class _Progress:
    """Prints progress of stages: JSON lines, or one line of text per finished stage."""

    def __init__(self, *, as_json: bool) -> None:
        self.as_json = as_json
        self.stage = ""
        self.started = 0.0
        self.shown = 0.0

    def __call__(self, stage: str, fraction: float, note: str) -> None:
        now = time.monotonic()
        if stage != self.stage:
            self.stage, self.started, self.shown = stage, now, 0.0
        if now - self.shown < 0.2:
            return
        self.shown = now
        elapsed = now - self.started
        eta_s = seconds_left(elapsed, fraction)
        if self.as_json:
            line = {"stage": stage, "fraction": fraction, "note": note, "eta_s": eta_s}
            _say(json.dumps(line))
        elif sys.stderr.isatty():
            left = f", {human_seconds(eta_s)} left" if eta_s is not None else ""
            _complain(f"\r\x1b[K{stage} {100 * fraction:.0f} %{left} {note}", end="")

    def done(self, outcome: Any) -> None:
        if self.as_json:
            line = {
                "stage": outcome.stage,
                "key": outcome.key,
                "cached": outcome.cached,
                "seconds": outcome.seconds,
            }
            _say(json.dumps(line))
        else:
            state = "cached" if outcome.cached else human_seconds(outcome.seconds)
            end = "\r\x1b[K" if sys.stderr.isatty() else ""
            _complain(f"{end}{outcome.stage:8} {outcome.key[:12]}  {state}")


def _export(options: argparse.Namespace, project: Project) -> int:
    from workbench.exports import export_design
    from workbench.project import load_design

    printer = _Progress(as_json=options.json)
    design = load_design(options.design, unit=options.unit)
    for path in export_design(design, options.out, project.store, printer, tets=options.tets):
        _say(json.dumps({"file": str(path)}) if options.json else path)
    return 0


def _presets(options: argparse.Namespace, project: Project) -> int:
    from designs.family import families
    from workbench.project import presets

    rows = [{"name": n, "kind": "preset", "purpose": p} for n, p in presets().items()]
    rows += [{"name": n, "kind": "family", "purpose": f.title} for n, f in families().items()]
    for row in rows:
        _say(
            json.dumps(row)
            if options.json
            else f"{row['name']:12} {row['kind']:7} {row['purpose']}"
        )
    return 0


def _validate(options: argparse.Namespace, project: Project) -> int:
    from workbench.validate import ROOMS

    return _print_rows(options, ROOMS)


def _bench(options: argparse.Namespace, project: Project) -> int:
    from workbench.bench import ROOMS

    return _print_rows(options, ROOMS)


def _print_rows(options: argparse.Namespace, rooms: dict[str, Any]) -> int:
    from workbench.core.mapping import suggest
    from workbench.rows import as_json, as_text, gathered

    if options.room not in rooms:
        raise DesignError(
            f"there is no room {options.room!r}", hint=suggest(options.room, rooms), at="room"
        )
    rows = gathered(options.room, rooms[options.room])
    _say(as_json(rows) if options.json else as_text(rows))
    return 0 if all(row.ok for row in rows) else 1


def _doctor(options: argparse.Namespace, project: Project) -> int:
    from workbench.doctor import report

    lines, healthy = report(project.folder)
    _say("\n".join(lines))
    return 0 if healthy else 3


def _serve(options: argparse.Namespace, project: Project) -> int:
    # The one arrow from the application to its front; everything else points the other way.
    from ui.app import serve

    return serve(options, project)


if __name__ == "__main__":
    sys.exit(main())
