"""Which of a support's inner faces the camera sees."""

from __future__ import annotations

import numpy as np

from geometry.volume.skins import _facing_the_camera
from workbench.core.result.results import Label, LabelledSurface


def test_the_wall_all_around_is_the_cavity_and_a_flag_within_it_is_not() -> None:
    """A tube of radius 10 mm, and a square of 4 mm in front of it at X = 5: most looks pass it."""
    turn = 2.0 * np.pi * np.arange(48) / 48
    ring = 10.0 * np.column_stack([np.cos(turn), np.sin(turn)])
    tube = np.vstack([np.column_stack([ring, np.full(48, z)]) for z in (0.0, 20.0)])
    k = np.arange(48)
    beside = (k + 1) % 48
    wall = np.vstack(
        [np.column_stack([k, k + 48, beside]), np.column_stack([beside, k + 48, beside + 48])]
    )
    flag = np.array([[5.0, -2.0, 0.0], [5.0, 2.0, 0.0], [5.0, 2.0, 20.0], [5.0, -2.0, 20.0]])
    faces = np.vstack([wall, [[96, 98, 97], [96, 99, 98]]]).astype(np.int32)
    support = LabelledSurface(
        points_mm=np.vstack([tube, flag]),
        faces=faces,
        labels=np.full(len(faces), Label.INNER, dtype=np.uint8),
    )
    seen = _facing_the_camera(support)
    assert seen.has(Label.INNER)[:-2].all()
    assert seen.has(Label.OUTER)[-2:].all() and not seen.has(Label.INNER)[-2:].any()
