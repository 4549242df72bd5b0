"""A press path as an episode: what is observed and done in each of its frames, and its task."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.sample import Sample
from workbench.learning.lerobot.layout import ACTION, FORCE, FPS, POSE


def columns_of(samples: Sequence[Sample], skin_mm: np.ndarray) -> dict[str, np.ndarray]:
    """Numbers of the K frames of an episode, (K,) or (K, n), by feature.

    An action is the pose of the next frame, which a robot that follows it would reach; that of the
    last frame is its own pose.

    Args:
        samples: Its frames in order.
        skin_mm: The undeformed skin's vertices, shape (V, 3).
    """
    poses = np.stack([sample.pose for sample in samples])
    frames = np.arange(len(samples))
    return {
        FORCE: np.stack([wrench(sample, skin_mm) for sample in samples]),
        POSE: poses,
        ACTION: np.concatenate([poses[1:], poses[-1:]]),
        "timestamp": frames / FPS,
        "frame_index": frames,
    }


def wrench(sample: Sample, skin_mm: np.ndarray) -> np.ndarray:
    """Force [N] and torque about its origin [N mm] on the object, sensor frame, shape (6,).

    By finite elements where the sample has them. The torque is the sum over the skin's vertices of
    arm times the opposite of the object's force there.

    Args:
        sample: A state.
        skin_mm: The undeformed skin's vertices, shape (V, 3).
    """
    solved = sample.fem or sample.mpm
    assert solved is not None, "a sample holds at least one solver's"
    arms_mm = skin_mm + solved.displacement_mm - sample.pose[:3]
    return np.r_[solved.reaction_N, -np.cross(arms_mm, solved.contact_force_N).sum(axis=0)]


def task_of(case: Case) -> str:
    """What happens in a case, in words."""
    ways = ["press"] + ["drag"] * bool(case.shear_frames) + ["twist"] * bool(case.twist_frames)
    return f"{' and '.join(ways)} the object {case.indenter.value} on the skin"
