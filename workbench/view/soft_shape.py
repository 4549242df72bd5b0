"""The shape of a soft object during a press, for display."""

from __future__ import annotations

import numpy as np

from workbench.core.result.sensing import Contact


def is_soft(contact: Contact) -> bool:
    """Whether the object of a press was soft."""
    return contact.object_mm.size > 0


def deformed_mm(contact: Contact, frame: int, points_mm: np.ndarray) -> np.ndarray:
    """Places of an object's undeformed vertices in a frame [mm], body frame of its pose, (N, 3).

    Linear between the nodes of the lattice; vertices beyond it move as its nearest node.

    Args:
        contact: A press of a soft object.
        frame: Which frame, from 0.
        points_mm: Undeformed vertices in the body frame [mm], shape (N, 3).
    """
    field = contact.object_mm[frame]
    last = np.array(field.shape[:3]) - 1
    place = (points_mm - contact.object_origin_mm) / contact.object_spacing_mm
    place = np.clip(place, 0.0, last)
    low = np.minimum(np.floor(place).astype(int), np.maximum(last - 1, 0))
    share = place - low
    moved = np.zeros_like(points_mm, dtype=np.float64)
    for corner in np.ndindex(2, 2, 2):
        index = np.minimum(low + corner, last)
        weight = np.where(np.array(corner) == 1, share, 1.0 - share).prod(axis=1)
        moved += weight[:, None] * field[tuple(index.T)]
    return points_mm + moved
