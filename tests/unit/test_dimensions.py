"""Dimensions drawn on bodies: they stand on the body that they measure, and measure its field."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from designs.dimensions.dimension import ELASTOMER, Dimension
from designs.family import families, resolve_shape
from workbench.core.base.records import records
from workbench.core.design.design import Layers
from workbench.core.design.imported import IMPORTED
from workbench.edit.dimensions import dimensions
from workbench.project.named_designs import load_design

LAYERS = Layers()
STEP = 0.25
"""What a field is changed by."""
ON_BODY_MM = 0.35
"""Fields give distances to first order, and corners are rounded by half a millimetre."""
FAMILIES = sorted(name for name in families() if name != IMPORTED)


def lines(name: str, **values: float) -> dict[str, Dimension]:
    """Of a family by field, with these values of its shape or its layers."""
    layers = Layers(**{k: v for k, v in values.items() if hasattr(LAYERS, k)})
    shape = {k: v for k, v in values.items() if not hasattr(LAYERS, k)}
    make: Any = records("designs.dimensions", "DIMENSIONS")[name]
    return {line.field: line for line in make(resolve_shape(name, shape), layers)}


def value(name: str, field: str) -> float:
    """The default of a field."""
    group, _, key = field.partition(".")
    return getattr(LAYERS if group == "layers" else resolve_shape(name, {}), key)


@pytest.mark.parametrize("name", FAMILIES)
def test_the_end_goes_with_its_field(name: str) -> None:
    """A field larger by d has its end d / per_mm farther along the line: under the mouse."""
    for field, line in lines(name).items():
        now = value(name, field)
        more = lines(name, **{field.partition(".")[2]: now + STEP})[field]
        gone = np.subtract(more.stop_mm, line.stop_mm) @ line.direction
        kept = np.subtract(more.start_mm, line.start_mm) @ line.direction
        # The end of a whole width goes half of it, its other end the other half.
        assert gone * line.per_mm == pytest.approx(STEP, abs=1e-9), field
        assert gone - kept == pytest.approx(STEP if line.per_mm == 2 else gone, abs=1e-9), field


@pytest.mark.parametrize("name", FAMILIES)
def test_a_line_is_as_long_as_its_field(name: str) -> None:
    """Length times the field's share of a mm is the field itself; of whole sizes it is the size."""
    for field, line in lines(name).items():
        length_mm = float(np.linalg.norm(np.subtract(line.stop_mm, line.start_mm)))
        share = 1.0 if line.per_mm == 2 else line.per_mm
        assert length_mm * share == pytest.approx(value(name, field)), field


@pytest.mark.parametrize("name", [name for name in FAMILIES if name != "paw"])
def test_feet_stand_on_the_body(name: str) -> None:
    """Distances by the family's own fields, which know nothing of the lines."""
    shape = resolve_shape(name, {})
    fields = families()[name].fields(shape, LAYERS)
    for field, line in lines(name).items():
        if field == "shape.bend_radius_mm":
            # Its end stands on the axis of the bend, in the air.
            continue
        foot, other = np.array(line.feet_mm)
        body = fields.outer, (fields.core if field == ELASTOMER and name != "pad" else fields.outer)
        for distance, place in zip(body, (foot, other), strict=True):
            assert abs(float(distance(place[None])[0])) < ON_BODY_MM, (field, place)


def test_a_design_has_the_lines_of_its_family_at_its_own_sizes() -> None:
    """The shipped finger of radius 15 mm has a radius of 15 mm; a file's body has none."""
    design = load_design("geltip")
    assert {line.field for line in dimensions(design)} == set(lines("finger"))
    thin = dataclasses.replace(design, shape={**design.shape, "outer_radius_mm": 6.0})
    assert dimensions(thin)[0].stop_mm[2] < dimensions(design)[0].stop_mm[2]
    assert dimensions(dataclasses.replace(design, family=IMPORTED, shape={})) == ()
