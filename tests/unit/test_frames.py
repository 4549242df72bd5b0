"""Frames: a quaternion is its rotation, and the tangent frame of a press is right-handed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from workbench.core.base.frames import PARALLEL, quaternion, tangent

component = st.floats(-1.0, 1.0, allow_nan=False)
LONG = 0.01
"""Shorter random vectors are left out: their direction is mostly rounding."""


def unit(parts: tuple[float, ...]) -> np.ndarray:
    return np.asarray(parts) / np.linalg.norm(parts)


units = st.tuples(*[component] * 3).filter(lambda v: math.hypot(*v) > LONG).map(unit)
quaternions = st.tuples(*[component] * 4).filter(lambda q: math.hypot(*q) > LONG).map(unit)


def rotation_of(wxyz: np.ndarray) -> np.ndarray:
    """Rotation matrix of a unit quaternion by v -> v + 2 w (q x v) + 2 q x (q x v)."""
    w, q = wxyz[0], wxyz[1:]
    return np.stack(
        [v + 2.0 * w * np.cross(q, v) + 2.0 * np.cross(q, np.cross(q, v)) for v in np.eye(3)],
        axis=1,
    )


@given(quaternions)
def test_rotation_to_quaternion_and_back(wxyz: np.ndarray) -> None:
    """The same rotation, of length 1 and with w >= 0; half turns included."""
    rotation = rotation_of(wxyz)
    found = quaternion(rotation)
    assert found[0] >= 0.0
    assert np.linalg.norm(found) == pytest.approx(1.0, abs=1e-14)
    # A symmetric eigenproblem of size 4 with gap 4: some tens of roundings.
    np.testing.assert_allclose(rotation_of(found), rotation, atol=1e-13)


@pytest.mark.parametrize("axis", range(3))
def test_half_turns_have_no_real_part(axis: int) -> None:
    """180 degrees about X, Y, Z: w = 0 and the axis itself up to its sign."""
    rotation = -np.eye(3)
    rotation[axis, axis] = 1.0
    np.testing.assert_allclose(np.abs(quaternion(rotation)), np.eye(4)[axis + 1], atol=1e-15)


@given(units)
def test_tangent_frame_is_orthonormal_and_right_handed(normal: np.ndarray) -> None:
    """(U, n x U, n) is a rotation, and U leans to +Z, or to +X at the poles."""
    tangent_u = tangent(normal)
    frame = np.stack([tangent_u, np.cross(normal, tangent_u), normal], axis=1)
    # Projection cancels up to 1 / PARALLEL of the last digit.
    np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame) == pytest.approx(1.0, abs=1e-12)
    near_pole = math.hypot(normal[0], normal[1]) <= PARALLEL
    assert tangent_u[0 if near_pole else 2] > 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_tangent_at_the_poles_is_x(sign: float) -> None:
    """n = +-Z gives U = +X; 2e-3 away from it U is +Z projected."""
    np.testing.assert_allclose(tangent(np.array([0.0, 0.0, sign])), [1.0, 0.0, 0.0], atol=0.0)
    aside = unit((0.0, 2.0 * PARALLEL, sign))
    np.testing.assert_allclose(tangent(aside)[1], -sign, rtol=1e-5)


def test_no_normal_is_refused() -> None:
    """A normal that is not a number has no tangent plane."""
    with pytest.raises(ValueError, match="not a unit vector"):
        tangent(np.full(3, np.nan))
