"""The checks of a mould: each a number, its limit, where it is worst, and what to do about it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from geometry.body.csg import Body
from geometry.mould.cast import Cast
from geometry.mould.castability import Worst, draft_deg, undercut
from geometry.mould.channels import Channels
from geometry.mould.core_release import bend_strain, core_strain, pin_strain
from geometry.mould.parting import Parting
from geometry.mould.print_checks import Bound, PrintLimits, bed_check, check, wall_check
from geometry.mould.trapped import POCKET_VENT_MM
from geometry.mould.walls import thinnest_wall
from geometry.surface.spread import Spread, spread
from workbench.core.design.making import MouldOptions
from workbench.core.result.fabrication import FabricationCheck, FabricationPart, PartMotion
from workbench.core.result.results import LabelledSurface

UNDERCUT_SHARE = 0.02
"""Silicone peels off undercuts that small without a thought."""
LOCKED_SHARE = 0.35
"""A part that holds more than a third of its surface tears the skin or does not come off."""
LEAST_DRAFT_DEG = -0.5
"""Silicone needs no draft, only no lean against the pull; half a degree is facets."""
WALL_MM = 2.0
"""Printed walls thinner than this bend under the bolts."""
STRAIN_SAFETY = 3.0
"""Share of the elongation at break that demoulding may take, as 1 / 3: data sheets give the
elongation of flawless strips (ASTM D412), and cast skins tear at nicks and seams first."""


def mould_checks(
    parts: Sequence[FabricationPart],
    cast: Cast,
    parting: Parting,
    channels: Channels,
    options: MouldOptions,
    *,
    way: np.ndarray,
) -> tuple[FabricationCheck, ...]:
    """Checks of a mould's parts and channels that hold for every silicone.

    Args:
        way: Unit direction in which the core leaves, shape (3,).
    """
    checks = [*_release(cast, parting), *_core(cast, way)]
    for part in parts:
        wall = thinnest_wall(part.points_mm, part.faces)
        checks.append(wall_check(part.name, wall, MOULD_LIMITS, options.feature_mm))
        checks.append(bed_check(part, options.bed_mm, MOULD_LIMITS))
    return (*checks, _trapped(channels), _feature(channels, options))


MOULD_LIMITS = PrintLimits(
    WALL_MM,
    thin="raise mould.wall_mm or the shape's own sizes there, or print in tough resin",
    large="lower mould.wall_mm, raise mould.outer_parts or use a larger printer",
)


def _release(cast: Cast, parting: Parting) -> Iterator[FabricationCheck]:
    """Undercut and draft of each outer part."""
    places = spread(cast.sensing.points_mm, cast.sensing.faces)
    owner = parting.part_of(places.points_mm)
    for number, name in enumerate(parting.names):
        mine = owner == number
        part = Spread(places.points_mm[mine], places.normals[mine], places.area_mm2)
        held = undercut(cast.outer.points_mm, cast.outer.faces, parting.pulls[number], part)
        yield check(
            "undercut",
            name,
            held,
            Bound(limit=UNDERCUT_SHARE, unit="of its surface", bad=LOCKED_SHARE),
            message="the skin must be peeled over it: use a silicone that stretches, "
            "raise mould.outer_parts or round the shape",
        )
        yield check(
            "draft",
            name,
            draft_deg(part, parting.pulls[number]),
            Bound(limit=LEAST_DRAFT_DEG, unit="degree", sense="min"),
            message="the surface leans against the pull there",
        )


def motion_checks(motions: Sequence[PartMotion]) -> Iterator[FabricationCheck]:
    """Whether rigid parts are in each other's way when the mould is opened."""
    for motion in motions:
        yield check(
            "demoulding",
            motion.part,
            Worst(motion.overlap_mm3, motion.overlap_at_mm),
            Bound(limit=motion.tolerance_mm3, unit="mm3", bad=motion.tolerance_mm3),
            title="overlap with other parts on its way out",
            message="no order of pulling the parts apart is free: choose another "
            "mould.outer_parts, or bend or undercut the shape less",
        )


def _core(cast: Cast, way: np.ndarray) -> Iterator[FabricationCheck]:
    """How the core leaves the cast."""
    if cast.core is None:
        return
    places = spread(cast.core.points_mm, cast.core.faces)
    above_base = places.points_mm[:, 2] > cast.base_mm + 1e-3
    part = Spread(places.points_mm[above_base], places.normals[above_base], places.area_mm2)
    # The core leaves downward inside the silicone: its facets must look up, away from the pull.
    draft = draft_deg(part, -way)
    yield check(
        "draft",
        "core",
        draft,
        Bound(limit=LEAST_DRAFT_DEG, unit="degree", sense="min"),
        message="the core is wider above than below: raise mould.draft_deg or stretch the skin",
    )


def release_strain(core: Body, membrane: LabelledSurface, way: np.ndarray) -> Worst:
    """Strain of the silicone when the core leaves: of its sections, its bend or the pins.

    Args:
        way: Unit direction in which the core leaves, shape (3,).
    """
    strains = core_strain(core), bend_strain(core, membrane, way), pin_strain(membrane)
    return max(strains, key=lambda worst: worst.value)


def part_removal(part: str, strain: Worst, elongation: float) -> FabricationCheck:
    """Whether a silicone bears to make way for an outer part that is pulled off it.

    Args:
        elongation: Its strain at break [1].
    """
    return check(
        "part_removal",
        part,
        strain,
        Bound(limit=elongation / STRAIN_SAFETY, unit="strain", bad=elongation),
        title="stretch of the skin that it is pulled over",
        message="choose a silicone with more elongation, raise mould.outer_parts or round the "
        "shape",
    )


def core_removal(strain: Worst, elongation: float) -> FabricationCheck:
    """Whether a silicone bears to be pulled off its core.

    Args:
        elongation: Its strain at break [1].
    """
    return check(
        "core_removal",
        "core",
        strain,
        Bound(limit=elongation / STRAIN_SAFETY, unit="strain", bad=elongation),
        message="choose a silicone with more elongation, bend the shape less, or raise "
        "mould.draft_deg",
    )


def _trapped(channels: Channels) -> FabricationCheck:
    places = channels.trapped_mm
    spot = places[0] if len(places) else np.zeros(3)
    vented = len(channels.pockets_mm)
    return check(
        "trapped_air",
        "cast",
        Worst(float(len(places)), (float(spot[0]), float(spot[1]), float(spot[2]))),
        Bound(limit=0.0, unit="pockets"),
        message=f"the highest holds {channels.trapped_height_mm:.1f} mm of air; {vented} others "
        "are vented; tilt the mould while pouring and degas it under vacuum",
    )


def _feature(channels: Channels, options: MouldOptions) -> FabricationCheck:
    gate, vent = channels.gate_mm, channels.vents_mm[0]
    features = [
        Worst(2 * channels.throat_mm, (float(gate[0]), float(gate[1]), 0.0)),
        Worst(2 * channels.vent_mm, (float(vent[0]), float(vent[1]), 0.0)),
    ]
    if len(channels.pockets_mm):
        spot = channels.pockets_mm[0]
        place = (float(spot[0]), float(spot[1]), float(spot[2]))
        features.append(Worst(2 * POCKET_VENT_MM, place))
    return check(
        "smallest_feature",
        "core",
        min(features, key=lambda feature: feature.value),
        Bound(limit=options.feature_mm, unit="mm", sense="min"),
        message="the printer closes holes this small: drill them, or lower mould.feature_mm",
    )
