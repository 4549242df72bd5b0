"""A map of the skin: what it shows, from what it is measured, and the figure that it comes to.

A map is one file of `sim.optics.maps.kinds` with a `MAP`. Drop-down, files, score card, comparison
and sweeps take what they say of it from there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.maps.judging import Score
from sim.optics.maps.skin_look import SkinLook
from workbench.core.base.records import records
from workbench.core.result.light import LightField
from workbench.core.result.results import MembraneMesh


@dataclass(frozen=True, kw_only=True, slots=True)
class Scene:
    """What maps are measured from."""

    mesh: MembraneMesh
    light: LightField
    look: SkinLook
    """At each vertex that of the camera which has the most pixels there."""
    young_MPa: float
    """Of the elastomer."""


@dataclass(frozen=True, kw_only=True, slots=True)
class MapKind:
    """One quantity on the skin, and its figure on the score card."""

    place: int
    """Where it stands in lists."""
    label: str
    unit: str
    meaning: str
    """One sentence for the designer."""
    measure: Callable[[Scene], np.ndarray | None]
    """At each vertex, shape (V,); NaN where it does not exist, None where the design has none."""
    more_is_better: bool
    score: Score
    """How the figure comes from the values."""
    figure: str
    """Name of the figure in tables, which ends in its unit."""
    figure_label: str
    figure_unit: str
    why: str
    """Reason for the direction, with its source; one sentence."""
    chief: bool = False
    """Whether a designer decides by it: it stands on the short score card."""
    yes_no: tuple[str, str] = ("yes", "no")
    """What 1 and 0 are called, of a map that knows nothing else."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LightMaps:
    """Maps of every single light: `MAPS` of a file. They have no place on the score card."""

    place: int
    measure: Callable[[Scene], Sequence[tuple[MapKind, str, np.ndarray]]]
    """Of each light the map, its name and its values."""


def map_kinds() -> dict[str, MapKind]:
    """All maps by name, in the order of lists."""
    found = records("sim.optics.maps.kinds", "MAP")
    return {name: found[name] for name in sorted(found, key=lambda name: found[name].place)}


def light_maps() -> list[LightMaps]:
    """The files that make a map for every light."""
    return list(records("sim.optics.maps.kinds", "MAPS").values())
