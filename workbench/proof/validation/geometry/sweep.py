"""Random sensors of every family: does each come out as one closed body of the right size?

Parameters and layers are drawn uniformly within their sliders; sets that the family refuses with a
DesignError are counted and drawn again, because a refusal tells the designer what to change. Each
set is built by `workbench.pipeline.building` in a worker process, so that a crash or a hang of the
CAD kernel is one failure and not the end. The result is then measured in ways the builder does not
use: a finer integral of the fields, the box of the fields' zero set, and every B-rep body written
as STEP and read back.
"""

from __future__ import annotations

import dataclasses
import functools
import multiprocessing
import os
import queue
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.core.base.errors import DesignError, WorkbenchError
from workbench.core.design.design import Layers
from workbench.core.result.results import BodyMethod, Solid
from workbench.proof.row import Row, bounded, failed
from workbench.proof.validation.geometry.meshes import family_names

SETS = 200
SEED = 20260705
HANG_S = 60.0
"""Time after which a build counts as hung [s]."""
MOST_DRAWS = 200
"""Draws for one set before a family counts as one that refuses everything."""
SURFACE_LIMIT = 0.003
FIELD_LIMIT = 0.03
FINE_MM = 0.6
"""Grid of the reference integral [mm]: good to about 0.5 % of a 1 mm wall."""
FINEST_MM = 0.3
"""The same where it stands in for the kernel's volume [mm]: within 0.04 % of a grid of 0.15 mm on
16 random sensors."""
SIZE_LIMIT_MM = 1.0
STEP_BODIES = ("membrane", "outer", "core", "support", "base")
"""Bodies with a B-rep, of which `outer` and `core` have no triangles of their own."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Trial:
    """One random sensor."""

    family: str
    shape: Any
    layers: Layers
    refused: int
    """Sets that were refused before this one."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Finding:
    """What came of a trial."""

    trial: Trial
    fault: str = ""
    """Empty when all is well."""
    refused: str = ""
    """What was said of a sensor that cannot be made."""
    jammed: bool = False
    """Whether a red check says that its mould cannot be opened."""
    softened: bool = False
    distance: bool = False
    """Built by signed distance."""
    surface_error: float = 0.0
    """Of the triangles' volume, relative to the kernel's, else to the finest integral."""
    field_error: float = 0.0
    """Of the triangles' volume, relative to the fields' integral."""
    size_error_mm: float = 0.0
    seconds: float = 0.0


def draw(name: str, count: int, *, seed: int = SEED) -> Iterator[Trial]:
    """Random sets of parameters that the family accepts; the same ones for the same seed.

    Raises:
        DesignError: If the family refused `MOST_DRAWS` sets in a row.
    """
    from designs.family import family, resolve_shape, sliders

    one = family(name)
    random = np.random.default_rng([seed, *name.encode()])
    spans = [(s.name, s.minimum, s.maximum, s.step) for s in sliders(name)]
    thickness = [(f.name, f.metadata["min"], f.metadata["max"]) for f in dataclasses.fields(Layers)]
    for _ in range(count):
        for refused in range(MOST_DRAWS):
            values = {key: _drawn(random, low, high, step) for key, low, high, step in spans}
            layers = Layers(**{key: float(random.uniform(*span)) for key, *span in thickness})
            try:
                shape = resolve_shape(name, values)
                one.check(shape, layers)
            except DesignError:
                continue
            yield Trial(family=name, shape=shape, layers=layers, refused=refused)
            break
        else:
            raise DesignError(
                f"the {name} refused {MOST_DRAWS} sets in a row",
                hint="narrow the ranges of its sliders",
                at="family",
            )


def _drawn(random: np.random.Generator, low: float, high: float, step: float) -> float:
    """Uniform in a slider; a slider in whole steps of 1 or more counts things."""
    if step >= 1.0 and float(low).is_integer() and float(step).is_integer():
        return float(random.integers(round(low), round(high) + 1))
    return float(random.uniform(low, high))


def judge(trial: Trial) -> Finding:
    """Build one random sensor and measure it; never raises."""
    from designs.family import family
    from workbench.pipeline.building import build_solid

    start = time.perf_counter()
    one = family(trial.family)
    try:
        solid = build_solid(one, trial.shape, trial.layers)
    except WorkbenchError as error:
        return Finding(trial=trial, fault=f"not built: {error.message}")
    except Exception as error:
        return Finding(trial=trial, fault=f"bug: {error!r}")
    seconds = time.perf_counter() - start
    return _measured(trial, solid, one.fields(trial.shape, trial.layers), seconds)


def _measured(trial: Trial, solid: Solid, fields: Any, seconds: float) -> Finding:
    from geometry.surface.surface import mesh_volume, open_edges
    from workbench.pipeline.building import body_count, coarse_volume_mm3

    points, faces = solid.membrane.points_mm, solid.membrane.faces
    volume_mm3 = mesh_volume(points, faces)
    distance = solid.method is BodyMethod.SIGNED_DISTANCE
    reference_mm3 = coarse_volume_mm3(fields, FINEST_MM if distance else FINE_MM)
    # Without a kernel's volume to compare with, the finer integral stands in for it.
    surface = abs(volume_mm3 / (reference_mm3 if distance else solid.volume_mm3) - 1.0)
    field = abs(volume_mm3 / reference_mm3 - 1.0)
    high, low = points.max(axis=0), points.min(axis=0)
    size_mm = float(
        max(np.abs(high - fields.high_mm).max(), np.abs((low - fields.low_mm)[:2]).max())
    )
    faults = {
        f"{open_edges(faces)} open edges": open_edges(faces) > 0,
        f"{body_count(faces)} pieces": body_count(faces) != 1,
        f"volume {volume_mm3:.4g} mm3": volume_mm3 <= 0.0,
        f"surface off its reference volume by {surface:.2%}": surface > SURFACE_LIMIT,
        f"volume off the fields' by {field:.2%}": field > FIELD_LIMIT,
        f"size off by {size_mm:.2g} mm": size_mm > SIZE_LIMIT_MM,
    }
    named = [text for text, bad in faults.items() if bad]
    return Finding(
        trial=trial,
        fault=", ".join([*named, *_step_faults(solid)]),
        softened=bool(solid.notice) and not distance,
        distance=distance,
        surface_error=surface,
        field_error=field,
        size_error_mm=size_mm,
        seconds=seconds,
    )


def _step_faults(solid: Solid) -> Iterator[str]:
    """What a reader finds wrong in the STEP files of the bodies that have a B-rep."""
    from geometry.body.solid import part_from_brep
    from geometry.surface.surface import mesh_volume
    from geometry.workshop.step import expect_read_back, step_bytes

    for name in STEP_BODIES:
        brep, surface = getattr(solid, f"{name}_brep"), getattr(solid, name, None)
        if not brep.size:
            continue
        body = part_from_brep(brep)
        wanted_mm3 = mesh_volume(surface.points_mm, surface.faces) if surface else body.volume
        try:
            expect_read_back(step_bytes([body], name), wanted_mm3, what=name)
        except WorkbenchError as error:
            yield error.message


def sweep(names: list[str], count: int = SETS, *, workers: int | None = None) -> list[Finding]:
    """Judge `count` random sensors of each family in worker processes.

    Args:
        workers: Processes; as many as there are cores when left out.
    """
    todo = [trial for name in names for trial in draw(name, count)]
    return Workers(judge, workers).judge(todo)


def rows(count: int = SETS, *, names: list[str] | None = None) -> list[Row]:
    """One row per family: how many of its random sensors failed; none may."""
    return [
        sweep_row(name, functools.partial(sweep, [name], count)) for name in names or family_names()
    ]


def sweep_row(name: str, run: Callable[[], list[Finding]]) -> Row:
    """The row of one family's findings."""
    try:
        found = run()
    except WorkbenchError as error:
        return failed(f"sweep_{name}", "random sets", why=error.message)
    faults = [finding.fault for finding in found if finding.fault]
    surface, field = (max(getattr(f, f"{of}_error") for f in found) for of in ("surface", "field"))
    case = (
        f"{len(found)} random sets, {sum(f.trial.refused for f in found)} more refused, "
        f"{sum(f.softened for f in found)} softened, "
        f"{sum(f.distance for f in found)} by signed distance; volume off the kernel's by at most "
        f"{surface:.2%}, off the fields' by {field:.2%}"
    )
    if faults:
        case += f"; the first failure: {faults[0]}"
    return bounded(f"sweep_{name}", case, len(faults), unit="1", limit=0)


class Workers:
    """Processes that judge trials one by one, and are replaced when they die or hang.

    Args:
        judge: What they do with a trial; a function of a module.
        count: Processes; as many as there are cores when left out.
        hang_s: Time after which one counts as hung [s].
    """

    def __init__(
        self,
        judge: Callable[[Trial], Finding],
        count: int | None = None,
        *,
        hang_s: float = HANG_S,
    ) -> None:
        self._context = multiprocessing.get_context("spawn")
        self._count = count or os.cpu_count() or 1
        self._judge, self._hang_s = judge, hang_s

    def judge(self, todo: list[Trial]) -> list[Finding]:
        """Findings in the order of the trials."""
        waiting: queue.SimpleQueue[int] = queue.SimpleQueue()
        for number in range(len(todo)):
            waiting.put(number)
        found: dict[int, Finding] = {}
        hands = [
            _Hand(self._context, self._judge, self._hang_s)
            for _ in range(min(self._count, len(todo)))
        ]
        try:
            while len(found) < len(todo):
                for hand in hands:
                    if hand.number is None and not waiting.empty():
                        hand.give(waiting.get(), todo)
                    elif hand.number is not None:
                        number, finding = hand.number, hand.answer(todo)
                        if finding is not None:
                            found[number] = finding
        finally:
            for hand in hands:
                hand.close()
        return [found[number] for number in range(len(todo))]


class _Hand:
    """One process."""

    def __init__(self, context: Any, judge: Callable[[Trial], Finding], hang_s: float) -> None:
        self._context, self._judge, self._hang_s = context, judge, hang_s
        self._start()

    def _start(self) -> None:
        self._pipe, child = self._context.Pipe()
        self._process = self._context.Process(target=_serve, args=(child, self._judge), daemon=True)
        self._process.start()
        child.close()
        self.number: int | None = None
        self._since = 0.0

    def give(self, number: int, todo: list[Trial]) -> None:
        """Hand over a trial."""
        self.number, self._since = number, time.monotonic()
        self._pipe.send(todo[number])

    def answer(self, todo: list[Trial]) -> Finding | None:
        """The finding, if there is one yet; a process that died or hangs makes a fault of it."""
        assert self.number is not None
        trial = todo[self.number]
        try:
            if self._pipe.poll(0.02):
                finding = self._pipe.recv()
                self.number = None
                return finding
        except (EOFError, OSError):
            self._process.join(1.0)
            fault = f"the process ended with {self._process.exitcode}"
        else:
            if time.monotonic() - self._since < self._hang_s:
                return None
            fault = f"no answer within {self._hang_s:g} s"
        self.close()
        self._start()
        return Finding(trial=trial, fault=fault)

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join(1.0)
        self._pipe.close()


def _serve(pipe: Any, judge: Callable[[Trial], Finding]) -> None:
    """Main loop of a worker process."""
    # Imported before the first trial is timed.
    import build123d  # noqa: F401

    while True:
        try:
            trial = pipe.recv()
        except EOFError:
            return
        pipe.send(judge(trial))
