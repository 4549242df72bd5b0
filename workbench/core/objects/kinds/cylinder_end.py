"""A cylinder with its axis along the approach: presses with its flat end."""

from __future__ import annotations

from workbench.core.objects.blocks import cylinder_corners, numbers
from workbench.core.objects.kind import Group, Kind, Shape

KIND = Kind(
    place=7,
    group=Group.SEEN,
    aliases=("cylinder",),
    shape=Shape.CYLINDER_Z,
    numbers=numbers,
    corners_mm=cylinder_corners,
)
