"""Meshes that contact must never see."""

import numpy as np
import pytest

from geometry.volume import hexmesh
from geometry.volume.ogrid import Pace
from geometry.volume.sheets import Sheets
from workbench.core.base.errors import MeshingError
from workbench.core.result.results import Label


def test_cell_whose_quality_is_not_a_number_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """NaN is not above 0: one of two cells of a column is counted as inverted."""
    quads = np.array([[0, 1, 2, 3]], np.int32)
    inside = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    outside = np.add(inside, [0.0, 0.0, 1.0])
    ring = np.array([0])
    sheets = Sheets(inside=inside, outside=outside, quads=quads, ring=ring, rim=Label.BASE)
    monkeypatch.setattr(hexmesh, "scaled_jacobian", lambda *_: np.array([1.0, np.nan]))
    with pytest.raises(MeshingError, match="1 of 2 cells are inverted"):
        hexmesh._stack(sheets, Pace(0.5))
