"""A cylinder with its axis along body +Y: presses with its side."""

from __future__ import annotations

from workbench.core.objects.blocks import cylinder_corners, numbers
from workbench.core.objects.kind import Group, Kind, Shape

KIND = Kind(
    place=8,
    group=Group.SEEN,
    shape=Shape.CYLINDER_Y,
    numbers=numbers,
    corners_mm=cylinder_corners,
)
