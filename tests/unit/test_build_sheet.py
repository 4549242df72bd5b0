"""The build sheet says what it is for, in numbers that a person would write."""

from __future__ import annotations

import csv
import io

from geometry.mould.castability import Worst
from geometry.mould.print_checks import Bound, check
from geometry.workshop.build_sheet import bom_csv, build_sheet_html
from workbench.core.result.fabrication import (
    FabricationCheck,
    HousingSet,
    MouldSet,
    Recipe,
    Severity,
    SheetHead,
    SupplyItem,
)

RECIPE = Recipe(
    silicone="Solaris",
    source="its sheet",
    density_g_cm3=1.0,
    cast_ml=2.0,
    pour_ml=2.4,
    part_a_g=1.2,
    part_b_g=1.2,
    coating_mm2=800.0,
    leds=(),
    prints=(),
    steps=("Print it.",),
    supplies=(SupplyItem(kind="bolt", name="M3 nut", amount=2, unit="piece", details="steel"),),
    size_mm=(24.0, 20.0, 31.04),
)
HEAD = SheetHead(name="my <pad>", family="pad", shrink_percent=0.2, draft_deg=1.5)


def sheet(*checks: FabricationCheck) -> str:
    """The sheet of a mould with these checks."""
    mould = MouldSet(
        parts=(),
        split_azimuth_deg=0.0,
        overlap_mm3=0.0,
        thinnest_wall_mm=2.0,
        cast_volume_mm3=2000.0,
        checks=checks,
    )
    return build_sheet_html(mould, HousingSet(parts=()), RECIPE, (), head=HEAD)


def draft(value_deg: float) -> FabricationCheck:
    """The check of a mould part's draft, at a place with a rounded zero."""
    place = Worst(value_deg, (-1e-9, 1.0, 2.0))
    return check(
        "draft", "half_a", place, Bound(limit=-0.5, unit="degree", sense="min"), message="turn"
    )


def test_the_head_names_design_silicone_and_sizes() -> None:
    """Name, family, silicone, shrinkage, draft and size; markup in a name is text."""
    page = sheet()
    assert "<h1>Build sheet of my &lt;pad&gt;</h1>" in page
    head = page[: page.index("<h2>")]
    for words in ("pad", "Solaris", "0.2 %", "1.5 degree", "24.0 x 20.0 x 31.0 mm"):
        assert f"<td>{words}" in head


def test_rounding_of_the_computer_is_zero() -> None:
    """-7e-15 degree reads 0 and is good; places read 0.0, not -0.0."""
    found = draft(-7.02e-15)
    assert found.message == "half_a: draft 0 degree, at least -0.5 degree is good."
    page = sheet(found)
    assert "<td>good</td>" in page
    assert "0.0, 1.0, 2.0" in page
    assert "-0.0" not in page


def test_a_negative_draft_is_within_tolerance_or_told() -> None:
    """-0.3 of -0.5 degree is allowed and says so; -0.7 is a warning with its remedy."""
    allowed, told = draft(-0.3), draft(-0.7)
    assert allowed.severity is Severity.GOOD
    assert allowed.message == "half_a: draft -0.3 degree is within tolerance, -0.5 degree."
    assert "<td>within tolerance</td>" in sheet(allowed)
    assert told.severity is Severity.WARNING
    assert "turn" in told.message
    assert "within tolerance" not in sheet(told)


def test_supplies_are_on_the_sheet_and_in_the_list() -> None:
    """A row of kind, name, amount, unit, details."""
    assert "<td>M3 nut</td><td>2 piece</td><td>steel</td>" in sheet()
    rows = list(csv.reader(io.StringIO(bom_csv(RECIPE))))
    assert ["bolt", "M3 nut", "2", "piece", "steel"] in rows
