"""Which faces rest on gel, how stiff it is, and how far a push spreads."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from sim.contact.region import backing
from sim.contact.studies import specimens
from workbench.core.design.design import Elastomer
from workbench.core.result.results import Label, MembraneMesh


@pytest.fixture(scope="module")
def mixed() -> MembraneMesh:
    """A block whose inner side is half bonded and half backed over 1.5 mm, with one pin face."""
    mesh, _ = specimens.flat_block(width_mm=4.0, height_mm=2.0, grid_mm=0.5, skin_mm=1.0)
    labels = np.full(len(mesh.inner.faces), Label.INNER, dtype=np.uint8)
    labels[::2] |= np.uint8(Label.BACKED)
    labels[0] |= np.uint8(Label.PIN)
    inner = dataclasses.replace(mesh.inner, labels=labels)
    return dataclasses.replace(mesh, inner=inner, backing_mm=1.5)


def test_backed_faces_are_neither_bonded_nor_pins(mixed: MembraneMesh) -> None:
    """Of 32 faces 16 are bonded, 15 backed, and the pin is neither."""
    bonded, backed = backing.bonded_faces(mixed), backing.backed_faces(mixed)
    assert (bonded.sum(), backed.sum()) == (16, 15)
    assert not np.any(bonded & backed)
    assert not bonded[0]
    assert not backed[0]


def test_stiffness_is_modulus_over_gap(mixed: MembraneMesh) -> None:
    """0.03 MPa over 1.5 mm is 0.02 N/mm3; air and bonded skins have none."""
    assert backing.foundation_N_mm3(mixed, Elastomer(backing_MPa=0.03)) == pytest.approx(0.02)
    assert backing.foundation_N_mm3(mixed, Elastomer(backing_MPa=0.0)) == 0.0
    bonded = dataclasses.replace(mixed, backing_mm=0.0)
    assert backing.foundation_N_mm3(bonded, Elastomer()) == 0.0


def test_a_push_spreads_by_the_plates_length(mixed: MembraneMesh) -> None:
    """l = (D / k)^(1/4): E 0.6, t 1.2, nu 0.45, k 0.02 gives 1.53 mm, four of them 6.1 mm."""
    skin = Elastomer(young_MPa=0.6, poisson=0.45, backing_MPa=0.03)
    plate = 0.6 * 1.2**3 / (12 * (1 - 0.45**2))
    exact = 4.0 * (plate / 0.02) ** 0.25
    assert backing.decay_mm(mixed, skin, 1.2) == pytest.approx(exact, rel=1e-12)
    assert exact == pytest.approx(6.1, abs=0.05)
    assert backing.decay_mm(mixed, Elastomer(backing_MPa=0.0), 1.2) == math.inf
    assert backing.decay_mm(dataclasses.replace(mixed, backing_mm=0.0), skin, 1.2) == 0.0


def test_the_window_lies_a_gap_behind_the_skin(mixed: MembraneMesh) -> None:
    """Normals of the specimen point up: backed vertices' window is at z = -1.5, bonded at 0."""
    points = backing.support_points_mm(mixed)
    assert set(np.unique(points[:, 2])) == {-1.5, 0.0}


def test_pins_do_not_tilt_the_window(mixed: MembraneMesh) -> None:
    """Normals that the sides of pins have tilted by 45 degrees change nothing: z = -1.5 and 0."""
    tilted = np.tile([math.sqrt(0.5), 0.0, math.sqrt(0.5)], (len(mixed.inner.normals), 1))
    inner = dataclasses.replace(mixed.inner, normals=tilted)
    points = backing.support_points_mm(dataclasses.replace(mixed, inner=inner))
    assert set(np.unique(points[:, 2])) == {-1.5, 0.0}
