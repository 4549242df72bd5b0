"""Whether the record is what Mitsuba shows: its scenes rendered again, with other random numbers.

Differences of the squares are compared with the standard errors of both: their root mean squares
have the ratio 1 where nothing but chance differs. Few samples do, because the record's own error is
the smaller part.
"""

from __future__ import annotations

import functools
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from workbench.core.base.errors import DeviceError, WorkbenchError
from workbench.proof.row import Row, bounded, failed
from workbench.proof.validation.optics.mitsuba_record import (
    Recorded,
    figures,
    recorded,
    write_folder,
)
from workbench.proof.validation.optics.recorded_scenes import SCENES

SAMPLES, BATCHES, SEED = 32, 8, 1001
MOST_STRAIN = 1.5
"""Light that a path finds by chance has long tails: ratios of 0.93 to 1.10 were seen."""
REMEDY = "install LLVM 16 or newer, or name its library in DRJIT_LIBLLVM_PATH"


def rows() -> list[Row]:
    """One of each scene."""
    return [_row(number) for number in range(len(SCENES))]


def _row(number: int) -> Row:
    name = SCENES[number].name
    try:
        record = recorded(number)
        found = again(number)
    except WorkbenchError as error:
        return failed("mitsuba_record_again", name, unit="1", why=error.message)
    even = np.broadcast_to(record.mean.mean(axis=(0, 1)), record.mean.shape)
    measured = functools.partial(strain, error=found["error"], record=record)
    return bounded(
        "mitsuba_record_again",
        f"{name}: rendered again, {SAMPLES * BATCHES} samples of each pixel: differences over the "
        "standard errors; null: even",
        measured(found["mean"]),
        unit="1",
        limit=MOST_STRAIN,
        null=measured(even),
    )


def again(number: int) -> dict[str, np.ndarray]:
    """Figures of a scene that Mitsuba renders now, in a process of its own.

    Raises:
        DeviceError: With the last line that Mitsuba said.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_folder(SCENES[number], folder)
        words = [str(folder), str(SAMPLES), str(BATCHES), str(SEED)]
        module = "workbench.proof.validation.optics.mitsuba_tracer"
        done = subprocess.run(
            [sys.executable, "-m", module, *words], capture_output=True, text=True, check=False
        )
        if done.returncode != 0:
            said = (done.stderr.strip() or "nothing").splitlines()[-1]
            raise DeviceError(f"Mitsuba stopped with {done.returncode}: {said}", hint=REMEDY)
        return figures(folder)


def strain(image: np.ndarray, *, error: np.ndarray, record: Recorded) -> float:
    """Root mean square of differences over that of the standard errors of both, (6, 8, 3) each."""
    expected = np.mean(error.astype(np.float64) ** 2 + record.error**2)
    return float(np.sqrt(np.mean((image - record.mean) ** 2) / expected))
