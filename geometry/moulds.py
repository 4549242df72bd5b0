"""Casting moulds: two to four outer parts and a core, for every membrane.

The parts are descriptions (`csg`) around the cast body, evaluated to triangles that they share with
the cast and, where the sensor has B-rep bodies, to B-rep as well. Overlaps and the cavity's volume
are measured on the finished parts, not assumed.

Leaves out: ejectors, sprue runners, vacuum ports.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry import csg
from geometry.cast import Cast, footprint, make_cast
from geometry.channels import Channels, make_channels
from geometry.fabricate import fabricate
from geometry.mould_checks import mould_checks, release_strain
from geometry.mould_fit import measure_fit
from geometry.mould_layout import Layout, make_layout
from geometry.mould_parts import air_holes, core_with_flange, outer_part
from geometry.parting import COUNTS, Parting, best_parting
from workbench.core.fabrication import MouldSet, PartGroup
from workbench.core.making import MouldOptions
from workbench.core.monitor import Monitor, silent
from workbench.core.results import Solid

APART_MM = 15.0
"""Gap between the parts of the exploded view [mm]."""


def make_mould(
    solid: Solid,
    options: MouldOptions,
    monitor: Monitor = silent,
) -> MouldSet:
    """Make the mould of a body that stands on its base plane with its tip up.

    Raises:
        DesignError: If the gate does not fit.
        GeometryError: If a part is not one body, or parts overlap.
    """
    monitor(0.0, "looking for the best split")
    cast = make_cast(solid, options)
    parting = best_parting(cast, (options.outer_parts,) if options.outer_parts else COUNTS)
    channels = make_channels(cast, options.vent_count)
    layout = make_layout(cast, parting, options)
    nodes = _nodes(cast, layout, channels)
    parts, reasons = [], []
    for number, (name, node) in enumerate(nodes.items()):
        monitor(0.1 + 0.6 * number / len(nodes), f"making {name}")
        made = fabricate(
            name,
            node,
            group=PartGroup.MOULD,
            explode=_explode(number, layout),
            pull=_pull(number, parting),
        )
        parts.append(made.part)
        reasons += [made.reason] if made.reason else []
    monitor(0.7, "checking")
    found = measure_fit(parts, cast, air_holes(channels.pockets_mm, layout, 0.0))
    checks = mould_checks(
        parts,
        cast,
        parting,
        channels,
        options,
    )
    strain = None if cast.core is None else release_strain(cast.core, solid.membrane)
    return MouldSet(
        parts=tuple(parts),
        split_azimuth_deg=parting.azimuth_deg,
        overlap_mm3=found.overlap_mm3,
        thinnest_wall_mm=min(c.value for c in checks if c.name == "minimum_wall"),
        cast_volume_mm3=found.cavity_mm3,
        release_strain=None if strain is None else strain.value,
        release_mm=(0.0, 0.0, 0.0) if strain is None else strain.place_mm,
        checks=checks,
        notice="; ".join(reasons),
    )


def _nodes(cast: Cast, layout: Layout, channels: Channels) -> dict[str, csg.Node]:
    """Descriptions of the parts in the sensor frame."""
    parting = layout.parting
    back = -parting.azimuth_deg
    rotation = csg.turn_z(parting.azimuth_deg)
    outer = csg.turned(cast.outer, back)
    core = None if cast.core is None else csg.turned(cast.core, back)
    local = dataclasses.replace(
        channels,
        gate_mm=channels.gate_mm @ rotation[:2, :2],
        vents_mm=channels.vents_mm @ rotation[:2, :2],
        pockets_mm=channels.pockets_mm @ rotation,
    )
    beside = local.pockets_mm[_beside(cast, channels.pockets_mm)]
    nodes = {
        name: outer_part(number, layout, outer, beside) for number, name in enumerate(parting.names)
    }
    nodes["core"] = core_with_flange(layout, core, local)
    return {name: csg.turned(node, parting.azimuth_deg) for name, node in nodes.items()}


def _beside(cast: Cast, places_mm: np.ndarray) -> np.ndarray:
    """Places whose holes leave beside the cast, through the outer parts, shape (P,), bool."""
    import shapely

    inside = shapely.convex_hull(footprint(cast))
    return ~shapely.contains_xy(inside, places_mm[:, 0], places_mm[:, 1])


def _pull(number: int, parting: Parting) -> tuple[float, float, float]:
    if number == parting.count:
        return (0.0, 0.0, -1.0)
    x, y, z = parting.pulls[number]
    return float(x), float(y), float(z)


def _explode(number: int, layout: Layout) -> tuple[float, float, float]:
    x, y, z = _pull(number, layout.parting)
    if z:
        return (0.0, 0.0, -(layout.top_mm - layout.base_mm + APART_MM))
    apart = float(layout.half_mm[0]) + APART_MM
    return x * apart, y * apart, 0.0
