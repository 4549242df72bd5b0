"""The rows that hold a preset's image against a photograph, and that ask for a visible contact."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from workbench.core.design.lighting import Baking
from workbench.core.result.sensing import TactileFrames
from workbench.project.named_designs import load_design
from workbench.proof.validation.optics import idle_photo
from workbench.proof.validation.optics.contact_seen import seen_change

FEW = Baking(photons=400_000)


def test_the_photographs_nulls() -> None:
    """19.2 dB of its mean colour, 27.3 dB of a quadratic of each colour."""
    photo = idle_photo.photograph()
    mean = np.broadcast_to(photo.mean(axis=(0, 1)), photo.shape)
    assert idle_photo.likeness_dB(mean, photo) == pytest.approx(19.2, abs=0.05)
    assert idle_photo.likeness_dB(idle_photo.quadratic(photo), photo) == pytest.approx(
        27.3, abs=0.05
    )


def test_structure_does_not_see_what_is_radial() -> None:
    """An image and itself under a round fall-off, scaled, correlate by 1; turned over, by -1."""
    row, column = np.mgrid[:48, :64]
    x, y = (column - 31.5) / 32.0, (row - 23.5) / 32.0
    image = np.stack([x, y, x * y + x], axis=2)
    round_part = (5.0 - 3.0 * (x * x + y * y))[:, :, None]
    assert idle_photo.least_correlation(2.0 * image + round_part, image) == pytest.approx(1.0)
    assert idle_photo.least_correlation(round_part - image, image) == pytest.approx(-1.0)


@pytest.mark.slow
def test_the_preset_is_like_the_photograph_and_other_colours_are_not() -> None:
    """Above both limits; with the colours of its sectors one further it misses both."""
    design, photo = load_design("geltip"), idle_photo.photograph()
    optics = dataclasses.replace(design.optics, baking=FEW)
    ring = optics.ring
    turned = dataclasses.replace(ring, colours=(*ring.colours[1:], ring.colours[0]))
    found = []
    for lights in (ring, turned):
        lit = dataclasses.replace(optics, ring=lights)
        image = idle_photo.rest_image(dataclasses.replace(design, optics=lit))
        found.append(
            (idle_photo.likeness_dB(image, photo), idle_photo.least_correlation(image, photo))
        )
    # Grain of a tenth of the photons costs a tenth of a decibel.
    assert found[0][0] > idle_photo.LEAST_DB and found[0][1] > idle_photo.LEAST_CORRELATION - 0.02
    assert found[1][0] < idle_photo.LEAST_DB and found[1][1] < 0.0


def test_change_is_looked_at_a_little_beyond_the_contact() -> None:
    """20 pixels square that darken by 40 in a box of 29: (20 / 29)^2 of 40; 40 at most."""
    depth_mm = np.full((2, 60, 60), 30.0, np.float32)
    moved = np.zeros((2, 60, 60), dtype=bool)
    rgb = np.full((2, 60, 60, 3), 100, np.uint8)
    spot = (1, slice(20, 40), slice(20, 40))
    depth_mm[spot], moved[spot], rgb[spot] = 29.0, True, 60
    nothing: Any = np.zeros(0)
    frames = TactileFrames(
        rgb=rgb,
        depth_z_mm=depth_mm,
        normal=nothing,
        moved=moved,
        marker_uv_px=nothing,
        exposure=np.ones(3, np.float32),
    )
    found = seen_change(frames)
    # Half pixels are rounded: the box has 28 to 30 pixels.
    assert found.mean_grey == pytest.approx(40.0 * (20 / 29) ** 2, rel=0.08)
    assert found.most_grey == 40.0
