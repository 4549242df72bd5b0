"""What a network learns from: states of one membrane, field in and field out."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core.base.check import expect
from workbench.core.base.errors import SolveError


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Fields:
    """Samples on the vertices of one skin."""

    inputs: np.ndarray
    """Vectors by the contact solver, shape (S, V, 3) or (S, V, 6), float32: displacement [mm], and
    contact force [N] where the network takes it."""
    targets: np.ndarray
    """What is to be predicted, or added to the contact solver's field, in its unit, shape
    (S, V, C), float32."""
    sizes: np.ndarray
    """Length of the true field at each vertex over the sample's largest, shape (S, V), float32:
    where the peaks are, whatever is corrected."""
    names: tuple[str, ...]
    """Of the samples, for messages."""

    def __post_init__(self) -> None:
        expect(self.inputs, f"{len(self.names)} V I", name="inputs")
        expect(self.targets, f"{len(self.names)} {self.inputs.shape[1]} C", name="targets")
        expect(self.sizes, f"{len(self.names)} {self.inputs.shape[1]}", name="sizes")
        for what, values in (("input", self.inputs), ("target", self.targets)):
            refuse_not_finite(values, self.names, what)

    def __len__(self) -> int:
        return len(self.names)

    @property
    def zero_mae(self) -> float:
        """Mean absolute error of the predictor that always says zero, in the target's unit."""
        return mean_size(self.targets)


def refuse_not_finite(values: np.ndarray, names: Sequence[str], what: str) -> None:
    """Raise for the first sample with a value that is not finite: a mean would hide nothing of it.

    Raises:
        SolveError: Naming the sample.
    """
    for name, own in zip(names, values, strict=True):
        bad = own.size - np.count_nonzero(np.isfinite(own))
        if bad:
            raise SolveError(
                f"the {what} of {name} has {bad} of {own.size} values that are not finite",
                hint="run workbench dataset repair on its data set, then make it again",
                at=name,
            )


def sizes_of(truth: np.ndarray) -> np.ndarray:
    """Lengths of fields (S, V, C) over the largest of each sample, shape (S, V), float32."""
    lengths = np.linalg.norm(truth, axis=2)
    largest = lengths.max(axis=1, initial=0.0, keepdims=True)
    return np.asarray(lengths / np.where(largest > 0.0, largest, 1.0), np.float32)


def mean_size(values: np.ndarray) -> float:
    """Mean absolute value, summed in float64 sample by sample; 0 for no sample."""
    if not len(values):
        return 0.0
    return float(np.mean([np.abs(own).mean(dtype=np.float64) for own in values]))


def rms_of_nonzero(*groups: np.ndarray) -> float:
    """Root mean square over the values of groups of fields that are not zero; 0 where all are.

    The scale of a field: most of it is zero, so its deviation would say how large the dent is, and
    a percentile as well. All channels share it, or a turned field would have other scales.
    """
    total, count = 0.0, 0
    for own in itertools.chain(*groups):
        there = own[own != 0.0].astype(np.float64)
        total += float(there @ there)
        count += there.size
    return float(np.sqrt(total / count)) if count else 0.0
