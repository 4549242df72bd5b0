"""By what the errors of an evaluation are told apart: where, how deep, how far aside (Fig. 14).

The places of the finger lie on four equal paths from tip to base; a station is a place on the path,
whatever its path. Stations of the pad are rings about its middle, of any other skin bands of
height.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from workbench.learning.dataset.cases import Case
from workbench.learning.evaluation.scoring import Scored

BAND_MM = 5.0
"""Height of a band [mm]."""


def station(case: Case) -> tuple[float, str]:
    """Order and name of the station of a case."""
    labels = case.position.labels
    if "polar_deg" in labels:
        polar_deg, below_mm = float(labels["polar_deg"]), float(labels["height_mm"])
        if below_mm:
            return polar_deg + below_mm, f"{below_mm:g} mm"
        return polar_deg, f"{polar_deg:g}°"
    if "z_mm" in labels:
        band_mm = BAND_MM * math.floor(float(labels["z_mm"]) / BAND_MM)
        return band_mm, f"z {band_mm:g}-{band_mm + BAND_MM:g}"
    away_mm = math.hypot(float(labels["x_mm"]), float(labels["y_mm"]))
    return away_mm, f"{away_mm:.1f} mm"


def station_words(case: Case) -> str:
    """What the names of stations mean, for the axis of a plot."""
    labels = case.position.labels
    if "polar_deg" in labels:
        return "place on the path: angle on the tip, then mm below it"
    if "z_mm" in labels:
        return "height above the base [mm]"
    return "distance from the middle [mm]"


def by_station(samples: Iterable[Scored]) -> list[Scored]:
    """Samples in the order of their stations."""
    return sorted(samples, key=lambda sample: station(sample.case))


def station_of(sample: Scored) -> str:
    """Name of a sample's station."""
    return station(sample.case)[1]


def depth_of(sample: Scored) -> str:
    """Depth of a sample [mm], as a name."""
    return f"{sample.depth_mm:.2g}"


def shear_of(sample: Scored) -> str:
    """Way aside of a sample [mm], as a name."""
    return f"{sample.shear_mm:.2g}"
