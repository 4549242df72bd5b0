"""A bar whose section is a rhombus of 8 x 5 mm; presses with its end."""

from __future__ import annotations

from workbench.core.objects.head import cornered, head

KIND = head(
    4,
    size_mm=8.0,
    wide_mm=(4.0, 2.5),
    distance=cornered([(4.0, 0.0), (0.0, 2.5), (-4.0, 0.0), (0.0, -2.5)], 8.0),
)
