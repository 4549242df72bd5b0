"""Poses as rows of seven numbers: x, y, z [mm], then the unit quaternion qw, qx, qy, qz.

A pose maps a body's frame to the frame it is given in. Rotations between two poses are
interpolated on the great circle (Shoemake, Animating rotation with quaternion curves, 1985).
Source of the matrix: Diebel, Representing attitude, 2006, eq. 125.
"""

from __future__ import annotations

import numpy as np

from workbench.core.base.frames import quaternion

NEARLY_EQUAL = 1e-7
"""Angle between quaternions [rad] below which the great circle is taken for straight."""


def rotations(wxyz: np.ndarray) -> np.ndarray:
    """Rotation matrices, shape (..., 3, 3), of unit quaternions, shape (..., 4)."""
    w, x, y, z = np.moveaxis(np.asarray(wxyz, dtype=np.float64), -1, 0)
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def pose_rows(origins_mm: np.ndarray, turned: np.ndarray) -> np.ndarray:
    """Poses, shape (K, 7), of origins, (K, 3), and rotation matrices, (K, 3, 3)."""
    wxyz = [quaternion(rotation) for rotation in turned]
    return np.concatenate([origins_mm, np.reshape(wxyz, (-1, 4))], axis=1)


def composed(frames: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Poses given in frames, as seen from the room of the frames, shape (K, 7): frame pose."""
    frames, poses = np.broadcast_arrays(frames, poses)
    turned = rotations(frames[:, 3:])
    origins = np.einsum("kij,kj->ki", turned, poses[:, :3]) + frames[:, :3]
    return pose_rows(origins, turned @ rotations(poses[:, 3:]))


def inverses(poses: np.ndarray) -> np.ndarray:
    """Pose of the outer frame as seen from the body, shape (K, 7)."""
    back = np.swapaxes(rotations(poses[:, 3:]), 1, 2)
    return pose_rows(-np.einsum("kij,kj->ki", back, poses[:, :3]), back)


def sensor_poses(object_poses: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Poses in the room of a sensor that moves against a fixed object, shape (K, 7).

    Args:
        object_poses: The object as seen from the sensor, frame by frame, shape (K, 7).
        first: The sensor's first pose in the room, shape (7,).
    """
    placed = composed(first[None], object_poses[:1])
    # The sensor is the object in the room times the inverse of the object in the sensor.
    return composed(placed, inverses(object_poses))


def between(first: np.ndarray, second: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """Poses on the way: places on a straight line, rotations on the shorter great circle.

    Args:
        first: Poses, shape (P, 7).
        second: Poses, shape (P, 7).
        shares: How far from first to second, in [0, 1], shape (P,).
    """
    start, end = first[:, 3:], second[:, 3:]
    # A quaternion and its negative are the same rotation: take the nearer of the two.
    end = np.where(np.einsum("pk,pk->p", start, end)[:, None] < 0.0, -end, end)
    # The chord gives small angles to full accuracy, where acos of the product would not.
    angle = 2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(end - start, axis=1), 0.0, 1.0))
    sine = np.sin(angle)
    straight = angle < NEARLY_EQUAL
    divisor = np.where(straight, 1.0, sine)
    before = np.where(straight, 1.0 - shares, np.sin((1.0 - shares) * angle) / divisor)
    after = np.where(straight, shares, np.sin(shares * angle) / divisor)
    wxyz = before[:, None] * start + after[:, None] * end
    wxyz /= np.linalg.norm(wxyz, axis=1, keepdims=True)
    places = first[:, :3] + shares[:, None] * (second[:, :3] - first[:, :3])
    return np.concatenate([places, wxyz], axis=1)
