"""Read a LeRobot data set by LeRobot's own reader: `python lerobot_reader.py DIR IMAGES.npy`.

Prints one JSON object: versions, the numbers of all frames, and where their images were written.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np

FEATURES = (
    "observation.force",
    "observation.contact_pose",
    "action",
    "episode_index",
    "task_index",
)


def main(root: Path, images: Path) -> None:
    """Read all frames in order, and two at once as a policy would."""
    import lerobot
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    data = LeRobotDataset("workbench/presses", root=root, video_backend="pyav")
    rows = [data[number] for number in range(len(data))]
    seen = [np.asarray(row["observation.images.tactile"]) for row in rows]
    np.save(images, np.rint(np.stack(seen) * 255.0).astype(np.uint8).transpose(0, 2, 3, 1))
    looking_on = {"action": [0.0, 1.0 / data.fps]}
    ahead = LeRobotDataset(
        "workbench/presses", root=root, video_backend="pyav", delta_timestamps=looking_on
    )
    told = {
        "version": lerobot.__version__,
        "episodes": data.num_episodes,
        "fps": data.fps,
        "tasks": [row["task"] for row in rows],
        "mean": np.asarray(data.meta.stats["observation.images.tactile"]["mean"]).ravel().tolist(),
        "ahead": np.asarray(ahead[0]["action"]).tolist(),
        **{name: [np.asarray(row[name]).tolist() for row in rows] for name in FEATURES},
    }
    print(json.dumps(told))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
