"""Stress, energy, nodal force and pressure of a contact against exact values."""

import dataclasses

import numpy as np
import pytest

from sim.contact.press import press_membrane
from sim.contact.readout.fields import VOIGT, skin_stress, volume_state
from sim.contact.readout.problem import make_problem
from sim.contact.studies.specimens import flat_block
from sim.material import energy_density_MPa, moduli_MPa, stress_of
from workbench.core.design.design import Elastomer, Law
from workbench.core.design.inclusion import Inclusion, Where
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.sensing import Contact

pytestmark = pytest.mark.usefixtures("taichi_device")

MESH, POINTS = flat_block(width_mm=8.0, height_mm=2.0, grid_mm=0.5, skin_mm=0.5)
SMOOTH = Elastomer(friction=0.0)
PRESS = Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.4, frames=8)
SETTINGS = ContactSettings(active_radius_mm=7.0)
GRADIENT = np.array([[0.10, 0.05, 0.00], [-0.02, -0.08, 0.03], [0.00, 0.04, 0.12]])


@pytest.fixture(scope="module")
def pressed(taichi_device: str) -> Contact:
    """A 6 mm ball pressed 0.4 mm into a block of 2 mm without friction, in eight frames."""
    return press_membrane(MESH, POINTS, SMOOTH, PressCase(press=PRESS, settings=SETTINGS))


def domain_of(material: Elastomer):
    return make_problem(MESH, POINTS, material, PressCase(press=PRESS, settings=SETTINGS)).domain


def test_cauchy_stress_of_a_simple_extension() -> None:
    """Stretch 1.2 along x only: sigma_xx = 2 mu (l^2 - 1) / (3 l^(5/3)) + K (l - 1), by hand."""
    domain, stretch = domain_of(SMOOTH), 1.2
    shear, bulk = moduli_MPa(SMOOTH.young_MPa, SMOOTH.poisson)
    stress, _ = skin_stress(domain, domain.node_mm * [stretch - 1.0, 0.0, 0.0])
    deviator = shear * (stretch**2 - 1.0) / stretch ** (5.0 / 3.0)
    pressure = bulk * (stretch - 1.0)
    exact = [2 / 3 * deviator + pressure, *([-deviator / 3 + pressure] * 2), 0.0, 0.0, 0.0]
    inside = domain.outer.vertices
    np.testing.assert_allclose(stress[inside], np.tile(exact, (len(inside), 1)), atol=1e-6)


@pytest.mark.parametrize("law", Law)
def test_stress_and_energy_of_an_affine_field(law: Law) -> None:
    """sigma = P F^T / J and W of the law at each vertex and in the volume, also in an inclusion."""
    stiff = Inclusion(
        where=Where.BOX, centre_mm=(2.0, 0.0, 1.0), size_mm=(4.0, 9.0, 9.0), young_MPa=1.0
    )
    material = dataclasses.replace(SMOOTH, law=law, inclusions=(stiff,))
    domain, linear = domain_of(material), law is Law.LINEAR
    nodal = domain.node_mm @ GRADIENT.T
    stress, energy = skin_stress(domain, nodal)
    vertices = domain.outer.vertices
    shear, bulk = domain.moduli_MPa[domain.outer.cells].T
    gradient = np.broadcast_to(GRADIENT, (len(vertices), 3, 3))
    piola = stress_of(gradient, shear, bulk, linear=linear)
    deformation = np.eye(3) + GRADIENT
    cauchy = piola if linear else piola @ deformation.T / np.linalg.det(deformation)
    exact = np.stack([cauchy[:, r, c] for r, c in VOIGT], axis=1)
    assert len(np.unique(shear)) == 2
    np.testing.assert_allclose(stress[vertices], exact, atol=1e-6)
    density = energy_density_MPa(gradient, shear, bulk, linear=linear)
    np.testing.assert_allclose(energy[vertices], density, rtol=1e-5)
    per_cell = energy_density_MPa(GRADIENT, *domain.moduli_MPa.T, linear=linear)
    whole = float((domain.volumes_mm3.sum(axis=1) * per_cell).sum())
    assert volume_state(domain, nodal).strain_energy_Nmm == pytest.approx(whole, rel=1e-9)


def test_work_of_the_object_becomes_strain_energy(pressed: Contact) -> None:
    """Without friction the integral of force over depth is the energy, but for the springs: 3 %."""
    depth_mm = np.linspace(0.0, 0.4, 9)
    force_N = np.concatenate([[0.0], pressed.normal_N])
    # F grows like d^1.5: its integral is exact for the power through each pair of points.
    power = np.log(force_N[2:] / force_N[1:-1]) / np.log(depth_mm[2:] / depth_mm[1:-1])
    first = force_N[1] * depth_mm[1] / 2.5
    pieces = (force_N[2:] * depth_mm[2:] - force_N[1:-1] * depth_mm[1:-1]) / (power + 1.0)
    work_Nmm = first + pieces.sum()
    assert pressed.strain_energy_Nmm[-1] == pytest.approx(work_Nmm, rel=0.03)
    assert pressed.strain_energy_Nmm[-1] < work_Nmm
    assert pressed.kinetic_ratio.max() < 1e-3


def test_nodal_forces_and_pressures_sum_to_the_reaction(pressed: Contact) -> None:
    """Shares of points sum to one: forces to single precision, pressure times area to 1 %."""
    total_N = pressed.contact_force_N[-1].sum(axis=0, dtype=np.float64)
    np.testing.assert_allclose(total_N, -pressed.reaction_N[-1], atol=1e-6)
    assert pressed.pressing_N[-1] >= pressed.normal_N[-1]
    corners = MESH.outer.points_mm[MESH.outer.faces]
    edges = corners[:, 1:] - corners[:, :1]
    third = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / 6.0
    area_mm2 = np.bincount(MESH.outer.faces.ravel(), np.repeat(third, 3), len(MESH.outer.points_mm))
    by_pressure_N = float(pressed.pressure_MPa[-1] @ area_mm2)
    assert by_pressure_N == pytest.approx(pressed.pressing_N[-1], rel=0.01)


def test_pressure_is_highest_under_the_ball_and_nowhere_negative(pressed: Contact) -> None:
    """The peak is at the pole, and sigma_zz there is minus the pressure to 20 %."""
    pressure = pressed.pressure_MPa[-1]
    assert pressure.min() >= 0.0
    peak = int(pressure.argmax())
    assert np.linalg.norm(MESH.outer.points_mm[peak, :2]) < 0.6
    # Splines see the strain of a whole cell, of which the patch has six: 16 % were measured.
    assert -pressed.cauchy_MPa[-1, peak, 2] == pytest.approx(pressure[peak], rel=0.2)


def test_support_carries_force_and_moment(pressed: Contact) -> None:
    """The force goes through the axis: no moment about the origin, to 1 % of force times 1 mm."""
    assert pressed.support_N[-1, 2] == pytest.approx(pressed.reaction_N[-1, 2], rel=5e-3)
    assert np.abs(pressed.support_moment_Nmm[-1]).max() < 0.01 * pressed.normal_N[-1]


def test_no_field_holds_a_nan(pressed: Contact) -> None:
    """Every number of a result is finite."""
    for field in dataclasses.fields(Contact):
        value = getattr(pressed, field.name)
        if isinstance(value, np.ndarray):
            assert np.isfinite(value).all(), field.name
