"""Building never returns a wrong body, and says what it had to change."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from designs.family import Family, families, family, resolve_shape
from designs.finger import capped_cylinder_mm3
from geometry.body.implicit import solid_from_fields, step_for
from geometry.surface.surface import is_watertight, mesh_volume
from workbench.core.base.errors import DesignError, GeometryError, MeshingError
from workbench.core.design.design import Layers
from workbench.core.result.results import BodyMethod, Label, Solid
from workbench.pipeline.building import body_count, build_solid, check_solid, coarse_volume_mm3

PARAMETRIC = sorted(set(families()) - {"imported"})


@dataclass(frozen=True, kw_only=True)
class Broken:
    """A family whose kernel fails for rims wider than a limit."""

    real: Family
    widest_mm: float
    error: Exception

    def fields(self, shape: Any, layers: Layers) -> Any:
        return self.real.fields(shape, layers)

    def soften(self, shape: Any) -> Any:
        return self.real.soften(shape)

    def build(self, shape: Any, layers: Layers) -> Any:
        if shape.rim_mm > self.widest_mm:
            raise self.error
        return self.real.build(shape, layers)


def trunk_shape() -> Any:
    return resolve_shape("trunk", {"valley_mm": 16.0, "rim_mm": 2.0})


@pytest.mark.parametrize("error", [GeometryError("no rim"), ValueError("fillet"), RuntimeError("")])
def test_a_failed_fillet_is_made_smaller_and_said(error: Exception) -> None:
    """Rim 2 mm fails, 1.5 mm is built by the kernel, and the notice names both."""
    broken = Broken(real=family("trunk"), widest_mm=1.5, error=error)
    solid = build_solid(broken, trunk_shape(), Layers())
    assert solid.method is BodyMethod.BREP
    assert solid.notice == "Rim radius 2 mm could not be built; 1.5 mm was"


def test_a_failed_kernel_is_replaced_by_signed_distance_and_said() -> None:
    """No rim works: triangles only, marks kept, and the volume as the kernel would have it."""
    broken = Broken(real=family("trunk"), widest_mm=0.0, error=RuntimeError("BRep_API"))
    solid = build_solid(broken, trunk_shape(), Layers())
    assert solid.method is BodyMethod.SIGNED_DISTANCE
    assert "signed distance at 0.4 mm" in solid.notice
    assert "BRep_API" in solid.notice
    assert solid.membrane_brep.size == solid.outer_brep.size == 0
    assert solid.base_brep.size > 0
    assert set(np.unique(solid.membrane.numbers)) == {-1, 0, 1, 2, 3}
    exact = build_solid(family("trunk"), trunk_shape(), Layers())
    assert exact.method is BodyMethod.BREP
    assert exact.notice == ""
    # Edges are rounded by the grid of 0.4 mm.
    assert solid.volume_mm3 == pytest.approx(exact.volume_mm3, rel=0.01)


def test_a_wall_that_vanishes_in_a_body_by_distance_is_refused() -> None:
    """A core that comes within 0.8 mm of the skin, 2 mm by design: value and limit are told."""
    real = family("finger")
    shape = resolve_shape("finger", {"cylinder_mm": 10.0})

    class Lopsided(Broken):
        def build(self, shape: Any, layers: Layers) -> Any:
            raise self.error

        def fields(self, shape: Any, layers: Layers) -> Any:
            fields = self.real.fields(shape, layers)
            shift = np.array([1.2, 0.0, 0.0])
            return dataclasses.replace(fields, core=lambda points: fields.core(points - shift))

    broken = Lopsided(real=real, widest_mm=0.0, error=GeometryError("no"))
    with pytest.raises(MeshingError, match=r"wall is 0\.\d+ mm at its thinnest, less than 1 mm"):
        build_solid(broken, shape, Layers())


def test_a_refusal_is_not_a_failure() -> None:
    """A wall thicker than the finger stays a DesignError; nothing else is tried."""
    with pytest.raises(DesignError):
        build_solid(
            family("finger"),
            resolve_shape("finger", {"outer_radius_mm": 6.0}),
            Layers(elastomer_mm=6.0),
        )


def test_a_silently_wrong_body_falls_to_the_next_rung() -> None:
    """A kernel that returns the finger of wall 1.5 mm for 2 mm is found out by the fields."""
    real = family("finger")

    class Wrong(Broken):
        def build(self, shape: Any, layers: Layers) -> Any:
            return self.real.build(shape, dataclasses.replace(layers, elastomer_mm=1.5))

    wrong = Wrong(real=real, widest_mm=0.0, error=GeometryError(""))
    solid = build_solid(wrong, resolve_shape("finger", {"cylinder_mm": 10.0}), Layers())
    assert solid.method is BodyMethod.SIGNED_DISTANCE
    assert "fields' volume" in solid.notice


def test_check_finds_open_parted_and_inverted_bodies(finger: Solid) -> None:
    """One face less, two bodies, inside out: each is named."""
    membrane, expected = finger.membrane, finger.volume_mm3
    check_solid(finger, expected)

    def changed(points: np.ndarray, faces: np.ndarray) -> Solid:
        labels = np.resize(membrane.labels, len(faces))
        surface = dataclasses.replace(
            membrane, points_mm=points, faces=faces, labels=labels, numbers=np.full(len(faces), -1)
        )
        return dataclasses.replace(finger, membrane=surface)

    points, faces = membrane.points_mm, membrane.faces
    twice = np.concatenate([points, points + 100.0]), np.concatenate([faces, faces + len(points)])
    for bad, says in (
        (changed(points, faces[1:]), "open edges"),
        (changed(*twice), "2 pieces"),
        (changed(points, faces[:, ::-1]), "volume is -"),
        (changed(1.01 * points, faces), "kernel's volume"),
    ):
        with pytest.raises(MeshingError, match=says):
            check_solid(bad, expected)
    with pytest.raises(MeshingError, match="fields' volume"):
        check_solid(finger, 1.04 * expected)
    assert body_count(twice[1]) == 2


def test_fields_of_the_finger_hold_the_closed_form() -> None:
    """V = pi r^2 (L + 2/3 h), outer less core = 7217.29 mm3, by surface and by coarse integral."""
    shape = resolve_shape("finger", {})
    exact = capped_cylinder_mm3(shape, 0.0) - capped_cylinder_mm3(shape, 2.0)
    fields = family("finger").fields(shape, Layers())
    solid = solid_from_fields(fields, wall_mm=2.0, support_mm=1.0)
    # Chords of 0.4 mm cut 0.4^2 / (8 R) = 1.5e-3 mm off the outside and as much off the inside.
    assert solid.volume_mm3 == pytest.approx(exact, rel=1e-3)
    # A grid of 1 mm: errors of the two sides nearly cancel.
    assert coarse_volume_mm3(fields) == pytest.approx(exact, rel=5e-3)


def test_signed_distance_has_a_flat_sharp_base() -> None:
    """Base pi (15^2 - 13^2) = 175.9 mm2 exactly on z = 0; its corners at radius 13 and 15."""
    fields = family("finger").fields(resolve_shape("finger", {}), Layers())
    membrane = solid_from_fields(fields, wall_mm=2.0, support_mm=1.0).membrane
    assert is_watertight(membrane.faces)
    assert membrane.points_mm[:, 2].min() == 0.0
    base = membrane.faces[membrane.has(Label.BASE)]
    ring = membrane.points_mm[np.unique(base)]
    assert np.all(ring[:, 2] == 0.0)
    radius = np.linalg.norm(ring[:, :2], axis=1)
    # Each vertex lies on a chord of 0.4 mm: 1.5e-3 mm inside the circle at most.
    assert np.minimum(np.abs(radius - 13.0), np.abs(radius - 15.0)).max() < 3e-3
    corners = membrane.points_mm[base]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert 0.5 * np.linalg.norm(cross, axis=1).sum() == pytest.approx(175.93, rel=1e-3)


def test_thin_walls_get_a_finer_grid() -> None:
    """2 mm: 0.4 mm; 0.8 mm: 0.32 mm; never below 0.2 mm."""
    assert [step_for(wall) for wall in (2.0, 0.8, 0.1)] == pytest.approx([0.4, 0.32, 0.2])


@pytest.mark.slow
@pytest.mark.parametrize("name", PARAMETRIC)
def test_fields_and_kernel_agree(name: str) -> None:
    """Volume by signed distance is the kernel's to 2 %, for the elastomer and for the support."""
    one, shape, layers = family(name), resolve_shape(name, {}), Layers()
    bodies = one.build(shape, layers)
    solid = solid_from_fields(one.fields(shape, layers), wall_mm=2.0, support_mm=1.0)
    # Edges are rounded by 0.4 mm: 0.5 % of the pad, which has the most edge for its volume.
    assert solid.volume_mm3 == pytest.approx(bodies.membrane.volume, rel=0.01)
    support = mesh_volume(solid.support.points_mm, solid.support.faces)
    assert support == pytest.approx(bodies.support.volume, rel=0.02)
