"""The limit of three grids."""

import pytest

from sim.contact.studies.refinement import extrapolate

SIZES_MM = (0.9, 0.45, 0.3)


@pytest.mark.parametrize("order", [1.0, 2.0, 3.3])
def test_a_power_is_found_again(order: float) -> None:
    """F = 7 - 2 h^p has the limit 7 and the order p."""
    values = tuple(7.0 - 2.0 * size**order for size in SIZES_MM)
    limit = extrapolate(SIZES_MM, values)
    assert limit.value == pytest.approx(7.0, rel=1e-9)
    assert limit.order == pytest.approx(order, rel=1e-9)


def test_values_that_turn_have_no_order() -> None:
    """1, 2, 1.5 follow no power: the finest value, order 0."""
    limit = extrapolate(SIZES_MM, (1.0, 2.0, 1.5))
    assert limit.value == 1.5
    assert limit.order == 0.0
