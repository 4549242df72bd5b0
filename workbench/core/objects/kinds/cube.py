"""A cube of edge length `size_mm`; presses with a face."""

from __future__ import annotations

from workbench.core.objects.blocks import numbers
from workbench.core.objects.kind import Group, Kind, Shape

KIND = Kind(place=9, group=Group.SEEN, shape=Shape.CUBE, numbers=numbers)
