"""The finger's bodies against the closed forms of capped cylinders."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from designs.family import family, resolve_shape
from geometry.body.solid import brep_bytes, part_from_brep
from geometry.volume import checks
from workbench.core.base.errors import GeometryError
from workbench.core.design.design import Layers
from workbench.core.result.results import Label, Solid


def test_volume_is_that_of_a_hemisphere_capped_cylinder(finger: Solid) -> None:
    """V = pi (15^2 27 + 2/3 15^3) - pi (13^2 27 + 2/3 13^3) = 7217.2855 mm3."""
    exact = checks.capped_cylinder_mm3(15.0, 27.0) - checks.capped_cylinder_mm3(13.0, 27.0)
    # OCCT integrates planes, cylinders and spheres exactly.
    assert finger.volume_mm3 == pytest.approx(exact, rel=1e-9)
    assert exact == pytest.approx(7217.2855, abs=1e-4)


@pytest.mark.parametrize("tip_ratio", [0.5, 1.6])
def test_volume_with_an_ellipsoidal_tip(
    build_finger: Callable[..., Solid], tip_ratio: float
) -> None:
    """V = pi r^2 (L + 2/3 h), outer minus core."""
    solid = build_finger(tip_ratio=tip_ratio)
    tip = 15.0 * tip_ratio
    exact = math.pi * (225.0 * (27.0 + 2 / 3 * tip) - 169.0 * (27.0 + 2 / 3 * (tip - 2.0)))
    # Ellipses are revolved exactly, and integrated to about 1e-9.
    assert solid.volume_mm3 == pytest.approx(exact, rel=1e-7)


def test_region_areas(finger: Solid) -> None:
    """Outer 2 pi R (L + R) = 3958.4, inner 3267.3, base pi (15^2 - 13^2) = 175.9 mm2."""
    exact = {
        Label.OUTER: checks.capped_cylinder_mm2(15.0, 27.0),
        Label.INNER: checks.capped_cylinder_mm2(13.0, 27.0),
        Label.BASE: math.pi * (15.0**2 - 13.0**2),
    }
    for label, area in exact.items():
        # Chords of 0.05 rad lose 0.05^2 / 24 = 1e-4 on a circle, twice that on a sphere.
        assert checks.region_area_mm2(finger.membrane, label) == pytest.approx(area, rel=1e-3)
    assert checks.surface_volume_ratio(finger) == pytest.approx(1.0, abs=2e-3)


def test_support_has_a_cavity_side(finger: Solid) -> None:
    """Inner area of the support is 2 pi 12 (27 + 12) = 2940.5 mm2, outer 2 pi 13 (27 + 13)."""
    # The support is tessellated coarsely: 0.05 mm.
    for label, radius in ((Label.INNER, 12.0), (Label.OUTER, 13.0)):
        area = checks.region_area_mm2(finger.support, label)
        assert area == pytest.approx(checks.capped_cylinder_mm2(radius, 27.0), rel=5e-3)


def test_brep_survives_as_bytes(finger: Solid) -> None:
    """pi (15^2 27 + 2/3 15^3) = 26153.76 mm3 before and after."""
    body = part_from_brep(finger.outer_brep)
    assert body.volume == pytest.approx(26153.7588, abs=1e-3)
    # The text keeps 15 digits, so a second trip changes nothing that can be measured.
    assert part_from_brep(brep_bytes(body)).volume == pytest.approx(body.volume, rel=1e-12)
    with pytest.raises(GeometryError, match="not a B-rep"):
        part_from_brep(np.frombuffer(b"nonsense", dtype=np.uint8))


def test_same_input_gives_the_same_arrays(
    build_finger: Callable[..., Solid], finger: Solid
) -> None:
    """Two builds agree to the last bit."""
    again = build_finger()
    for name in ("membrane", "support", "base"):
        assert np.array_equal(getattr(again, name).points_mm, getattr(finger, name).points_mm)
        assert np.array_equal(getattr(again, name).faces, getattr(finger, name).faces)
    assert np.array_equal(again.outer_brep, finger.outer_brep)


def test_foot_lies_below_the_base_plane() -> None:
    """z from -8 to 0, radius 15 + 3 mm, with a bore of 0.6 times the cavity's radius 12."""
    base = family("finger").build(resolve_shape("finger", {}), Layers()).base
    box = base.bounding_box()
    assert (box.min.Z, box.max.Z, box.max.X) == pytest.approx((-8.0, 0.0, 18.0), abs=1e-6)
    assert base.volume == pytest.approx(8.0 * math.pi * (18.0**2 - 7.2**2), rel=1e-9)
