"""Rigid parts: nothing is lost unsaid, no wall is a knife edge, and remedies name the housing."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest

from geometry.body import csg
from geometry.body.csg_mesh import arrays, closed, evaluate, overlaps_mm3
from geometry.housing.holder_seat import FARTHEST_MM, seat_gap
from geometry.housing.housing import make_housing
from geometry.housing.led_holder import Shells, opened, shadow, shaped_holder
from geometry.mould.walls import thinnest_wall
from geometry.surface.surface import mesh_volume
from geometry.workshop.recipe import WantedMaterial, make_recipe
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedRing
from workbench.core.design.making import Casting, Housing, Printer
from workbench.core.result.fabrication import FabricationCheck, HousingSet, MouldSet, Severity
from workbench.core.result.results import Solid

RING = csg.without(csg.cylinder(10.0, -1.0, 1.0), [csg.cylinder(5.0, -2.0, 2.0)])
NOWHERE = csg.moved(csg.cylinder(1.0, 0.0, 1.0), (0.0, 0.0, -50.0))


def housed(solid: Solid, options: Housing) -> HousingSet:
    """Rigid parts with the default ring and camera."""
    return make_housing(solid, options, ring=LedRing(), camera=Camera(), printer=Printer())


def named(made: HousingSet, name: str) -> dict[str, FabricationCheck]:
    """Checks of a name by part."""
    return {check.part: check for check in made.checks if check.name == name}


def test_a_base_cut_in_two_is_bad(finger: Solid) -> None:
    """A module of 26 mm leaves a base of 353 mm3 of some 5900: more than nine tenths are lost."""
    made = housed(finger, Housing(camera_width_mm=26.0, camera_height_mm=26.0))
    check = named(made, "loose_pieces")["housing_base"]
    assert check.severity is Severity.BAD
    assert check.value > 0.5
    assert "smaller camera" in check.message
    assert "base had loose pieces" in made.notice
    assert not named(housed(finger, Housing()), "loose_pieces")


def test_remedies_name_the_housing(finger: Solid) -> None:
    """A base of walls below 0.8 mm is told to raise housing.wall_mm, not the mould's."""
    made = housed(finger, Housing(wall_mm=0.5))
    thin = [c for c in named(made, "minimum_wall").values() if c.severity is not Severity.GOOD]
    assert thin
    assert all("housing.wall_mm" in check.message for check in thin)
    assert not any("mould." in check.message for check in made.checks)


def test_a_pocket_that_nearly_breaks_through_is_opened() -> None:
    """0.2 mm is left between pocket and outside of a ring: it goes, and 0.8 mm are left all
    around; a skin of 0.1 mm over the camera goes too."""
    pocket = csg.Box(low_mm=(7.5, -1.0, 0.0), high_mm=(9.75, 1.0, 3.0))
    camera = csg.Box(low_mm=(-20.0, -20.0, -5.0), high_mm=(0.0, 20.0, 0.9))
    plain = csg.without(RING, [pocket, camera])
    assert thinnest_wall(*arrays(evaluate(plain)), edges=True).value < 0.3
    shaped = shaped_holder(
        RING, Shells(bodies=(), gap_mm=0.15), camera, [pocket], wall_mm=0.8, tilt_deg=0.0
    )
    assert shaped is not None
    solid = evaluate(shaped)
    points, faces = arrays(solid)
    assert thinnest_wall(points, faces, edges=True).value >= 0.8 - 1e-6
    assert solid.num_tri() and len(solid.decompose()) == 1
    # Half a ring, less a pocket of 2.25 to 2.5 mm by 2 mm by 1 mm, less what the disc rounds off.
    half_mm3 = np.pi * (10.0**2 - 5.0**2)
    assert half_mm3 - 8.0 < mesh_volume(points, faces) < half_mm3 - 4.5
    assert points[:, 0].min() > -1e-6
    # Within the plain one: rounding the outline never adds.
    assert (solid - evaluate(plain)).volume() < 0.05


def test_opening_keeps_what_is_wide_and_drops_what_is_narrow() -> None:
    """A bar of 0.7 mm vanishes, a square of 4 mm loses (4 - pi) r^2 at its corners."""
    bar = csg.Box(low_mm=(5.0, 0.0, 0.0), high_mm=(9.0, 0.7, 1.0))
    square = csg.Box(low_mm=(0.0, 0.0, 0.0), high_mm=(4.0, 4.0, 1.0))
    area = shadow(csg.Union(parts=(square, bar)), 0.0, 1.0)
    # The disc has the spare of 0.02 mm; its chords of 5 micrometres cost 0.006 mm2.
    left_mm2 = 16.0 - (4.0 - np.pi) * 0.41**2
    assert opened(area, 0.8).area == pytest.approx(left_mm2, abs=0.01)


def test_slivers_beside_the_shell_are_cut_away() -> None:
    """A shell that cuts a ring to a crescent of 0 to 5 mm leaves no wall below 0.8 mm."""
    shell = csg.moved(csg.cylinder(10.0, -3.0, 3.0), (6.0, 0.0, 0.0))
    led = csg.moved(csg.cylinder(0.5, 0.0, 3.0), (-7.5, 0.0, 0.0))
    assert thinnest_wall(*arrays(evaluate(csg.without(RING, [shell]))), edges=True).value < 0.1
    shaped = shaped_holder(
        RING, Shells(bodies=(shell,), gap_mm=0.15), NOWHERE, [led], wall_mm=0.8, tilt_deg=0.0
    )
    assert shaped is not None
    assert thinnest_wall(*arrays(evaluate(shaped)), edges=True).value >= 0.8 - 1e-6
    assert evaluate(shaped).min_gap(evaluate(shell), 5.0) >= 0.15 - 0.005  # chords


@pytest.mark.parametrize(
    ("silicone", "strain", "severity"),
    [
        ("Ecoflex 00-10", 2.0, Severity.GOOD),
        ("Solaris", 2.0, Severity.WARNING),
        ("Sylgard 184", 2.0, Severity.BAD),
    ],
)
def test_the_silicone_decides_whether_the_core_leaves(
    finger: Solid, silicone: str, strain: float, severity: Severity
) -> None:
    """Strain 2 against a third of 8, 2.9 and 1.2: good, a warning, bad; no core, no check."""
    mould = MouldSet(
        parts=(),
        split_azimuth_deg=0.0,
        overlap_mm3=0.0,
        thinnest_wall_mm=2.0,
        cast_volume_mm3=1000.0,
        release_strain=strain,
    )

    def checks(mould: MouldSet) -> tuple[FabricationCheck, ...]:
        return make_recipe(
            finger,
            mould,
            HousingSet(parts=()),
            ring=LedRing(),
            casting=Casting(silicone=silicone),
            wanted=WantedMaterial(young_MPa=0.145, density_g_cm3=1.0, backing_MPa=0.0),
        ).checks

    (check,) = checks(mould)
    assert (check.name, check.value, check.severity) == ("core_removal", strain, severity)
    assert checks(dataclasses.replace(mould, release_strain=None)) == ()


def test_a_holder_held_together_by_a_skin_is_in_pieces(finger: Solid) -> None:
    """A module of 15 mm leaves four arcs joined by skins below 0.03 mm: bad, 3 of 4 are lost."""
    options = Housing(camera_width_mm=15.0, camera_height_mm=15.0, led_width_mm=2.0, wall_mm=0.6)
    check = named(housed(finger, options), "loose_pieces")["led_ring_holder"]
    assert check.severity is Severity.BAD
    assert check.value == pytest.approx(0.75, abs=0.05)


@pytest.fixture(scope="module")
def pad(default_solid: Callable[[str], Solid]) -> Solid:
    """The default pad, with a support of 1 mm."""
    return default_solid("pad")


def ringed(solid: Solid, height_mm: float, radius_mm: float) -> HousingSet:
    """Rigid parts with a ring of tilted LEDs."""
    ring = LedRing(count=12, radius_mm=radius_mm, height_mm=height_mm, tilt_deg=-60.0)
    camera = Camera(position_mm=(0.0, 0.0, 0.3))
    return make_housing(solid, Housing(), ring=ring, camera=camera, printer=Printer())


@pytest.mark.parametrize(
    ("height_mm", "radius_mm", "outside_mm"),
    # Of the cavity's 18 mm less the clearance; far from the wall, of the holder: 4.0 + 2.8 mm.
    [(13.0, 7.2, 8.85), (5.0, 7.2, 8.85), (13.0, 4.0, 6.8)],
)
def test_a_holder_above_the_base_stands_on_a_sleeve(
    pad: Solid, height_mm: float, radius_mm: float, outside_mm: float
) -> None:
    """The sleeve ends 0.15 mm below the holder, follows the wall, and overlaps nothing."""
    made = ringed(pad, height_mm, radius_mm)
    check = named(made, "led_holder_seat")["led_ring_holder"]
    assert check.value == pytest.approx(0.15, abs=1e-3)
    assert check.severity is Severity.GOOD
    parts = {part.name: closed(part.name, part.points_mm, part.faces) for part in made.parts}
    parts["skin"] = closed("skin", pad.membrane.points_mm, pad.membrane.faces)
    assert max(overlaps_mm3(parts).values()) < 1e-6
    sleeve = parts["housing_base"].trim_by_plane((0.0, 0.0, 1.0), 0.01)
    box = sleeve.bounding_box()
    # LEDs tilted by 60 degrees need 0.8 + sin 60 0.95 + cos 60 0.8 mm, and 0.02 to spare.
    assert box[5] == pytest.approx(height_mm - 2.043 - 0.15, abs=1e-3)
    # The opening's outline has chords of 5 micrometres.
    assert box[3] == pytest.approx(outside_mm, abs=0.02)
    assert sleeve.min_gap(parts["support"], 5.0) >= 0.15 - 0.005
    points, faces = arrays(sleeve)
    assert thinnest_wall(points, faces, edges=True).value >= 0.8 - 1e-6
    # The camera sees no more of it than of the holder: nothing nearer to the axis than its hole.
    hole_mm = np.linalg.norm(arrays(parts["led_ring_holder"])[0][:, :2], axis=1).min()
    assert np.linalg.norm(points[:, :2], axis=1).min() >= hole_mm - 0.02
    assert next(part for part in made.parts if part.name == "housing_base").brep.size > 0


def test_a_holder_held_on_one_side_does_not_stand() -> None:
    """A ring at z 5 mm over a plate at 0 with posts up to 4.9 mm: one post, or two beside each
    other, let it fall 5 mm; three around it hold it at 0.1; without a plate nothing does."""
    ring = evaluate(csg.moved(RING, (0.0, 0.0, 6.0)))
    plate = csg.cylinder(12.0, -2.0, 0.0)
    posts = [
        csg.turned(csg.moved(csg.cylinder(1.0, -1.0, 4.9), (8.0, 0.0, 0.0)), turn)
        for turn in (0.0, 30.0, 120.0, 240.0)
    ]
    for number, drop_mm in ((1, 5.0), (2, 5.0), (4, 0.1)):
        base = evaluate(csg.together(plate, posts[:number]))
        assert seat_gap(ring, base).value == pytest.approx(drop_mm, abs=1e-6)
    assert seat_gap(ring, evaluate(posts[0])).value == FARTHEST_MM


def test_a_holder_in_the_foot_needs_no_sleeve(finger: Solid) -> None:
    """A ring at 0.5 mm sits 1.5 mm deep in the foot: it stands there, and the foot stays flat."""
    made = housed(finger, Housing())
    assert named(made, "led_holder_seat")["led_ring_holder"].severity is Severity.GOOD
    base = next(part for part in made.parts if part.name == "housing_base")
    assert base.points_mm[:, 2].max() == pytest.approx(0.0, abs=1e-6)


def test_advice_for_a_pocket_at_the_cavity_wall_helps(pad: Solid) -> None:
    """0.38 mm at a ring of 7.6 mm: the message says 0.5 mm less, and 7.1 mm has 0.8 mm of wall.

    The holder is cut by the cavity at 8.85 mm, the LED's back is 0.82 mm behind its place and
    tilted by 60 degrees: the largest ball beside it and under the top, at the LED's height, has
    the radius ((8.85 - 7.6) sin 60 - 0.82) / (1 + sin 60 - cos 60).
    """
    check = named(ringed(pad, 13.0, 7.6), "minimum_wall")["led_ring_holder"]
    sine = math.sin(math.radians(60.0))
    wall_mm = 2.0 * (1.25 * sine - 0.82) / (1.0 + sine - 0.5)
    # Walls are looked for at places up to 0.2 mm below that ball; they grow by 0.54 mm per mm.
    assert wall_mm - 0.01 < check.value < wall_mm + 0.11
    assert "lower optics.ring.radius_mm by 0.5 mm" in check.message
    assert "housing.wall_mm" not in check.message
    assert check.severity is Severity.WARNING
    check = named(ringed(pad, 13.0, 7.1), "minimum_wall")["led_ring_holder"]
    assert check.severity is Severity.GOOD


def test_advice_for_crowded_leds_is_fewer(pad: Solid) -> None:
    """12 LEDs of 1.6 mm on a ring of 4 mm are 2.1 mm apart: fewer of them, not thicker walls."""
    check = named(ringed(pad, 13.0, 4.0), "minimum_wall")["led_ring_holder"]
    assert check.severity is Severity.WARNING
    assert "lower optics.ring.count" in check.message
    assert "housing.wall_mm" not in check.message


def test_a_thin_ledge_goes_without_thinning_the_base_beside_it(
    default_solid: Callable[[str], Solid],
) -> None:
    """DIGITac: above the corners of the mount's seat, beyond the ring's, 1.35 mm of base are left;
    the ledge of 0.5 mm between the two seats is gone."""
    solid = default_solid("digitac")
    ring = LedRing(count=6, radius_mm=5.0, height_mm=1.3)
    camera = Camera(position_mm=(0.0, 0.0, 0.3))
    made = make_housing(solid, Housing(), ring=ring, camera=camera, printer=Printer())
    check = named(made, "minimum_wall")["housing_base"]
    assert check.value == pytest.approx(1.35, abs=1e-3)
    base = next(part for part in made.parts if part.name == "housing_base")
    assert base.brep.size > 0


def test_a_sensor_without_a_ring_has_no_holder(finger: Solid) -> None:
    """A ring of no LEDs: support, camera mount and base, one body each, with room for nothing."""
    made = make_housing(
        finger, Housing(), ring=LedRing(count=0), camera=Camera(), printer=Printer()
    )
    parts = {part.name: part.volume_mm3 for part in made.parts}
    assert list(parts) == ["support", "camera_mount", "housing_base"]
    assert min(parts.values()) > 0.0
    checks = {check.name for check in made.checks}
    assert "camera_clearance" in checks
    assert not checks & {"led_clearance", "led_holder_seat"}


@pytest.mark.parametrize(("radius_mm", "value_mm"), [(20.0, -7.0), (11.9, -0.05)])
def test_leds_beside_the_cavity_are_bad(finger: Solid, radius_mm: float, value_mm: float) -> None:
    """LEDs outside the finger touch nothing, and are 7 mm from its inner face at 13 mm; those in
    its wall overlap it: red both."""
    ring = LedRing(radius_mm=radius_mm)
    made = make_housing(finger, Housing(), ring=ring, camera=Camera(), printer=Printer())
    check = named(made, "led_clearance")["led_ring_holder"]
    assert check.severity is Severity.BAD
    assert check.value < value_mm


def test_a_camera_beside_the_cavity_is_bad(finger: Solid) -> None:
    """10 mm outside the skin it touches nothing, and sees nothing."""
    camera = Camera(position_mm=(30.0, 0.0, 1.0))
    made = make_housing(finger, Housing(), ring=LedRing(), camera=camera, printer=Printer())
    check = named(made, "camera_clearance")["camera_mount"]
    assert check.severity is Severity.BAD
    assert check.value < -10.0
