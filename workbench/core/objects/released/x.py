"""An upright cross of 8 x 8 mm turned by 45 degrees, its arms pointed; presses with its end."""

from __future__ import annotations

from workbench.core.objects.head import cornered, head

KIND = head(
    14,
    size_mm=8.0,
    wide_mm=(4.0, 4.0),
    distance=cornered(
        [
            (2.0, 0.0),
            (4.0, 2.0),
            (4.0, 4.0),
            (2.0, 4.0),
            (0.0, 2.0),
            (-2.0, 4.0),
            (-4.0, 4.0),
            (-4.0, 2.0),
            (-2.0, 0.0),
            (-4.0, -2.0),
            (-4.0, -4.0),
            (-2.0, -4.0),
            (0.0, -2.0),
            (2.0, -4.0),
            (4.0, -4.0),
            (4.0, -2.0),
        ],
        8.0,
    ),
)
