"""Casting moulds: two to four outer parts and a core, for every membrane.

The parts are descriptions (`csg`) around the cast body, evaluated to triangles that they share with
the cast and, where the sensor has B-rep bodies, to B-rep as well. Overlaps and the cavity's volume
are measured on the finished parts, not assumed.

Leaves out: ejectors, sprue runners, vacuum ports.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from geometry.body import csg
from geometry.body.silicones import UNKNOWN_ELONGATION
from geometry.mould.cast import Cast, footprint, make_cast
from geometry.mould.channels import Channels, make_channels
from geometry.mould.demoulding import core_way, drawn_apart, hardship, opening
from geometry.mould.fabricate import Made, PartPlan, fabricate
from geometry.mould.mould_checks import motion_checks, mould_checks, release_strain
from geometry.mould.mould_fit import measure_fit
from geometry.mould.mould_layout import Layout, make_layout
from geometry.mould.mould_parts import air_holes, core_with_flange, outer_part
from geometry.mould.parting import COUNTS, Parting, ranked_partings
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.making import MouldOptions
from workbench.core.result.fabrication import MouldSet, PartGroup, PartMotion
from workbench.core.result.results import Solid

TORN_STRAIN = UNKNOWN_ELONGATION
"""A skin that must stretch by more is as good as jammed, whatever it is cast of [1]."""
MOST_TRIED = 4
"""Partings that are tried where the parts of the first cannot be taken apart."""


def make_mould(
    solid: Solid,
    options: MouldOptions,
    monitor: Monitor = silent,
) -> MouldSet:
    """Make the mould of a body that stands on its base plane with its tip up.

    Where no order of motions opens it, other partings are tried; the best of all is made, and its
    checks say what is still in the way.

    Raises:
        DesignError: If the gate does not fit.
        GeometryError: If a part is not one body, or parts overlap.
    """
    monitor(0.0, "looking for the best split")
    cast = make_cast(solid, options)
    counts = (options.outer_parts,) if options.outer_parts else COUNTS
    channels = make_channels(cast, options.vent_count)
    core_pull = core_way(cast)
    tried: list[tuple[Parting, list[Made], tuple[PartMotion, ...]]] = []
    for parting in ranked_partings(cast, counts)[:MOST_TRIED]:
        made = _made(cast, parting, channels, options, monitor)
        motions = opening([one.part for one in made], cast, parting, core_pull)
        tried.append((parting, made, motions))
        if hardship(motions) <= (False, TORN_STRAIN):
            break
    parting, made, motions = min(tried, key=lambda found: hardship(found[2]))
    monitor(0.7, "checking")
    parts = drawn_apart([one.part for one in made], motions)
    vents = air_holes(channels.pockets_mm, make_layout(cast, parting, options), 0.0)
    found = measure_fit(parts, cast, vents)
    way = np.array(next(motion.direction for motion in motions if motion.part == "core"))
    of_parts = mould_checks(parts, cast, parting, channels, options, way=way)
    checks = (*of_parts, *motion_checks(motions))
    strain = None if cast.core is None else release_strain(cast.core, solid.membrane, way)
    return MouldSet(
        parts=tuple(parts),
        split_azimuth_deg=parting.azimuth_deg,
        overlap_mm3=found.overlap_mm3,
        thinnest_wall_mm=min(c.value for c in checks if c.name == "minimum_wall"),
        cast_volume_mm3=found.cavity_mm3,
        release_strain=None if strain is None else strain.value,
        release_mm=(0.0, 0.0, 0.0) if strain is None else strain.place_mm,
        checks=checks,
        notice="; ".join(one.reason for one in made if one.reason),
        motions=motions,
    )


def _made(
    cast: Cast,
    parting: Parting,
    channels: Channels,
    options: MouldOptions,
    monitor: Monitor,
) -> list[Made]:
    """The printable parts of one parting: the outer ones, then the core."""
    nodes = _nodes(cast, make_layout(cast, parting, options), channels)
    made = []
    for number, (name, node) in enumerate(nodes.items()):
        monitor(0.1 + 0.6 * number / len(nodes), f"making {name}")
        made.append(fabricate(PartPlan(name=name, node=node, group=PartGroup.MOULD)))
    return made


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
