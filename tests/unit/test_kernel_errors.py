"""A refusal of the CAD kernel costs a part its exact body, never the run."""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry.body import csg, csg_brep
from geometry.body.solid import brep_bytes
from geometry.mould.cast import make_cast
from geometry.mould.fabricate import Made, PartPlan, fabricate
from geometry.workshop import export
from geometry.workshop.export import step_body, step_file
from geometry.workshop.step import write_step
from workbench.core.base.errors import GeometryError, StoreError
from workbench.core.design.making import MouldOptions
from workbench.core.result.fabrication import PartGroup
from workbench.core.result.results import Solid

BLOCK = csg.Box(low_mm=(0.0, 0.0, 0.0), high_mm=(4.0, 3.0, 2.0))


def refusals() -> list[Exception]:
    """What the kernel and its wrapper raise; OCP's classes share no base but Exception."""
    from OCP.Standard import Standard_ConstructionError, Standard_Failure
    from OCP.StdFail import StdFail_NotDone

    kinds = (Standard_Failure, Standard_ConstructionError, StdFail_NotDone, ValueError)
    return [kind("no luck") for kind in (*kinds, RuntimeError)]


def refuse(error: Exception) -> Any:
    """A function that raises."""

    def refused(*operands: object, **options: object) -> Any:
        raise error

    return refused


def block(**options: Any) -> Made:
    """The block as a part."""
    return fabricate(PartPlan(name="block", node=BLOCK, group=PartGroup.SENSOR, **options))


@pytest.mark.parametrize("error", refusals(), ids=lambda error: type(error).__name__)
def test_errors_of_the_kernel_become_ours(error: Exception) -> None:
    """GeometryError with the part and the kernel's words; our own errors and bugs pass."""
    with pytest.raises(GeometryError, match="block: the CAD kernel failed: no luck"):
        csg_brep.translated(refuse(error), what="block")
    for other in (StoreError("disk"), KeyError("bug")):
        with pytest.raises(type(other)):
            csg_brep.translated(refuse(other))


@pytest.mark.parametrize("error", refusals(), ids=lambda error: type(error).__name__)
def test_a_refused_part_has_triangles_alone(
    error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    """4 x 3 x 2 = 24 mm3 of triangles, no B-rep, and the reason."""
    monkeypatch.setattr(csg_brep, "evaluate", refuse(error))
    made = block()
    assert made.part.brep.size == 0
    assert made.part.volume_mm3 == pytest.approx(24.0)
    assert "flat facets" in made.reason
    assert "no luck" in made.reason


@pytest.mark.parametrize("error", refusals(), ids=lambda error: type(error).__name__)
def test_a_refused_enlarging_leaves_the_triangles(
    error: Exception, monkeypatch: pytest.MonkeyPatch, finger: Solid
) -> None:
    """The cast is enlarged by 1 / 0.998 all the same; its B-rep is gone."""
    monkeypatch.setattr(csg_brep, "evaluate", refuse(error))
    cast = make_cast(finger, MouldOptions())
    assert cast.outer.brep.size == 0
    assert np.ptp(cast.outer.points_mm[:, 0]) == pytest.approx(30.0 / 0.998, rel=1e-3)


@pytest.mark.parametrize("error", refusals(), ids=lambda error: type(error).__name__)
def test_a_body_that_cannot_be_written_becomes_facets(
    error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first body is refused, its 12 facets are written: a STEP file of 24 mm3."""
    part = block().part
    monkeypatch.setattr(export, "part_from_brep", refuse(error))
    step = step_file(part)
    assert step.data.count(b"POLY_LOOP") == 12
    assert step.volume_mm3 == pytest.approx(24.0)
    assert step.data.startswith(b"ISO-10303-21")


def test_a_refused_export_is_no_full_disk(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """ValueError of the exporter: GeometryError, which facets cure; OSError: StoreError."""
    import build123d

    body = step_body(block().part)
    for error, becomes in ((ValueError("no luck"), GeometryError), (OSError("full"), StoreError)):
        monkeypatch.setattr(build123d, "export_step", refuse(error))
        with pytest.raises(becomes):
            write_step([body], "block", tmp_path / "block.step")


def test_a_given_body_of_another_size_is_not_used() -> None:
    """A B-rep of 27 mm3 for a part of 24 mm3: STL and STEP would differ, so facets are written."""
    larger = csg.Box(low_mm=(0.0, 0.0, 0.0), high_mm=(4.5, 3.0, 2.0))
    made = block(brep=brep_bytes(csg_brep.evaluate(larger, what="block")))
    assert made.part.brep.size == 0
    assert "has 27 mm3, its triangles 24 mm3" in made.reason


def test_a_crumb_without_a_volume_is_no_second_piece() -> None:
    """A cube of a micrometre beside a block: one body of 24 mm3; one of 1 mm is a piece."""
    for size_mm, refused in ((1e-3, False), (1.0, True)):
        low, high = (10.0, 0.0, 0.0), (10.0 + size_mm, size_mm, size_mm)
        node = csg.Union(parts=(BLOCK, csg.Box(low_mm=low, high_mm=high)))
        plan = PartPlan(name="block", node=node, group=PartGroup.MOULD)
        if refused:
            with pytest.raises(GeometryError, match="falls into 2 pieces"):
                fabricate(plan)
        else:
            assert fabricate(plan).part.volume_mm3 == pytest.approx(24.0)


def test_lost_pieces_are_measured_and_end_the_exact_body() -> None:
    """Blocks of 24 and 6 mm3: 20 % is lost at the middle of the smaller, with a B-rep or not."""
    crumb = csg.Box(low_mm=(10.0, 0.0, 0.0), high_mm=(11.0, 3.0, 2.0))
    node = csg.Union(parts=(BLOCK, crumb))
    given = brep_bytes(csg_brep.evaluate(BLOCK, what="block"))
    for brep in (None, given):
        plan = PartPlan(name="block", node=node, group=PartGroup.SENSOR, brep=brep)
        made = fabricate(plan, keep_largest=True)
        assert made.lost.value == pytest.approx(0.2)
        assert made.lost.place_mm == pytest.approx((10.5, 1.5, 1.0))
        assert made.part.volume_mm3 == pytest.approx(24.0)
        assert made.part.brep.size == 0
        assert "loose pieces, 20 % of it" in made.reason


def test_every_error_of_the_kernel_leads_one_rung_down() -> None:
    """A family whose B-rep is refused is built by signed distance; the kernel's words are told."""
    from designs.family import family, resolve_shape
    from workbench.core.design.design import Layers
    from workbench.core.result.results import BodyMethod
    from workbench.pipeline.building import build_solid

    real = family("finger")
    for error in refusals():
        broken = SimpleNamespace(fields=real.fields, soften=real.soften, build=refuse(error))
        solid = build_solid(broken, resolve_shape("finger", {"cylinder_mm": 10.0}), Layers())
        assert solid.method is BodyMethod.SIGNED_DISTANCE
        assert "no luck" in solid.notice
