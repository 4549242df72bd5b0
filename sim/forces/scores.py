"""How far a field on a skin is from that of finite elements: one sample, and many.

The mean absolute error of a sample is that of the paper: the mean of |found - truth| over all
points of the skin and the three axes, points at rest included. As most points are at rest, it says
little by itself; here it always stands beside what predicting nothing scores, and over the largest
value. Of many samples it is the mean over all points of all of them, whatever their skins.

Total forces are sums over the points along the axes of the press: along U and V, in which objects
are sheared, and the normal. The paper's X, Y and Z of total forces are these. Its percentages are
of the mean size of the actual force; full scale, also given, is the largest.

The largest length at a point belongs to the mesh. What is said of peaks of forces is therefore said
of pressure and of the force through a disc (`peaks`), whose bias is that of the sizes.
Source: SimTac, *Performance in mechanical response simulation*.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sim.forces.peaks import Peaks
from workbench.core.base.check import expect
from workbench.core.base.errors import SolveError

AXES = 3


@dataclass(frozen=True, kw_only=True, slots=True)
class Score:
    """A field of one sample beside the truth."""

    points: int
    """Of the skin."""
    error: np.ndarray
    """Mean absolute error along X, Y and Z over the points, shape (3,)."""
    found_total: np.ndarray
    """Sum of the field over the points along U, V and the normal, shape (3,)."""
    true_total: np.ndarray
    """The same of the truth."""
    peak: float
    """Largest length of the truth at a point."""
    worst: float
    """Largest length of the error at a point."""
    found_peaks: Peaks | None = None
    """Of forces: largest pressure and disc force of the field."""
    true_peaks: Peaks | None = None
    """The same of the truth."""

    @property
    def mae(self) -> float:
        """Mean absolute error over points and axes."""
        return float(self.error.mean())


@dataclass(frozen=True, kw_only=True, slots=True)
class Summary:
    """Scores of many samples; lengths and forces in the unit of the field."""

    samples: int
    mae: float
    """Mean absolute error over samples, points and axes."""
    mae_xyz: tuple[float, ...]
    """The same along X, Y and Z."""
    peak: float
    """Largest length of the truth at a point of any sample."""
    over_peak: float
    """`mae` over `peak`; NaN where the truth is nowhere."""
    over_own_peak: float
    """Mean of each sample's error over its own peak; samples without one are left out."""
    worst: float
    """Largest length of an error at a point."""
    total_mae: tuple[float, ...]
    """Mean absolute error of the totals along U, V and the normal."""
    total_mean: tuple[float, ...]
    """Mean size of the true totals: the paper's percentages are of it."""
    total_largest: tuple[float, ...]
    """Largest size of the true totals: full scale."""
    peak_pressure_bias: float
    """Mean of the found over the true `peak_MPa`, less 1; NaN where no sample has one."""
    peak_disc_bias: float
    """The same of `peak_disc_N`."""


def score(
    found: np.ndarray,
    truth: np.ndarray,
    frame: np.ndarray,
    *,
    peaks: tuple[Peaks, Peaks] | None = None,
) -> Score:
    """Compare a field with the truth.

    Args:
        found: Vectors at the points of the skin, shape (V, 3).
        truth: By finite elements, shape (V, 3).
        frame: Unit U, V and normal of the press as rows, shape (3, 3).
        peaks: Of forces, those found and those of the truth.

    Raises:
        SolveError: If a value is not finite: it would spoil every mean that it enters.
    """
    expect(truth, "V 3", name="truth")
    expect(found, f"{len(truth)} 3", name="found")
    expect(frame, "3 3", name="frame")
    for name, field in (("found", found), ("true", truth)):
        if not np.isfinite(field).all():
            bad = np.count_nonzero(~np.isfinite(field))
            raise SolveError(
                f"{bad} of {field.size} numbers of the {name} field are not finite",
                hint="use other weights, or make the sample again",
                at="field",
            )
    found, truth = found.astype(np.float64), truth.astype(np.float64)
    away = found - truth
    return Score(
        points=len(truth),
        error=np.abs(away).mean(axis=0),
        found_total=frame @ found.sum(axis=0),
        true_total=frame @ truth.sum(axis=0),
        peak=_longest(truth),
        worst=_longest(away),
        found_peaks=None if peaks is None else peaks[0],
        true_peaks=None if peaks is None else peaks[1],
    )


def summary(scores: Sequence[Score]) -> Summary:
    """Take scores together, each point with the same weight; of biases each sample.

    Raises:
        ValueError: If there are none: no mean stands for nothing.
    """
    if not scores:
        raise ValueError("there are no scores to take together")
    weights = [one.points for one in scores]
    error = np.average([one.error for one in scores], axis=0, weights=weights)
    true = np.abs([one.true_total for one in scores])
    off = np.abs([one.found_total - one.true_total for one in scores])
    peak = max(one.peak for one in scores)
    own = [one.mae / one.peak for one in scores if one.peak > 0.0]
    return Summary(
        samples=len(scores),
        mae=float(error.mean()),
        mae_xyz=_numbers(error),
        peak=peak,
        over_peak=ratio(float(error.mean()), peak),
        over_own_peak=float(np.mean(own)) if own else float("nan"),
        worst=max(one.worst for one in scores),
        total_mae=_numbers(off.mean(axis=0)),
        total_mean=_numbers(true.mean(axis=0)),
        total_largest=_numbers(true.max(axis=0)),
        peak_pressure_bias=_bias(scores, lambda peaks: peaks.peak_MPa),
        peak_disc_bias=_bias(scores, lambda peaks: peaks.peak_disc_N),
    )


def _bias(scores: Sequence[Score], size: Callable[[Peaks], float]) -> float:
    """Mean over samples of a found over a true peak, less 1."""
    pairs = [(one.found_peaks, one.true_peaks) for one in scores]
    shares = [size(f) / size(t) - 1.0 for f, t in pairs if f and t and size(t) > 0.0]
    return float(np.mean(shares)) if shares else float("nan")


def ratio(value: float, over: float) -> float:
    """One number over another; NaN where that is 0, so that no limit is met by it."""
    return value / over if over else float("nan")


def press_frame(normal: np.ndarray, tangent_u: np.ndarray) -> np.ndarray:
    """Unit U, V = n x U and normal as rows, shape (3, 3)."""
    return np.stack([tangent_u, np.cross(normal, tangent_u), normal])


def _longest(field: np.ndarray) -> float:
    return float(np.linalg.norm(field, axis=1).max(initial=0.0))


def _numbers(values: np.ndarray) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
