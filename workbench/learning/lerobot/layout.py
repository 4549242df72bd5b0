"""What a LeRobot data set v3.0 holds, and where: names of files, features, `info.json`.

Source: `lerobot` 0.4.4, `lerobot/datasets/utils.py` and `lerobot_dataset.py`. Its fields have no
units: names of ours carry them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

VERSION = "v3.0"
FPS = 10
"""Frames a second of presses that have no clock: each frame is at rest, a step on the way."""
CHUNK_FILES = 1000
"""Files of a folder `chunk-000`."""
TABLE_MB, VIDEO_MB = 100, 200
"""Sizes of files to keep to, those of LeRobot."""

INFO, STATS, TASKS = "meta/info.json", "meta/stats.json", "meta/tasks.parquet"
CARD = "README.md"
FIRST = "chunk-{chunk_index:03d}/file-{file_index:03d}"
EPISODES = f"meta/episodes/{FIRST}.parquet"
FRAMES = f"data/{FIRST}.parquet"
VIDEOS = f"videos/{{video_key}}/{FIRST}.mp4"

IMAGE = "observation.images.tactile"
FORCE, POSE, ACTION = "observation.force", "observation.contact_pose", "action"
FORCE_NAMES = [f"force_{a}_N" for a in "xyz"] + [f"torque_{a}_Nmm" for a in "xyz"]
POSE_NAMES = ["x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz"]
VALUES = {FORCE: FORCE_NAMES, POSE: POSE_NAMES, ACTION: POSE_NAMES}
"""Features of several numbers, and the names of these."""
INDICES = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}
"""Features that each data set of LeRobot has, of one number each."""


def features(height_px: int, width_px: int, video: Mapping[str, Any]) -> dict[str, Any]:
    """The features as `info.json` lists them.

    Args:
        height_px: Of the images.
        width_px: Of the images.
        video: What is known of the films: `film.described`.
    """
    image = {
        "dtype": "video",
        "shape": [height_px, width_px, 3],
        "names": ["height", "width", "channels"],
        "info": dict(video),
    }
    values = {
        name: {"dtype": "float32", "shape": [len(names)], "names": names}
        for name, names in VALUES.items()
    }
    indices = {name: {"dtype": kind, "shape": [1], "names": None} for name, kind in INDICES.items()}
    return {IMAGE: image, **values, **indices}


def info(
    counts: Mapping[str, int], splits: Mapping[str, str], features: Mapping[str, Any]
) -> dict[str, Any]:
    """`info.json`: without it nothing is a data set.

    Args:
        counts: `total_episodes`, `total_frames`, `total_tasks`.
        splits: Episodes of each split as "from:to".
        features: As `features` gives them.
    """
    return {
        "codebase_version": VERSION,
        "robot_type": "tactile sensor",
        **counts,
        "chunks_size": CHUNK_FILES,
        "data_files_size_in_mb": TABLE_MB,
        "video_files_size_in_mb": VIDEO_MB,
        "fps": FPS,
        "splits": dict(splits),
        "data_path": FRAMES,
        "video_path": VIDEOS,
        "features": dict(features),
    }


def place(pattern: str, number: int, **names: str) -> str:
    """Path of a numbered file within the folder; 1000 files to a chunk."""
    chunk, file = divmod(number, CHUNK_FILES)
    return pattern.format(chunk_index=chunk, file_index=file, **names)
