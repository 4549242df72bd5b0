"""STEP files hold the body they are named after: read back, and compared with closed forms."""

from __future__ import annotations

import dataclasses
import math
import re
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry.body import csg, csg_brep
from geometry.body.solid import brep_bytes
from geometry.mould.fabricate import PartPlan, fabricate
from geometry.workshop.export import step_file
from geometry.workshop.faceted import faceted_step
from geometry.workshop.step import expect_assembly, expect_read_back, read_back, step_bytes
from geometry.workshop.step_assembly import assembly_step
from workbench.core.base.errors import GeometryError
from workbench.core.design.design import Layers
from workbench.core.result.fabrication import PartGroup
from workbench.proof.validation.geometry import sweep as sweeps
from workbench.proof.validation.geometry.sweep import judge
from workbench.proof.validation.geometry.trials import Trial

BLOCK = csg.Box(low_mm=(0.0, 0.0, 0.0), high_mm=(4.0, 3.0, 2.0))


@pytest.mark.parametrize("tip_ratio", [0.5, 0.7, 1.0, 1.3, 1.6])
@pytest.mark.parametrize(("outset_mm", "inset_mm"), [(2.0, None), (2.0, 4.0), (0.0, 2.0)])
def test_a_finger_of_any_tip_reads_back(
    tip_ratio: float, outset_mm: float, inset_mm: float | None
) -> None:
    """Volume pi r^2 (L + 2/3 h), less that of the inner body: core, support and skin."""
    from designs.finger import FingerShape, _revolved

    shape = FingerShape(tip_ratio=tip_ratio)

    def volume_mm3(inset: float) -> float:
        radius, tip = shape.outer_radius_mm - inset, shape.tip_mm - inset
        return math.pi * radius**2 * (shape.cylinder_mm + 2.0 / 3.0 * tip)

    expected_mm3 = volume_mm3(outset_mm) - (volume_mm3(inset_mm) if inset_mm else 0.0)
    body = _revolved(shape, outset_mm, inset_mm, what="body")
    found = read_back(step_bytes([body], "body"))
    assert (found.solids, found.valid) == (1, True)
    assert found.volume_mm3 == pytest.approx(expected_mm3, rel=1e-6)


@pytest.mark.parametrize("dome_mm", [4.0, 9.0, 14.0])
def test_a_loaf_of_any_dome_reads_back(dome_mm: float) -> None:
    """Half-ellipse prism and half-ellipsoid on their wall, lower and higher than half the width."""
    from designs.loaf import Loaf, loaf_body

    loaf = Loaf(
        half_mm=9.0, straight_mm=(-6.0, 6.0), ends_mm=(5.0, 9.0), wall_mm=5.0, dome_mm=dome_mm
    )
    found = read_back(step_bytes([loaf_body(loaf)], "loaf"))
    assert (found.solids, found.valid) == (1, True)
    assert found.volume_mm3 == pytest.approx(loaf.volume_mm3, rel=1e-6)


def test_a_surface_of_revolution_of_an_ellipse_is_caught() -> None:
    """Half an ellipsoid of 201.06 mm3, revolved as an ellipse: what the kernel gets wrong.

    If a later kernel gets it right, `geometry.body.outline` may draw ellipses again.
    """
    body = _spun_ellipse(4.0, 6.0)
    assert body.volume == pytest.approx(2.0 / 3.0 * math.pi * 16.0 * 6.0)
    with pytest.raises(GeometryError, match="reads back as"):
        expect_read_back(step_bytes([body], "spun"), body.volume, what="spun")


def test_a_part_that_reads_back_as_another_gets_facets() -> None:
    """Its B-rep is twice as large as its triangles: facets of 24 mm3 instead, and why."""
    made = fabricate(PartPlan(name="block", node=BLOCK, group=PartGroup.MOULD)).part
    larger = csg_brep.evaluate(
        csg.Box(low_mm=(0.0, 0.0, 0.0), high_mm=(4.0, 3.0, 4.0)), what="block"
    )
    step = step_file(dataclasses.replace(made, brep=brep_bytes(larger)))
    assert step.volume_mm3 == pytest.approx(24.0)
    assert "flat facets" in step.reason
    assert "48 mm3, 1 of 24 mm3" in step.reason
    assert read_back(step.data).volume_mm3 == pytest.approx(24.0)


def _facets(low_mm: float = 0.0) -> bytes:
    """A block of 24 mm3 as flat facets."""
    made = fabricate(PartPlan(name="block", node=BLOCK, group=PartGroup.MOULD)).part
    return faceted_step(made.points_mm + low_mm, made.faces, name="block")[0]


def test_flat_facets_are_sound_as_they_are_written() -> None:
    """A reader that mends nothing finds what one that mends finds: 24 mm3, valid."""
    assert read_back(_facets(), repaired=False) == read_back(_facets())
    assert expect_read_back(_facets(), 24.0, what="block", repaired=False) == pytest.approx(24.0)


def test_a_facet_turned_inside_out_is_caught_where_nothing_is_mended() -> None:
    """One loop of a block runs backwards: a reader that mends would not tell."""
    loop = re.compile(rb"POLY_LOOP\('',\((#\d+),(#\d+),(#\d+)\)\)")
    turned = loop.sub(rb"POLY_LOOP('',(\3,\2,\1))", _facets(), count=1)
    assert turned != _facets()
    with pytest.raises(GeometryError, match="reads back as"):
        expect_read_back(turned, 24.0, what="block", repaired=False)


def test_an_assembly_that_lost_or_changed_a_part_is_caught() -> None:
    """Two blocks of 24 mm3 are meant: one is missing, or another is larger."""
    whole = assembly_step("pair", {"here": _facets(), "there": _facets(10.0)})
    expect_assembly(whole, [24.0, 24.0], what="pair")
    for meant_mm3 in ([24.0, 24.0, 24.0], [24.0], [20.0, 28.0]):
        with pytest.raises(GeometryError, match="reads back as solids of 24, 24 mm3"):
            expect_assembly(whole, meant_mm3, what="pair")


def test_garbage_is_no_solid() -> None:
    """Text that is no STEP holds nothing, and is refused where something is expected."""
    assert read_back(b"no STEP at all").solids == 0
    with pytest.raises(GeometryError, match="0 valid solids"):
        expect_read_back(b"no STEP at all", 1.0, what="nothing")


def test_the_sweep_sees_a_body_that_does_not_survive() -> None:
    """A finger built with revolved ellipses has a fault in words; as it is built, none."""
    from designs.finger import FingerShape

    trial = Trial(family="finger", shape=FingerShape(tip_ratio=0.7), layers=Layers(), refused=0)
    assert judge(trial).fault == ""
    spun = brep_bytes(_spun_ellipse(4.0, 6.0))
    empty = np.zeros(0, dtype=np.uint8)
    breps = {f"{name}_brep": empty for name in sweeps.STEP_BODIES} | {"core_brep": spun}
    found = list(sweeps._step_faults(SimpleNamespace(**breps)))  # pyright: ignore[reportArgumentType]
    assert len(found) == 1
    assert "core as STEP reads back as" in found[0]


def _spun_ellipse(radius_mm: float, dome_mm: float) -> Any:
    from build123d import Axis, Edge, Face, Plane, Solid, Wire

    section = Plane(origin=(0, 0, 0), x_dir=(1, 0, 0), z_dir=(0, -1, 0))
    arc = Edge.make_ellipse(radius_mm, dome_mm, section, 0.0, 90.0)
    foot = Edge.make_line((0, 0, 0), (radius_mm, 0, 0))
    axis = Edge.make_line((0, 0, dome_mm), (0, 0, 0))
    return Solid.revolve(Face(Wire([foot, arc, axis])), 360.0, Axis.Z)
