"""Driven regions: a wall that carries the skin along, and the trunk that grips a ball."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sim.contact.press import press_membrane
from sim.contact.region import small_contacts
from sim.contact.studies.specimens import finger
from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer, SensorDesign
from workbench.core.press.actuation import Actuation, Place
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Extent, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import Label, MembraneMesh
from workbench.core.result.sensing import Contact
from workbench.edit.sequences import LIFT_FRAMES, find_sequence, sequence
from workbench.pipeline.stages.lattice import LatticeInputs, lattice
from workbench.project.named_designs import load_design

pytestmark = pytest.mark.usefixtures("taichi_device")

GRID_MM = 0.8
TIP_MM = (0.0, 0.0, 14.0)
SKINS, POINTS = finger(radius_mm=8.0, cylinder_mm=6.0, grid_mm=GRID_MM, skin_mm=GRID_MM)
SOFT = dataclasses.replace(
    SKINS,
    inner=dataclasses.replace(
        SKINS.inner, labels=np.full(len(SKINS.inner.faces), Label.INNER, np.uint8)
    ),
)
"""A finger whose inner wall is a region."""
BALL = Indenter(size_mm=4.0)
GRIP_FRAMES = 2


def drive_wall(move_mm: Place) -> Contact:
    """The whole inner wall shifted in two frames, below a ball that rests at the tip."""
    wall = Actuation(region="inner", move_mm=move_mm, keys=((0.0, 0.0), (2.0, 1.0)))
    press = Press(target_mm=TIP_MM, depth_mm=0.0, frames=2, actuations=(wall,))
    settings = ContactSettings(grid_mm=GRID_MM)
    return press_membrane(
        SOFT, POINTS, Elastomer(), PressCase(indenter=BALL, press=press, settings=settings)
    )


@pytest.mark.parametrize("move_mm", [(0.0, 0.0, -0.3), (0.3, 0.0, 0.0)])
def test_a_driven_wall_carries_the_unloaded_skin_along(move_mm: Place) -> None:
    """Displacement is the shift everywhere on both skins, half of it in frame 1; forces are 0."""
    contact = drive_wall(move_mm)
    shift_mm = np.outer([0.5, 1.0], move_mm)[:, None]
    # A residual of 1e-3 of the peak's hundredth leaves the soft finger 0.5 um from rest.
    np.testing.assert_allclose(
        contact.displacement_mm, np.broadcast_to(shift_mm, contact.displacement_mm.shape), atol=1e-3
    )
    assert contact.inner_mm.shape == (2, len(SOFT.inner.points_mm), 3)
    np.testing.assert_allclose(
        contact.inner_mm, np.broadcast_to(shift_mm, contact.inner_mm.shape), atol=1e-3
    )
    assert not contact.reaction_N.any()
    assert np.abs(contact.actuator_N).max() < 1e-3


def test_driving_the_wall_at_a_ball_is_pressing_the_ball(
    taichi_device: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only the relative motion counts: wall up by 0.6 mm = ball down by 0.6 mm, drive = support.

    A drive holds with a fifth of a bond's stiffness and reaches the rim, hence 3 %. Cells stay
    whole in both: where a drive takes the skin is not looked for, so its contact halves none.
    """
    monkeypatch.setattr(small_contacts, "MOST_HALVINGS", 0)
    driven = drive_wall((0.0, 0.0, 0.6))
    press = Press(target_mm=TIP_MM, depth_mm=0.6, frames=2)
    settings = ContactSettings(grid_mm=GRID_MM, extent=Extent.FULL)
    pressed = press_membrane(
        SOFT, POINTS, Elastomer(), PressCase(indenter=BALL, press=press, settings=settings)
    )
    np.testing.assert_allclose(driven.normal_N, pressed.normal_N, rtol=0.03)
    balance_N = driven.reaction_N - driven.actuator_N[:, 0]
    assert np.abs(balance_N).max() < 0.01 * driven.normal_N[-1]


@pytest.fixture(scope="module")
def grip(made: Callable[[SensorDesign, str], Any]) -> tuple[MembraneMesh, Contact]:
    """The trunk's grip on a coarse grid: two frames a phase, at its usual closing."""
    design = load_design("trunk").replace("meshing.hex_mm", 0.8)
    case = sequence(
        design, find_sequence(design, "grip"), frames=GRIP_FRAMES, settings={"grid_mm": 1.25}
    )
    solid, skins = made(design, "build"), made(design, "mesh")
    points = lattice(LatticeInputs(solid=solid, grid_mm=case.settings.grid_mm), monitor=silent)
    contact = press_membrane(skins, points, design.material, case)
    return skins, contact


def squeezes_N(contact: Contact) -> tuple[np.ndarray, np.ndarray]:
    """Forces of the object on the skin toward +Y and -Y [N], (K,) each: those of the two lobes."""
    y_N = contact.contact_force_N[:, :, 1].astype(np.float64)
    return np.where(y_N > 0.0, y_N, 0.0).sum(axis=1), -np.where(y_N < 0.0, y_N, 0.0).sum(axis=1)


@pytest.mark.slow
def test_the_trunk_squeezes_a_ball_evenly_and_lets_it_go(
    grip: tuple[MembraneMesh, Contact],
) -> None:
    """Squeezes of both lobes are equal, drives are mirror images, and all is 0 after the lift."""
    _, contact = grip
    pressed, closed, opened = GRIP_FRAMES - 1, 2 * GRIP_FRAMES - 1, 3 * GRIP_FRAMES - 1
    assert len(contact.reaction_N) == 3 * GRIP_FRAMES + LIFT_FRAMES
    left_N, right_N = squeezes_N(contact)
    # Closing multiplies the squeeze that the mere press has on the saddle's flanks.
    assert left_N[closed] > 3.0 * left_N[pressed]
    # The mesh is not quite symmetric: by 2 % of the squeeze.
    np.testing.assert_allclose(left_N[closed], right_N[closed], rtol=0.02)
    assert np.abs(contact.reaction_N[closed, :2]).max() < 0.02 * left_N[closed]
    first_N, second_N = contact.actuator_N[closed, :2] + contact.actuator_N[closed, 2:]
    np.testing.assert_allclose(first_N * [1, -1, 1], second_N, atol=0.02 * np.abs(first_N).max())
    assert first_N[1] < 0.0 < second_N[1]
    # Opened, the ball stands in the saddle as before; friction has shifted the skin a little.
    np.testing.assert_allclose(
        contact.reaction_N[opened],
        contact.reaction_N[pressed],
        atol=0.03 * contact.normal_N[pressed],
    )
    last_N = np.abs(np.concatenate([contact.reaction_N[-1:], contact.actuator_N[-1]])).max()
    assert last_N < 1e-3 * contact.normal_N[closed]
    assert np.abs(contact.displacement_mm[-1]).max() < 0.01


@pytest.mark.slow
def test_forces_on_the_gripping_trunk_balance(grip: tuple[MembraneMesh, Contact]) -> None:
    """reaction = support + drives in every frame, to 0.6 % of the load: all forces' magnitudes."""
    _, contact = grip
    missing_N = contact.reaction_N - contact.support_N - contact.cut_N
    missing_N -= contact.actuator_N.sum(axis=1)
    drives_N = np.linalg.norm(contact.actuator_N, axis=2).sum(axis=1)
    load_N = drives_N + np.linalg.norm(contact.reaction_N, axis=1)
    # A frame settles at 0.5 % of its load; a vanishing load counts as 2 % of the peak.
    limit_N = 0.006 * np.maximum(load_N, 0.01 * load_N.max())
    assert (np.linalg.norm(missing_N, axis=1) < limit_N).all()
    # What the object feels is what the skin feels, shared out to its vertices.
    np.testing.assert_allclose(contact.contact_force_N.sum(axis=1), -contact.reaction_N, atol=1e-3)


@pytest.mark.slow
def test_the_backs_of_the_lobes_follow_their_drives(grip: tuple[MembraneMesh, Contact]) -> None:
    """Closed, the driven faces are within 0.15 mm of where the drive wants them, of 2 mm."""
    skins, contact = grip
    design = load_design("trunk")
    closed = 2 * GRIP_FRAMES - 1
    for drive in sequence(
        design, find_sequence(design, "grip"), frames=GRIP_FRAMES
    ).press.actuations:
        number = int(drive.region[-1])
        outer = skins.outer
        facing = outer.normals @ np.array(drive.facing) > 0.5
        chosen = np.unique(outer.faces[(outer.numbers == number)])
        chosen = chosen[facing[chosen]]
        wanted_mm = drive.displacement_mm(outer.points_mm[chosen], closed + 1.0)
        off_mm = np.linalg.norm(contact.displacement_mm[closed, chosen] - wanted_mm, axis=1)
        # Tops of two lobes and their backs, on cells of 0.8 mm.
        assert len(chosen) > 30
        assert off_mm.mean() < 0.15
        # The lobes themselves closed toward each other.
        assert contact.least_volume_ratio[closed] > 0.5
