"""Sequences are presses: drives close, stay in step with the object, and open again."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from designs.family import resolve_shape, sequences
from workbench.core.base.errors import DesignError
from workbench.core.base.mapping import from_table, to_table
from workbench.core.press.indenter import Indenter
from workbench.core.press.motion import StrokeKind
from workbench.core.press.press import Press
from workbench.edit.sequences import find_sequence, sequence, titles
from workbench.project.named_designs import load_design


def test_the_trunk_has_a_grip_and_the_finger_has_none() -> None:
    """Names by family; a refusal says what there is."""
    assert list(titles(load_design("trunk"))) == ["grip"]
    assert titles(load_design("finger")) == {}
    with pytest.raises(DesignError, match="finger has no sequence 'grip'"):
        find_sequence(load_design("finger"), "grip")
    with pytest.raises(DesignError, match="no sequence 'grap'") as caught:
        find_sequence(load_design("trunk"), "grap")
    assert "grip" in caught.value.hint


def test_the_grip_closes_after_the_press_and_opens_before_the_lift() -> None:
    """With 4 frames a phase: shares 0 at 4, 1 at 8, 0 at 12; 14 frames, released at the end."""
    design = load_design("trunk")
    press = sequence(design, find_sequence(design, "grip"), frames=4).press
    assert press.frame_count == 14
    assert [stroke.kind for stroke in press.strokes] == [StrokeKind.HOLD, StrokeKind.RELEASE]
    for drive in press.actuations:
        assert [drive.share(frame) for frame in (0, 4, 6, 8, 12, 14)] == [0, 0, 0.5, 1, 0, 0]


@pytest.mark.parametrize("lobe_mm", [2.0, 6.0, 9.0])
def test_the_lobes_close_toward_each_other_as_mirror_images(lobe_mm: float) -> None:
    """The top of the lobe at +Y goes toward -Y by arm x sin(turn), the other one as far to +Y.

    The arm is lobe and wall: a lobe turns at the height of the core's top. Its top and its back
    move as one: actuators 0 and 2 at +Y, 1 and 3 at -Y.
    """
    design = load_design("trunk").replace("shape.lobe_mm", lobe_mm)
    press = sequence(design, find_sequence(design, "grip")).press
    shape = resolve_shape(design.family, design.shape)
    assert [drive.region for drive in press.actuations] == [f"actuator_{n}" for n in range(4)]
    for sign, drive in zip((1.0, -1.0, 1.0, -1.0), press.actuations, strict=True):
        top = np.array([[3.0, sign * shape.saddle.peak_mm, shape.valley_mm + lobe_mm]])
        (moved,) = drive.displacement_mm(top, 10.0)
        angle, arm_mm = np.radians(drive.turn_deg), lobe_mm + design.layers.elastomer_mm
        expected = [0.0, -sign * arm_mm * np.sin(angle), -arm_mm * (1.0 - np.cos(angle))]
        np.testing.assert_allclose(moved, expected, atol=1e-12)
        assert drive.facing == (0.0, sign, 0.0)


def test_object_depth_and_solver_may_be_ones_own() -> None:
    """What is named is taken, the rest stays the family's."""
    design, ball = load_design("trunk"), Indenter(size_mm=8.0)
    grip = find_sequence(design, "grip")
    less = dataclasses.replace(grip, depth_mm=0.3)
    case = sequence(design, less, indenter=ball, settings={"max_substeps": 99})
    usual = sequence(design, grip)
    assert (case.indenter, case.press.depth_mm) == (ball, 0.3)
    assert case.settings == dataclasses.replace(usual.settings, max_substeps=99)


def test_a_sequence_survives_a_file() -> None:
    """Table and back, as a project keeps it: the same press."""
    design = load_design("trunk")
    press = sequence(design, find_sequence(design, "grip")).press
    assert from_table(Press, to_table(press)) == press


def test_every_family_with_sequences_declares_them_for_its_extremes() -> None:
    """At both ends of every slider the trunk's grip has a positive size, depth and turn."""
    from designs.family import sliders

    design = load_design("trunk")
    for slider in sliders("trunk"):
        for value in (slider.minimum, slider.maximum):
            shape = resolve_shape("trunk", {slider.name: value})
            (grip,) = sequences("trunk", shape, design.layers).values()
            assert grip.size_mm > 0.0
            assert 0.0 < grip.depth_mm < design.layers.elastomer_mm
            assert 0.0 < grip.close_deg <= 90.0
