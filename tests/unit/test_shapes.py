"""Signed distances of the indenter shapes."""

import numpy as np
import pytest

from sim.contact.objects.collider import make_collider
from workbench.core.base.errors import DesignError
from workbench.core.objects.kind import Shape, kind_of
from workbench.core.press.indenter import Indenter, IndenterKind

ANALYTIC = [kind for kind in IndenterKind if kind_of(kind).shape is not Shape.GRID]


def random_places(count: int = 400) -> np.ndarray:
    return np.random.default_rng(3).uniform(-4.5, 4.5, (count, 3))


@pytest.mark.parametrize(
    ("kind", "place", "distance"),
    [
        (IndenterKind.SPHERE, (0.0, 0.0, -5.0), 2.0),
        (IndenterKind.CYLINDER_END, (1.0, 0.0, -3.5), 0.5),
        (IndenterKind.CYLINDER_END, (0.0, 4.0, 0.0), 1.0),
        (IndenterKind.CYLINDER_SIDE, (0.0, 1.0, -4.0), 1.0),
        (IndenterKind.CYLINDER_SIDE, (0.5, 3.5, 0.0), 0.5),
        (IndenterKind.CUBE, (1.0, -2.0, -3.25), 0.25),
        # On the axis the nearest point is the rounded apex, 0.45 (sqrt 2 - 1) above the sharp one.
        (IndenterKind.CONE, (0.0, 0.0, -2.5), 1.0 + 0.45 * (2**0.5 - 1)),
        # One millimetre off the slanted face z = rho - 1.5, half way up.
        (IndenterKind.CONE, (1.5 + 0.5**0.5, 0.0, -(0.5**0.5)), 1.0),
    ],
)
def test_distance_of_a_known_place(kind: IndenterKind, place: tuple, distance: float) -> None:
    """Each case is worked out by hand for a 6 mm body with 0.45 mm edges."""
    found, _ = make_collider(Indenter(kind=kind), grid_mm=0.5).distance(np.array([place]))
    assert found[0] == pytest.approx(distance, abs=1e-12)


@pytest.mark.parametrize("kind", ANALYTIC)
def test_gradient_is_the_slope_of_the_distance(kind: IndenterKind) -> None:
    """Central differences of 1e-6 mm agree to 1e-6 away from the medial axis."""
    collider, place = make_collider(Indenter(kind=kind), grid_mm=0.5), random_places()
    distance, gradient = collider.distance(place)
    outside = distance > -0.4
    for axis in range(3):
        step = 1e-6 * np.eye(3)[axis]
        ahead, behind = collider.distance(place + step)[0], collider.distance(place - step)[0]
        slope = (ahead - behind) / 2e-6
        # An edge of the distance's own creases may lie between the two places of a difference.
        wrong = np.abs(slope - gradient[:, axis])[outside] > 1e-6
        assert wrong.mean() < 0.01
    np.testing.assert_allclose(np.linalg.norm(gradient[outside], axis=1), 1.0, atol=1e-9)


def test_cone_that_is_all_edge_radius_is_refused() -> None:
    """A 6 mm cone takes at most 6 / 2 / (1 + sqrt 2) = 1.24 mm of edge radius."""
    with pytest.raises(DesignError, match=r"limit is 1\.24 mm") as raised:
        make_collider(Indenter(kind=IndenterKind.CONE, edge_radius_mm=1.3), grid_mm=0.5)
    assert raised.value.at == "indenter.edge_radius_mm"
