"""The frame rates of the room `efficiency`: the nine that the paper reports, and ours beside them.

Source: SimTac, *Efficiency of SimTac*. A frame of its deformation is one substep in the released
code, not a settled press; so settled presses stand beside the substeps.
"""

from __future__ import annotations

from dataclasses import dataclass

GPU = "NVIDIA GeForce RTX 4060, i7-13700HX"


@dataclass(frozen=True, kw_only=True, slots=True)
class Pace:
    """One frame rate."""

    row: str
    """Name of the row of `workbench bench efficiency` that measures it."""
    what: str
    size: str
    fps: float | None
    """As published; None where only we measure it."""
    meaning: str
    """What a frame is."""


_SIZES = (("40k", "40K", 250.0), ("300k", "300K", 33.0), ("1300k", "1.3M", 10.0))
_WIDTHS = ((320, 240, 100.0), (640, 480, 25.0), (1280, 960, 10.0))
_POINTS = (("1k", "1K", 100.0), ("5k", "5K", 76.0), ("25k", "25K", 62.0))

ALL = (
    *(
        Pace(row=f"deformation_{name}", what="deformation", size=f"{size} particles", fps=fps,
             meaning="a substep")
        for name, size, fps in _SIZES
    ),
    *(
        Pace(row=f"press_{name}", what="deformation", size=f"{size} particles", fps=None,
             meaning="a settled press")
        for name, size, _ in _SIZES
    ),
    *(
        Pace(row=f"image_{width}", what="image", size=f"{width} x {height}", fps=fps,
             meaning="an image")
        for width, height, fps in _WIDTHS
    ),
    *(
        Pace(row=f"network_{name}", what="force field", size=f"{size} points", fps=fps,
             meaning="a field")
        for name, size, fps in _POINTS
    ),
    Pace(row="network_patch_25k", what="learned forces", size="a dent in 25K points", fps=None,
         meaning="a field, from four sides, in float32"),
)  # fmt: skip
"""In the order of the table."""
PUBLISHED = tuple(pace for pace in ALL if pace.fps is not None)
"""The paper's 250/33/10, 100/25/10 and 100/76/62."""


def published_fps(row: str) -> float | None:
    """What the paper reports of a row, None where it reports nothing."""
    return next((pace.fps for pace in PUBLISHED if pace.row == row), None)
