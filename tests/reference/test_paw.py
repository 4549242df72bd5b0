"""The paw: closed forms, its fields on the kernel's surface, walls, what it refuses."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from designs.family import family, resolve_shape
from designs.paw_shape import PawShape, outlines
from designs.prisms import rounded_prism_mm3
from geometry.body.solid import tessellate
from tests.families import expect_refusal
from workbench.core.design.design import Layers, SensorDesign

EDGED = {"rim_mm": 3.0, "margin_mm": 4.0, "toe_width_mm": 4.0, "toe_length_mm": 11.0}
"""A paw whose core is so narrow in its toes that its rim is sharp under the body's."""


def test_a_paw_is_its_block_its_beads_and_its_heel_pad() -> None:
    """Beads 2/3 pi a b h each; the pad A h - (1 - pi/4) r^2 (P - 2 pi c r) with r = h = 2."""
    shape = PawShape()
    outline, heel = outlines(shape)
    beads = 4 * 2 / 3 * math.pi * 3.0 * 4.2 * 3.0
    assert sum(toe.volume_mm3 for toe in shape.toes) == pytest.approx(beads, rel=1e-12)
    pad = rounded_prism_mm3(heel.arcs.area_mm2, heel.arcs.perimeter_mm, 2.0, 2.0)
    block = rounded_prism_mm3(outline.area_mm2, outline.perimeter_mm, 21.0, 2.0)
    body = family("paw").build(shape, Layers()).outer
    # Planes, cylinders, tori and rational patches: the kernel integrates them to 1e-6.
    assert body.volume == pytest.approx(block + beads + pad, rel=1e-6)
    assert body.bounding_box().max.Z == pytest.approx(24.0, abs=1e-3)


def test_paws_of_other_proportions_are_as_exact() -> None:
    """Low round pads, and five toes in wide valleys: on the fields everywhere."""
    low = {"toe_pad_mm": 1.0, "heel_pad_mm": 1.0, "toe_width_mm": 6.0, "toe_length_mm": 6.0}
    many = {"toe_count": 5.0, "toe_spread_deg": 165.0, "toe_ring_mm": 12.0, "valley_mm": 2.0}
    for values in (low, many, {}):
        shape, layers = resolve_shape("paw", values), Layers()
        fields = family("paw").fields(shape, layers)
        bodies = family("paw").build(shape, layers)
        for body, field in ((bodies.outer, fields.outer), (bodies.core, fields.core)):
            points = tessellate(body).points_mm
            points = points[points[:, 2] > 1e-3]
            assert np.abs(field(points)).max() < 1e-9


def test_the_wall_of_a_paw_is_thick_under_its_beads_and_even_elsewhere() -> None:
    """From the core's flat 3 + 2 mm to a bead's top and 2 + 2 to the pad's; 2 mm at its sides."""
    shape, layers = PawShape(), Layers()
    fields = family("paw").fields(shape, layers)
    x, y = shape.toes[0].place_mm
    for place, wall_mm in (((x, y), 5.0), ((0.0, -4.0), 4.0), ((0.0, 8.0), 2.0)):
        column = np.column_stack([np.tile(place, (6001, 1)), np.linspace(15.0, 25.0, 6001)])
        in_wall = (fields.outer(column) < 0.0) & (fields.core(column) > 0.0)
        # Steps of a 600th of a millimetre.
        assert in_wall.sum() / 600.0 == pytest.approx(wall_mm, abs=0.005)
    spots = np.column_stack(
        [outlines(shape)[0].points_mm, np.full(len(outlines(shape)[0].points_mm), 9.0)]
    )
    assert fields.core(spots) == pytest.approx(2.0, abs=1e-9)


def test_beads_are_layered_where_rays_from_the_axis_pass_them_by(
    made: Callable[[SensorDesign, str], Any],
) -> None:
    """At 0.4 mm: hexahedra of the body's volume, up to the tops of the beads."""
    hexes = made(SensorDesign(family="paw"), "mesh").hexes
    assert hexes is not None
    solid = made(SensorDesign(family="paw"), "build")
    # Chords of 0.4 mm, and one row of cells on the upright foot of each bead.
    assert hexes.volume_mm3 == pytest.approx(solid.volume_mm3, rel=0.005)
    assert hexes.quality.min() > 0.3
    for toe in PawShape().toes:
        aside = np.linalg.norm(hexes.points_mm[:, :2] - toe.place_mm, axis=1)
        assert hexes.points_mm[aside < 0.6, 2].max() == pytest.approx(24.0, abs=0.05)


@pytest.mark.parametrize(
    ("shape", "layers", "at"),
    [
        ({"toe_count": 3.5}, {}, "shape.toe_count"),
        ({"toe_pad_mm": 4.0, "toe_width_mm": 5.0}, {}, "shape.toe_pad_mm"),
        (
            {"toe_width_mm": 4.0, "toe_length_mm": 12.0, "margin_mm": 2.5},
            {},
            "shape.toe_length_mm",
        ),
        ({"heel_pad_mm": 3.0, "heel_front_mm": 3.0}, {}, "shape.heel_pad_mm"),
        ({"rim_mm": 3.0, "margin_mm": 3.0}, {}, "shape.rim_mm"),
        (EDGED, {"elastomer_mm": 0.8}, "shape.rim_mm"),
        ({"toe_width_mm": 9.0}, {}, "shape.toe_spread_deg"),
        ({"toe_count": 2.0, "toe_spread_deg": 160.0}, {}, "shape.toe_spread_deg"),
        ({"heel_front_mm": 7.0}, {}, "shape.toe_ring_mm"),
        ({"heel_apart_mm": 16.0, "heel_mm": 3.0}, {}, "shape.heel_apart_mm"),
        ({"toe_width_mm": 5.0, "toe_length_mm": 11.0, "rim_mm": 3.0}, {}, "shape.margin_mm"),
        ({}, {"elastomer_mm": 5.5, "support_mm": 4.0}, "layers.elastomer_mm"),
        (
            {"height_mm": 14.0},
            {"elastomer_mm": 6.0, "support_mm": 5.0},
            "layers.elastomer_mm",
        ),
    ],
)
def test_contradictions_are_refused_with_their_place(
    shape: dict[str, float], layers: dict[str, float], at: str
) -> None:
    """Each names value, limit and unit, and what to change."""
    expect_refusal("paw", shape, layers, at)
