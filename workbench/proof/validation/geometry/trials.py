"""Random sensors of a family, the same for the same seed, and what is found of each.

Parameters and layers are drawn uniformly within their sliders; sets that the family refuses with a
DesignError are counted and drawn again, because a refusal tells the designer what to change.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers

SEED = 20260705
MOST_DRAWS = 200
"""Draws for one set before a family counts as one that refuses everything."""


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
