"""A square bar, 4 x 4 mm; presses with its end."""

from __future__ import annotations

from workbench.core.objects.head import cornered, head

KIND = head(
    1,
    size_mm=4.0,
    wide_mm=(2.0, 2.0),
    distance=cornered([(2.0, -2.0), (2.0, 2.0), (-2.0, 2.0), (-2.0, -2.0)], 4.0),
)
