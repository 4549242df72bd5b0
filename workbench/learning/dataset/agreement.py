"""How far the two solvers of a data set are apart, measured on its own samples for its card."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.learning.dataset.folder import DataSet

MOST_CASES = 100
"""Cases looked at, spread evenly over those with samples."""
MOVED_MM = 0.1
"""Displacements are compared where finite elements moved a vertex farther than this."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Agreement:
    """Contact solver against finite elements, in the last frame of each case looked at."""

    force_ratio: np.ndarray
    """Normal force of the finite elements over that of the contact solver, shape (N,)."""
    rms_mm: np.ndarray
    """Difference of displacement, root mean square over moved vertices [mm], shape (N,)."""
    peak_mm: np.ndarray
    """Largest displacement by finite elements [mm], shape (N,)."""

    @property
    def text(self) -> str:
        """The measurement in words."""
        low, middle, high = np.percentile(self.force_ratio, [0.0, 50.0, 100.0])
        share = 100.0 * float(np.median(self.rms_mm / self.peak_mm))
        return (
            f"In the last frame of {len(self.force_ratio)} cases the normal force of the finite "
            f"elements is {middle:.2f} times that of the contact solver (median; {low:.2f} to "
            f"{high:.2f}). Where they move the skin by more than {MOVED_MM:g} mm, displacements "
            f"differ by {float(np.median(self.rms_mm)):.3f} mm (median of the root mean squares), "
            f"{share:.0f} % of the largest displacement."
        )


def agreement(data: DataSet) -> Agreement | None:
    """Compare the solvers; None where no sample has both, with contact.

    Raises:
        StoreError: If a sample that is looked at is damaged.
    """
    cases = [(case, frames[-1]) for case in data.cases() if (frames := data.frames(case))]
    picks = np.unique(np.linspace(0, len(cases) - 1, min(MOST_CASES, len(cases))).astype(int))
    rows = []
    for pick in picks.tolist():
        sample = data.sample(*cases[pick])
        if sample.mpm is None or sample.fem is None:
            continue
        pressed_N = sample.mpm.reaction_N @ sample.normal, sample.fem.reaction_N @ sample.normal
        size_mm = np.linalg.norm(sample.fem.displacement_mm, axis=1)
        moved = size_mm > MOVED_MM
        if pressed_N[0] <= 0.0 or not moved.any():
            continue
        apart = (sample.mpm.displacement_mm - sample.fem.displacement_mm)[moved]
        rms_mm = float(np.sqrt((apart**2).sum(axis=1).mean()))
        rows.append((pressed_N[1] / pressed_N[0], rms_mm, float(size_mm.max())))
    if not rows:
        return None
    ratio, rms_mm, peak_mm = np.array(rows).T
    return Agreement(force_ratio=ratio, rms_mm=rms_mm, peak_mm=peak_mm)
