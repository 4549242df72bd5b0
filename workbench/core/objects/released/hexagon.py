"""A six-sided bar, 6 mm across and 7.1 mm from tip to tip along Y; presses with its end."""

from __future__ import annotations

from workbench.core.objects.head import cornered, head

TIP_MM, FLANK_MM, SHOULDER_MM = 3.5528, 3.0, 1.75

KIND = head(
    9,
    size_mm=2.0 * TIP_MM,
    wide_mm=(FLANK_MM, TIP_MM),
    distance=cornered(
        [
            (FLANK_MM, -SHOULDER_MM),
            (FLANK_MM, SHOULDER_MM),
            (0.0, TIP_MM),
            (-FLANK_MM, SHOULDER_MM),
            (-FLANK_MM, -SHOULDER_MM),
            (0.0, -TIP_MM),
        ],
        2.0 * TIP_MM,
    ),
)
