"""A contact seen near: where it is taken from, how much it is enlarged, and when there is none."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.core.result.sensing import TactileFrames
from workbench.view.close_up import BETWEEN_PX, SIDE_PX, close_up

HIGH, WIDE = 120, 160


def frames(rows: slice, columns: slice) -> TactileFrames:
    """At rest and a frame, in which a place moved by 1 mm and turned from grey to red."""
    rgb = np.full((2, HIGH, WIDE, 3), 100, np.uint8)
    rgb[1, rows, columns] = (200, 50, 50)
    depth = np.full((2, HIGH, WIDE), 10.0, np.float32)
    depth[1, rows, columns] = 9.0
    moved = np.zeros((2, HIGH, WIDE), bool)
    moved[1, rows, columns] = True
    return TactileFrames(
        rgb=rgb,
        depth_z_mm=depth,
        normal=np.zeros((2, HIGH, WIDE, 3), np.float16),
        moved=moved,
        marker_uv_px=np.zeros((2, 0, 2), np.float32),
        exposure=np.ones(3),
        marker_mm=np.zeros((0, 3), np.float32),
    )


@pytest.mark.parametrize(
    ("row", "column"), [(60, 80), (0, 0), (HIGH - 20, WIDE - 20)], ids=["amid", "first", "last"]
)
@pytest.mark.parametrize("number", [0, 1])
def test_the_contact_is_enlarged(row: int, column: int, number: int) -> None:
    """20 px times 1.6 become 316 px, in a corner of the image as well; 39 % of them red, or none.

    The frame without contact shows the place of the last one.
    """
    found = close_up(frames(slice(row, row + 20), slice(column, column + 20)), number)
    assert found is not None
    assert found.rgb.shape == (SIDE_PX, 2 * SIDE_PX + BETWEEN_PX, 3)
    assert found.times == pytest.approx(SIDE_PX / 32)
    red = found.rgb[:, :, 0].astype(int) - found.rgb[:, :, 1] > 75
    assert not red[:, :SIDE_PX].any()
    share = 0.39 if number else 0.0
    assert red[:, -SIDE_PX:].mean() == pytest.approx(share, abs=0.01)


def test_large_contacts_and_none_are_not() -> None:
    """A contact of half the image is seen as it is; where none is seen nothing is near."""
    assert close_up(frames(slice(30, 90), slice(40, 100)), 1) is None
    assert close_up(frames(slice(0, 0), slice(0, 0)), 1) is None
