"""The card of a LeRobot data set: what its numbers mean, which the format has no place for."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.learning.dataset.folder import DataSet
from workbench.learning.lerobot.layout import ACTION, FORCE, FPS, IMAGE, POSE

CARD = """---
task_categories:
- robotics
tags:
- LeRobot
- tactile
configs:
- config_name: default
  data_files: data/*/*.parquet
---

Presses of the tactile sensor {design}, simulated by sensor-workbench {program} (recipe {key}), in
the format LeRobot v3.0. An episode is a press path, a frame one of its states at rest. They have no
clock: {fps} frames a second are a name for "one after the other".

| feature | meaning |
|---|---|
| `{image}` | what the camera in the sensor sees, without loss (H.264, RGB) |
| `{force}` | on the object: force x, y, z [N], torque about its origin x, y, z [N mm] |
| `{pose}` | of the object: x, y, z [mm], qw, qx, qy, qz |
| `{action}` | pose of the next frame; of the last frame its own |

All vectors are in the sensor's frame. Forces are of {solver}. Tasks:

{tasks}
"""


def card_text(data: DataSet, tasks: Sequence[str]) -> str:
    """The card in Markdown, with the head that Hugging Face reads."""
    recipe = data.manifest["recipe"]
    alone = recipe["solvers"] == "mpm"
    return CARD.format(
        design=recipe["design"].get("name", ""),
        program=data.manifest["program"],
        key=data.key,
        fps=FPS,
        image=IMAGE,
        force=FORCE,
        pose=POSE,
        action=ACTION,
        solver="the contact solver" if alone else "finite elements",
        tasks="\n".join(f"- {task}" for task in tasks),
    )
