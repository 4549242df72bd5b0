"""The registry finds families, and parameters are read strictly."""

from __future__ import annotations

import math
from typing import Any

import pytest

from designs.family import Family, families, family, resolve_shape, sliders
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers


def test_every_family_keeps_the_protocol() -> None:
    """Each has a name, a title, defaults inside its sliders, and defaults that pass its check."""
    assert "finger" in families()
    for name, one in families().items():
        assert isinstance(one, Family)
        assert one.name == name
        for slider in sliders(name):
            assert slider.minimum <= slider.default <= slider.maximum
            assert slider.step > 0.0
            assert slider.label
            assert slider.hint
        one.check(resolve_shape(name, {}), Layers())


def test_unknown_family_lists_the_known_ones() -> None:
    """`finger` is offered in place of `fingr`."""
    with pytest.raises(DesignError, match="'fingr'") as caught:
        family("fingr")
    assert "finger" in caught.value.hint
    assert caught.value.at == "family"


def test_values_fill_in_over_defaults() -> None:
    """tip_ratio 1.2 given, radius 15 by default; whole numbers become floats."""
    shape = resolve_shape("finger", {"tip_ratio": 1.2, "cylinder_mm": 30})
    assert (shape.outer_radius_mm, shape.tip_ratio, shape.cylinder_mm) == (15.0, 1.2, 30.0)
    assert isinstance(shape.cylinder_mm, float)


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("radius", 5.0, "no parameter 'radius'"),
        ("tip_ratio", 2.0, "Tip ratio 2 is outside 0.5 to 1.6"),
        ("outer_radius_mm", 5.9, "5.9 mm is outside 6 to 30 mm"),
        ("tip_ratio", "1", "'1', which is not a finite number"),
        ("tip_ratio", True, "True, which is not a finite number"),
        ("tip_ratio", math.nan, "nan, which is not a finite number"),
        ("tip_ratio", None, "None, which is not a finite number"),
    ],
)
def test_bad_values_name_value_limit_and_place(key: str, value: Any, says: str) -> None:
    """Unknown, out of range and of the wrong type: all at shape.<name>."""
    with pytest.raises(DesignError, match=says) as caught:
        resolve_shape("finger", {key: value})
    assert caught.value.at == f"shape.{key}"
    assert caught.value.hint


@pytest.mark.parametrize(
    ("shape", "layers", "says"),
    [
        ({"outer_radius_mm": 6.0}, {"elastomer_mm": 6.0}, "6 mm is not thinner than the outer"),
        ({"outer_radius_mm": 6.0}, {"elastomer_mm": 4.0}, "together 5 mm leave less than 1 mm"),
        ({"outer_radius_mm": 8.0, "tip_ratio": 0.5}, {}, "inside the tip height 4 mm"),
    ],
)
def test_walls_must_leave_a_cavity(
    shape: dict[str, float], layers: dict[str, float], says: str
) -> None:
    """wall >= radius, or support + wall >= radius - 1 mm, is refused at the wall."""
    with pytest.raises(DesignError, match=says) as caught:
        family("finger").check(resolve_shape("finger", shape), Layers(**layers))
    assert caught.value.at == "layers.elastomer_mm"
    assert "mm" in str(caught.value)
    assert caught.value.hint
