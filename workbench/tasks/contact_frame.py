"""Vectors told in the frame of a contact: the same touch gives the same numbers at every place.

A network sees what is around a contact laid flat, along axes of its own. The force of the object
is learned along these axes, and the place of first touch from the contact's foot:

    f' = A f,    p' = A (p - foot),    A with the axes in its rows.

Where no contact was looked for the frame is the sensor's, and nothing changes.
"""

from __future__ import annotations

import numpy as np

from workbench.learning.dataset.photo_labels import FORCE, TARGET
from workbench.tasks.examples import Examples


def in_contact_frame(found: Examples) -> np.ndarray:
    """True values of examples as a network learns them, shape (N, K)."""
    values = found.truth.copy()
    for columns, origin_mm in _vectors(found):
        values[:, columns] = np.einsum("nij,nj->ni", found.axes, values[:, columns] - origin_mm)
    return values


def in_sensor_frame(values: np.ndarray, found: Examples) -> np.ndarray:
    """What a network tells of examples, (N, K), as the columns have it."""
    values = values.copy()
    for columns, origin_mm in _vectors(found):
        values[:, columns] = np.einsum("nij,ni->nj", found.axes, values[:, columns]) + origin_mm
    return values


def _vectors(found: Examples) -> list[tuple[list[int], np.ndarray]]:
    """Columns of each whole vector among the outputs, with what it is counted from."""
    return [
        ([found.outputs.index(name) for name in names], origin_mm)
        for names, origin_mm in ((FORCE, np.zeros(3)), (TARGET, found.feet_mm))
        if set(names) <= set(found.outputs)
    ]
