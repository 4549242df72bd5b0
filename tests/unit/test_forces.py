"""Tables of forces say exactly what the result holds, and nothing that is not finite."""

from __future__ import annotations

import csv
import dataclasses
import io

import numpy as np
import pytest

from geometry.surface.stress import von_mises_MPa
from ui.panels.results.forces import slip_words
from workbench.core.base.errors import SolveError
from workbench.core.press.actuation import Actuation
from workbench.core.press.press import Press
from workbench.core.result.sensing import Contact
from workbench.report.fabrication_tables import plain_numbers
from workbench.view.forces import (
    check_finite,
    csv_bytes,
    force_columns,
    gross_slip,
    slip_columns,
    slip_curve,
)

FRAMES, VERTICES = 3, 4


@pytest.fixture
def contact() -> Contact:
    """A press along +X: one vertex sticks, one slides, two are not touched."""
    poses = np.zeros((FRAMES, 7))
    poses[:, 0] = (0.0, 3.0, 3.0)
    poses[:, 2] = (1.0, 0.5, 4.5)
    poses[:, 3] = 1.0
    rng = np.random.default_rng(2)
    force = np.zeros((FRAMES, VERTICES, 3), np.float32)
    force[:2, :2, 2] = -1.0
    sliding = np.zeros((FRAMES, VERTICES), bool)
    sliding[1, 1] = True
    slip = np.zeros((FRAMES, VERTICES), np.float32)
    slip[1, 1] = 0.5
    return Contact(
        displacement_mm=np.zeros((FRAMES, VERTICES, 3), np.float32),
        reaction_N=np.array([[0.0, 0.0, 1.0], [-0.3, 0.1, 2.0], [0.0, 0.0, 0.0]]),
        moment_Nmm=rng.normal(size=(FRAMES, 3)),
        indenter_pose=poses,
        residual=np.full(FRAMES, 1e-4),
        penetration_mm=np.full(FRAMES, 0.01),
        support_N=rng.normal(size=(FRAMES, 3)),
        cut_N=np.zeros((FRAMES, 3)),
        friction_ratio=np.full(FRAMES, 0.3),
        sliding=sliding,
        target_mm=np.zeros(3),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        grid_mm=0.5,
        active_radius_mm=5.0,
        particles=1,
        substeps=1,
        device="cpu",
        contact_force_N=force,
        sliding_share=np.array([0.0, 0.5, 0.0]),
        slip_mm=slip,
        tangential_N=np.array([0.1, 0.6, 0.0]),
        pressing_N=np.array([1.0, 2.0, 0.0]),
        support_moment_Nmm=rng.normal(size=(FRAMES, 3)),
        actuator_N=rng.normal(size=(FRAMES, 1, 3)),
        actuator_moment_Nmm=rng.normal(size=(FRAMES, 1, 3)),
        strain_energy_Nmm=np.ones(FRAMES),
        kinetic_ratio=np.zeros(FRAMES),
        least_volume_ratio=np.ones(FRAMES),
        frame_seconds=np.ones(FRAMES),
    )


def table(content: bytes) -> dict[str, list[float]]:
    rows = list(csv.DictReader(io.StringIO(content.decode())))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def test_rows_hold_the_forces_of_their_frames(contact: Contact) -> None:
    """U = +X, V = +Y, n = +Z: the reaction's parts are its components, to nine digits."""
    path = Press(frames=FRAMES, actuations=(Actuation(),))
    found = table(csv_bytes(force_columns(path, contact, [0.1, 0.2, 0.3])))
    assert found["frame"] == [1, 2, 3]
    assert found["t_s"][:FRAMES] == [1, 2, 3]
    for column, values in (
        ("tangential_u_N", contact.reaction_N[:, 0]),
        ("tangential_v_N", contact.reaction_N[:, 1]),
        ("normal_N", contact.reaction_N[:, 2]),
        ("support_moment_y_Nmm", contact.support_moment_Nmm[:, 1]),
        ("actuator_0_z_N", contact.actuator_N[:, 0, 2]),
        ("actuator_0_moment_x_Nmm", contact.actuator_moment_Nmm[:, 0, 0]),
        # Frame 1 sticks; in frame 2 half of the contact slides; then nothing touches.
        ("sliding_share", [0.0, 0.5, 0.0]),
        ("depth_mm", [0.1, 0.2, 0.3]),
    ):
        np.testing.assert_allclose(found[column], values, rtol=1e-8)


def test_slip_curve_is_written_where_the_path_goes_sideways(contact: Contact) -> None:
    """3 mm sideways, then straight up: ways 0, 3, 3; ratios 0.1, 0.3 and 0 without contact."""
    columns = slip_columns(contact)
    assert columns is not None
    found = table(csv_bytes(columns))
    assert found["way_mm"] == [0.0, 3.0, 3.0]
    assert found["ratio"] == pytest.approx([0.1, 0.3, 0.0])
    # The page draws what the file holds.
    for name, values in zip(("ratio", "sliding_share"), slip_curve(contact), strict=True):
        np.testing.assert_array_equal(columns[name], values)
    assert found["mean_slip_mm"] == [0.0, 0.5, 0.0]
    straight = contact.indenter_pose.copy()
    straight[:, :2] = 0.0
    assert slip_columns(dataclasses.replace(contact, indenter_pose=straight)) is None


def test_gross_slip_is_told_where_all_slides(contact: Contact) -> None:
    """Shares of 0 and 1 at the middles 0 and 1.5 mm of the way: .95 at 1.425 mm, in frame 2."""
    assert gross_slip(contact) is None
    found = gross_slip(dataclasses.replace(contact, sliding_share=np.array([0.0, 1.0, 1.0])))
    assert found is not None
    assert (found.frame, found.way_mm) == (2, pytest.approx(1.425))
    assert slip_words(contact, 1) == "50 % of the contact slides · no gross slip"
    # Neither the network nor the method of particles know what slides.
    unknown = dataclasses.replace(contact, sliding_share=np.zeros(0))
    assert "does not say" in slip_words(unknown, 1)
    assert gross_slip(dataclasses.replace(contact, sliding_share=np.zeros(0))) is None


@pytest.mark.parametrize("field", ["cauchy_MPa", "reaction_N", "residual"])
def test_values_that_are_not_finite_are_refused(contact: Contact, field: str) -> None:
    """The field and the frame, counted from 1, are named."""
    values = np.zeros((FRAMES, VERTICES, 6)) if field == "cauchy_MPa" else getattr(contact, field)
    values = values.copy()
    values[1] = np.nan
    check_finite(contact)
    with pytest.raises(SolveError, match=f"{field} of frame 2") as caught:
        check_finite(dataclasses.replace(contact, **{field: values}))
    assert caught.value.hint


def test_columns_that_a_method_does_not_know_are_left_out(contact: Contact) -> None:
    """Without energies there is no column of energies, and the rest stays."""
    bare = dataclasses.replace(contact, strain_energy_Nmm=np.zeros(0), pressing_N=np.zeros(0))
    found = force_columns(Press(frames=FRAMES), bare, [0.0] * FRAMES)
    assert "strain_energy_Nmm" not in found
    assert "pressing_N" not in found
    assert "normal_N" in found


def test_json_has_null_for_what_is_not_finite() -> None:
    """Nested NaN and infinity become None, numbers stay."""
    assert plain_numbers({"a": [1.5, float("nan")], "b": {"c": float("inf")}, "d": 2}) == {
        "a": [1.5, None],
        "b": {"c": None},
        "d": 2,
    }


def test_von_mises_of_pure_states() -> None:
    """Tension s: s. Shear t: sqrt(3) t. Pressure alone: 0."""
    stress = np.array([[2.0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 2.0, 0], [5.0, 5.0, 5.0, 0, 0, 0]])
    np.testing.assert_allclose(von_mises_MPa(stress), [2.0, 2.0 * 3.0**0.5, 0.0], rtol=1e-6)
