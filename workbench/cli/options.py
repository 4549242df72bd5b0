"""What several commands say of the same option."""

from __future__ import annotations

DESIGN = "a preset, a family with its defaults, a design (.toml), or a body (.step, .stp, .stl)"
OUT = "where the files go; made where there is none"
