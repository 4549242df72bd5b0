"""Photographs of a twin: what no dent touches differs by the camera's noise alone."""

from __future__ import annotations

import dataclasses

import cv2
import numpy as np
import pytest

from sim.optics.proof.specimen import dent, finger
from workbench.core.base.monitor import silent
from workbench.core.design.design import SensorDesign
from workbench.project.named_designs import load_design
from workbench.twin.draw import Twin, draw_twin

pytestmark = pytest.mark.usefixtures("taichi_device")

PHOTONS = 1_000_000
FAR_GREY = 3.5
"""More than the camera leaves in a difference, 2.3; photons of its own for each leave 5.6."""


def twin() -> Twin:
    """Of the shipped finger, seen in few pixels."""
    design: SensorDesign = load_design("geltip")
    camera = dataclasses.replace(design.optics.camera, width_px=160, height_px=120)
    return draw_twin(
        dataclasses.replace(design, optics=dataclasses.replace(design.optics, camera=camera)), 1
    )


def test_a_dent_leaves_the_light_elsewhere_as_it_was() -> None:
    """Two photographs differ by noise where nothing moved, and by more where the dent is."""
    from workbench.twin.steady_photographer import SteadyPhotographer

    mesh = finger(edge_mm=1.2)
    moved = dent(mesh.seen, at_mm=(13.0, 7.5, 22.0), depth_mm=0.8, radius_mm=3.0)
    photographer = SteadyPhotographer(twin(), mesh, PHOTONS, silent)
    rest = photographer.at_rest().astype(np.float64)
    untouched = photographer.photograph(np.zeros_like(moved), 1, silent) - rest
    touched = photographer.photograph(moved, 2, silent) - rest
    assert 0.0 < untouched.std() < FAR_GREY
    assert np.median(np.abs(touched)) < FAR_GREY
    smooth = [np.abs(cv2.GaussianBlur(each, (0, 0), 2.0)).max() for each in (touched, untouched)]
    assert smooth[0] > 2.0 * smooth[1]
