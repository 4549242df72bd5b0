"""`workbench evaluate`: score learned fields on what training never saw, and write the report.

Writes `scores.json` (every number), `report.html` (self-contained) and the heat maps as PNG.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workbench.cli.command import Command
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor, part
from workbench.project.project import Project
from workbench.system.terminal import Progress, complain, say

if TYPE_CHECKING:
    from sim.forces.network.spec import Target
    from workbench.learning.evaluation.evaluate import FieldResult, Named
    from workbench.learning.evaluation.report import Evaluation
    from workbench.learning.evaluation.sources import Source

SCORES, REPORT = "scores.json", "report.html"
FILES = (SCORES, REPORT, *(f"{f}_{m}.png" for f in ("force", "displacement")
                           for m in ("press", "shear")))  # fmt: skip


def options(sub: argparse.ArgumentParser) -> None:
    """Options of the command."""
    sub.add_argument("data", type=Path, metavar="DATA", help="a data set, or a held-out set")
    text = "weights of a network; once for each field and stiffness (default: the shipped ones)"
    sub.add_argument("--weights", type=Path, action="append", metavar="FILE", help=text)
    text = "a data set, or held-out set, of another stiffness"
    sub.add_argument("--stiffness", type=Path, action="append", metavar="DATA", help=text)
    sub.add_argument("--no-speed", action="store_true", help="measure no frame rates")
    sub.add_argument("--out", type=Path, metavar="DIR", help="where report and scores go")
    text = "only write the held-out samples of DATA as one small file"
    sub.add_argument("--pack", type=Path, metavar="FILE", help=text)
    sub.add_argument("--most-mb", type=float, default=6.0, help="of that file (default 6)")
    sub.add_argument("--json", action="store_true", help="progress as one JSON object per line")


def run(options: argparse.Namespace, project: Project) -> int:
    """Score learned forces and displacements beside zero and the contact solver."""
    if (options.out is None) == (options.pack is None):
        raise DesignError(
            "it is not said what to write",
            hint="give --out DIR for a report, or --pack FILE for a held-out set",
            at="--out",
        )
    printer = Progress(as_json=options.json)
    if options.pack is not None:
        return _pack(options, printer)
    from workbench.learning.evaluation.report import report_page, scores_table
    from workbench.report.image_files import png_bytes
    from workbench.system.folder import prepare
    from workbench.system.whole_files import write_atomically

    prepare(options.out, clear=FILES)
    found = _evaluated(options, printer)
    scores = scores_table(found)
    # Written last, the scores say that the report beside them is whole.
    for sheet in found.sheets:
        if sheet.image is not None:
            write_atomically(options.out / sheet.file, png_bytes(sheet.image))
    write_atomically(options.out / REPORT, report_page(found).encode())
    write_atomically(options.out / SCORES, json.dumps(_finite(scores), indent=1).encode())
    _say(found, options)
    return 0


def _pack(options: argparse.Namespace, printer: Progress) -> int:
    """Write the held-out set of a data set."""
    from workbench.learning.evaluation.packing import made_from
    from workbench.learning.evaluation.sources import open_source
    from workbench.system.whole_files import write_atomically

    if options.most_mb <= 0.0:
        raise DesignError(
            f"{options.most_mb:g} MB hold nothing", hint="allow more than 0", at="--most-mb"
        )
    source = open_source(options.data)
    content = made_from(
        source,
        most_bytes=round(1e6 * options.most_mb),
        name=str(options.data),
        monitor=_stage(printer, "pack"),
    )
    write_atomically(options.pack, content)
    answer = {"file": str(options.pack), "bytes": len(content), "key": source.key}
    say(json.dumps(answer) if options.json else f"{options.pack}: {len(content) / 1e6:.2f} MB")
    return 0


def _evaluated(options: argparse.Namespace, printer: Progress) -> Evaluation:
    from workbench.learning.evaluation.evaluate import evaluate_all
    from workbench.learning.evaluation.report import Evaluation
    from workbench.learning.evaluation.sheets import spread
    from workbench.learning.evaluation.sources import open_source
    from workbench.learning.evaluation.speed import efficiency, measured_here
    from workbench.learning.evaluation.stiffness import evaluate_stiffness

    source, weights = open_source(options.data), given_weights(options.weights)
    mine = at_stiffness(weights, source, name=str(options.data))
    results = evaluate_all(source, mine, name=str(options.data), monitor=_stage(printer, "score"))
    stiffness = []
    for path in options.stiffness or ():
        other = open_source(path)
        stage = _stage(printer, f"stiffness {path.name}")
        stiffness += evaluate_stiffness(other, weights, source, name=str(path), monitor=stage)
    spread_out = spread(source, _stage(printer, "data"))
    drawn = _drawn(source, mine, results, _stage(printer, "draw"))
    speed: dict[str, Any] = {}
    if not options.no_speed:
        speed = efficiency(measured_here(_stage(printer, "speed")))
    return Evaluation(
        name=options.data.stem if options.data.is_file() else options.data.name,
        source=source,
        weights=weights,
        results=results,
        spread=spread_out,
        sheets=drawn,
        stiffness=stiffness,
        speed=speed,
    )


def _drawn(
    source: Source,
    weights: list[Named],
    results: dict[Target, FieldResult],
    monitor: Monitor,
) -> list[Any]:
    from workbench.learning.evaluation.sheets import sheets

    drawn = []
    for number, named in enumerate(weights):
        monitor(number / len(weights), named.name)
        drawn += sheets(source, named, results[named.weights.target])
    return drawn


def given_weights(paths: list[Path] | None) -> list[Named]:
    """The weights that were named, else those that ship.

    Raises:
        StoreError: If one cannot be read.
        DesignError: If two are of the same field and stiffness.
    """
    from sim.forces.network.spec import Target
    from sim.forces.network.weights import load_weights
    from workbench.learning.evaluation.evaluate import Named

    if not paths:
        from workbench.pipeline.shipped import shipped_weights

        paths = [shipped_weights(target) for target in (Target.FORCE, Target.DISPLACEMENT)]
    found = [Named(name=path.name, weights=load_weights(path)) for path in paths]
    seen: dict[tuple[str, Any], str] = {}
    for named in found:
        what = (named.weights.target.value, named.weights.card.get("young_MPa"))
        if what in seen:
            raise DesignError(
                f"{named.name} and {seen[what]} both predict {what[0]} at {what[1]} MPa",
                hint="give one of them",
                at="--weights",
            )
        seen[what] = named.name
    return found


def at_stiffness(weights: list[Named], source: Source, *, name: str) -> list[Named]:
    """Those weights that were trained at the stiffness of a source.

    Raises:
        DesignError: If there are none.
    """
    from workbench.learning.evaluation.sources import young_MPa
    from workbench.learning.evaluation.stiffness import same_modulus, trained_MPa

    here = young_MPa(source)
    found = [named for named in weights if same_modulus(trained_MPa(named), here)]
    if not found:
        raise DesignError(
            f"{name} was pressed at {here:g} MPa, and no weights were trained there",
            hint="give it with --stiffness, and the set of the trained stiffness as DATA",
            at="--weights",
        )
    return found


def _stage(printer: Progress, stage: str) -> Monitor:
    def monitor(fraction: float, note: str = "") -> None:
        printer(stage, fraction, note)

    return part(monitor, 0.0, 1.0)


def _say(found: Evaluation, options: argparse.Namespace) -> None:
    from workbench.learning.evaluation.report import verdicts

    if options.json:
        say(json.dumps({"folder": str(options.out), "verdicts": verdicts(found.results)}))
        return
    complain("")
    for line in verdicts(found.results):
        say(line)
    say(f"open {options.out / REPORT}")


def _finite(value: Any) -> Any:
    """The same with null for what is not finite, which JSON cannot say."""
    import math

    if isinstance(value, dict):
        return {str(name): _finite(one) for name, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


COMMAND = Command(place=10, run=run, options=options)
