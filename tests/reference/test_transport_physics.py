"""Traced light against closed forms, at numbers of photons that take seconds."""

from __future__ import annotations

import pytest

from sim.optics.light.lights import place_leds
from sim.optics.proof import baked_light_checks
from sim.optics.proof import transport_checks as checks
from sim.optics.proof.specimen import finger
from sim.optics.transport.gather import gather_light
from workbench.core.design.lighting import LedMount, LedRing
from workbench.core.design.optics import Baking, Coating, Transport

pytestmark = pytest.mark.usefixtures("taichi_device")


def energy_error(*, photons: int = 200_000) -> float:
    """Largest |sum of the balance - 1| for cavity and shell LEDs in a finger.

    Light that leaked or ran out of events is not accounted for, so it counts as missing.
    """
    worst = 0.0
    for mount, radius_mm in ((LedMount.CAVITY, 9.0), (LedMount.SHELL, 12.5)):
        ring = LedRing(mount=mount, radius_mm=radius_mm)
        transport = Transport(
            coating=Coating(), refractive_index=1.41, baking=Baking(photons=photons, nodes=500)
        )
        _, _, scattered = gather_light(finger(edge_mm=1.0), place_leds(ring), transport)
        accounted = sum(scattered.balance[key] for key in ("absorbed", "base", "roulette"))
        worst = max(worst, abs(accounted - 1.0))
    return worst


def test_all_power_is_accounted_for() -> None:
    """Absorbed + through the base + roulette = 1, cavity and shell LEDs; nothing leaks."""
    # Whole numbers lose 6e-8 an event; the issue allows 5e-3.
    assert energy_error(photons=40_000) < 1e-5


def test_a_matte_sphere_scatters_evenly() -> None:
    """Scattered irradiance is P rho / (A (1 - rho)) in each octant."""
    # 600,000 scattered hits at albedo 0.5 make 75,000 in an octant: 0.37 % each, and the largest
    # of eight is mostly below 2.7 standard errors.
    assert checks.furnace_error(photons=600_000) < 0.01


@pytest.mark.parametrize("albedo", [0.2, 0.9])
def test_a_flat_matte_patch_returns_its_albedo(albedo: float) -> None:
    """Under even hemispherical light the returned share is the albedo."""
    traced, exact = checks.flat_furnace(Coating(albedo=albedo, specular=0.0), photons=50_000)
    # Absorption is booked as an expectation, so a matte patch has no noise at all.
    assert exact == pytest.approx(albedo, rel=1e-6)
    assert traced == pytest.approx(albedo, abs=1e-5)


@pytest.mark.parametrize(
    "coating",
    [
        Coating(),
        Coating(albedo=0.0, specular=0.5, roughness=0.3),
        Coating(albedo=0.3, specular=0.5, roughness=0.8),
    ],
)
def test_a_flat_glossy_patch_returns_what_its_lobe_integrates_to(coating: Coating) -> None:
    """Sampling both lobes gives the double hemisphere integral of f cos cos / pi."""
    traced, exact = checks.flat_furnace(coating, photons=100_000)
    # Weights differ by about 0.3 from photon to photon: 1e-3 for 100,000.
    assert traced == pytest.approx(exact, abs=4e-3)


def test_two_discs_exchange_the_same_light_both_ways() -> None:
    """A1 F12 = A2 F21 = the closed form of coaxial discs."""
    there, back, exact = checks.reciprocity(photons=100_000)
    # sqrt(p (1 - p) / N) is 0.15 % and 0.3 %.
    assert there == pytest.approx(exact, rel=0.006)
    assert back == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize("exponent", [1.0, 3.0])
def test_an_led_lights_a_plane_by_cosine_and_square_of_distance(exponent: float) -> None:
    """E = (m + 1) / (2 pi) cos^(m + 1) / r^2 under the LED."""
    # Nodes 1 mm apart receive 1,000 photons and more: 3 %.
    assert checks.plane_irradiance_error(exponent=exponent, photons=400_000) < 0.04


def test_light_enters_a_slab_by_fresnel_and_snell() -> None:
    """At 0, 30, 60 and 80 degrees the share is 1 - (Rs + Rp) / 2 and the angle asin(sin / n)."""
    share, angle_deg = checks.refraction_errors(photons=60_000)
    # sqrt(p (1 - p) / N) is 0.2 % at 80 degrees; a beam 0.5 degree wide has a mean to 0.001.
    assert share < 0.008
    assert angle_deg < 0.01


def test_light_beyond_the_critical_angle_stays_in_the_solid() -> None:
    """At 60 degrees all returns; at 20 and 40 Fresnel's share."""
    assert checks.total_reflection_error(photons=60_000) < 0.006


def test_virtual_leds_stand_where_the_leds_are_at_index_1() -> None:
    """Without refraction direction and irradiance are those of the straight line."""
    difference, angle_deg = baked_light_checks.virtual_light_errors(photons=400_000)
    # 90 photons at each node and light, smoothed over 30 nodes: 2 %; and nodes are 1.6 mm apart.
    assert difference < 0.04
    assert angle_deg < 1.5


def test_the_table_of_direct_light_shades_as_direct_light_does() -> None:
    """At index 1 and the undeformed normal: mean radiance the same, the rest is noise."""
    rms, mean = baked_light_checks.direct_table_errors(photons=600_000)
    # 50 photons and more at each node and light would be 14 %; the lattice halves that.
    assert rms < 0.12
    assert mean < 0.004


@pytest.mark.parametrize("in_shell", [False, True])
def test_the_table_at_rest_is_as_bright_as_photons_are(in_shell: bool) -> None:
    """Radiance from the bake's table and from photons gathered at the vertices: the same mean."""
    # 150,000 photons make 0.3 %; nodes 2 mm apart blur. Bins as they are gathered make 6 %.
    assert baked_light_checks.table_error(in_shell=in_shell, photons=150_000) < 0.015
