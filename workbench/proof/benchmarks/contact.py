"""Contact: substeps, the default press of the default finger, and presses side by side."""

from __future__ import annotations

import functools
import os
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

from workbench.core.base.errors import SolveError
from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Extent, Press
from workbench.core.press.press_case import PressCase
from workbench.pipeline.stages.press import PressInputs, press
from workbench.proof.benchmarks.timing import RUNS, timed_row
from workbench.proof.row import Row, bounded
from workbench.proof.specimens import finger_mesh, finger_points
from workbench.proof.validation.contact.presses import tip_target

SUBSTEPS = (
    ("40K", 1.19, 2.5e-3, 0.06e-3),
    ("300K", 0.602, 16e-3, 0.08e-3),
    ("1.3M", 0.366, 65e-3, 0.16e-3),
)
"""Name, grid of the whole finger [mm], limit on two CPU cores and on a data-centre GPU [s]."""
BATCHES = {"cpu": (1, 2), "cuda": (1, 8, 32, 128, 512)}
FASTEST_BATCH_PER_S = 1000.0
"""Limit for the largest batch on a data-centre GPU."""
RESTING_BATCH = {"cpu": 2, "cuda": 128}
"""Presses side by side that rest each 0.1 mm, as those of data sets do."""
SETTLINGS = 3
"""Runs of presses, of which the median counts: what is compiled for the first one does not."""
WARMING = 3
"""Runs before those that count: clocks rise and caches fill."""
PLACES = 64
"""Different places on the tip that a batch presses; larger batches go round them."""


def rows() -> list[Row]:
    """All rows of the room."""
    from workbench.pipeline.devices import open_device

    device = open_device()

    def run(frames: int) -> None:
        press(
            PressInputs(
                mesh=finger_mesh(),
                points=finger_points(),
                material=Elastomer(),
                indenter=Indenter(),
                path=Press(frames=frames),
                settings=ContactSettings(),
            ),
            monitor=silent,
        )

    case = f"6 mm sphere, 1 mm deep, 0.5 mm grid, default region (8.3 mm), {device}"
    return [
        *(_substep(*line, device=device) for line in SUBSTEPS),
        timed_row("press_warm", case, lambda: run(1), 1.5),
        timed_row("ten_frames", case, lambda: run(10), 8.0),
        *(_batch(count, device=device) for count in BATCHES[device]),
        _batch(RESTING_BATCH[device], device=device, friction=Elastomer().friction),
        bounded("cold_compile", f"first press of a process with an empty compile cache, less the "
                f"same with a full one, {device}", _cold_compile_s, unit="s", limit=6.0),
    ]  # fmt: skip


def _substep(name: str, grid_mm: float, cpu_s: float, cuda_s: float, *, device: str) -> Row:
    """Seconds of one substep of the whole finger."""
    relaxation, particles = whole_finger(grid_mm)
    return bounded(
        "substep",
        f"{name}: {particles} particles, {device}",
        lambda: substep_s(relaxation),
        unit="s",
        limit=cuda_s if device == "cuda" else cpu_s,
    )


@functools.cache
def _finger(grid_mm: float):
    """The default finger made without the CAD kernel: a GPU node may not have one."""
    from sim.contact.studies.specimens import finger

    return finger(grid_mm=grid_mm)


def whole_problem(grid_mm: float):
    """The default press of the whole finger."""
    from sim.contact.readout.problem import make_problem

    settings = ContactSettings(grid_mm=grid_mm, extent=Extent.FULL)
    return make_problem(
        *_finger(grid_mm), Elastomer(), PressCase(press=Press(frames=1), settings=settings)
    )


def whole_finger(grid_mm: float):
    """A relaxation of the whole finger in contact, and its particles."""
    from sim.contact.engine.batch import Case
    from sim.contact.engine.relaxation import Relaxation

    problem = whole_problem(grid_mm)
    case = Case(domain=problem.domain, collider=problem.collider, friction=0.3)
    relaxation = Relaxation([case])
    origin, rotation = problem.approach.pose(0.2)
    relaxation.set_poses(0, np.concatenate([origin, rotation.ravel(), [1.0]])[None])
    return relaxation, problem.domain.particles


def substep_s(relaxation) -> float:
    """Median time of a substep [s]."""
    import taichi as ti

    from sim.contact.engine.launcher import STEPS

    one = np.ones(1, bool)
    times = []
    for _ in range(WARMING + RUNS):
        start = time.perf_counter()
        for _ in range(10):
            relaxation.advance(one)
        ti.sync()
        times.append((time.perf_counter() - start) / (10 * STEPS))
    return statistics.median(times[WARMING:])


@functools.cache
def _problem(number: int, friction: float):
    from sim.contact.readout.problem import make_problem

    polar, azimuth = 10.0 + 55.0 * (number % 8) / 8, 360.0 * number / PLACES
    return make_problem(
        *_finger(0.5),
        Elastomer(friction=friction),
        PressCase(
            press=Press(target_mm=tip_target(polar, azimuth), frames=1),
            settings=ContactSettings(active_radius_mm=9.0),
        ),
    )


def _batch(count: int, *, device: str, friction: float = 0.0) -> Row:
    """Presses settled in a second, reactions only; regions are prepared and sent before.

    Without friction they go in one piece, with it they rest each 0.1 mm.
    """

    def per_second() -> float:
        problems = [_problem(number % PLACES, friction) for number in range(count)]
        return settled_per_s(problems, f"one of {count} presses side by side")

    largest = device == "cuda" and count == BATCHES[device][-1]
    rubs = f"at friction {friction:g}, with a rest each 0.1 mm"
    way = rubs if friction else "without friction, in one piece"
    return bounded(
        "batch",
        f"{count} presses 1 mm deep {way} at {PLACES} places of the tip, 9 mm regions, {device}",
        per_second,
        unit="1/s",
        limit=FASTEST_BATCH_PER_S if largest else 0.0,
        sense="min",
    )


def settled_per_s(problems, what: str) -> float:
    """Presses settled in a second, side by side; `what` names them for people.

    Raises:
        SolveError: If one does not settle.
    """
    from sim.contact.solver.reactions import Reactions

    times = []
    for _ in range(SETTLINGS):
        presses = Reactions(problems)
        start = time.perf_counter()
        presses.run()
        times.append(time.perf_counter() - start)
        if not np.isfinite(presses.reaction_N).all():
            raise SolveError(
                f"{what} did not settle",
                hint="measure the room contact, which says where",
                at="press",
            )
    return len(problems) / statistics.median(times)


def _cold_compile_s() -> float:
    """Time of a first press with an empty cache of compiled kernels less that with a full one."""
    script = (
        "import time; from workbench.proof.benchmarks.contact import first_press; "
        "start = time.perf_counter(); first_press(); print(time.perf_counter() - start)"
    )
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "TI_OFFLINE_CACHE_FILE_PATH": cache}
        cold_s, warm_s = (
            float(
                subprocess.run(
                    [sys.executable, "-c", script],
                    env=environment,
                    check=True,
                    capture_output=True,
                    text=True,
                ).stdout.split()[-1]
            )
            for _ in range(2)
        )
    return cold_s - warm_s


def first_press() -> None:
    """A small press in a fresh process."""
    from sim.contact.studies.specimens import flat_block
    from workbench.pipeline.devices import open_device

    open_device()
    mesh, points = flat_block(width_mm=6.0, height_mm=2.0, grid_mm=0.5)
    press(
        PressInputs(
            mesh=mesh,
            points=points,
            material=Elastomer(),
            indenter=Indenter(size_mm=4.0),
            path=Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.3, frames=1),
            settings=ContactSettings(),
        ),
        monitor=silent,
    )
