"""Environments for gymnasium: importing this room registers them, each a file."""

from __future__ import annotations

import gymnasium

MOST_STEPS = 60
"""Steps after which an episode is cut off."""

for name, entry in {
    "WorkbenchPress-v0": "workbench.environments.press:PressEnv",
    "WorkbenchSlide-v0": "workbench.environments.slide:SlideEnv",
}.items():
    gymnasium.register(name, entry, max_episode_steps=MOST_STEPS)
