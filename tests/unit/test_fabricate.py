"""Parts stay closed through an STL file, which knows places and no vertices."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

from geometry.body import csg
from geometry.body.csg_mesh import arrays, evaluate
from geometry.mould.fabricate import APART_MM, durable
from geometry.workshop.export import stl_bytes


def reread(points_mm: np.ndarray, faces: np.ndarray) -> Any:
    """The mesh as another program reads its STL file."""
    import trimesh

    return trimesh.load_mesh(io.BytesIO(stl_bytes(points_mm, faces)), file_type="stl")


TOUCHING = csg.Union(
    parts=(
        csg.Box(low_mm=(0.0, 0.0, 0.0), high_mm=(20.0, 20.0, 2.0)),
        csg.Box(low_mm=(0.0, 0.0, 1.0), high_mm=(10.0, 10.0, 9.0)),
        csg.Box(low_mm=(10.0, 10.0, 1.0), high_mm=(20.0, 20.0, 9.0)),
    )
)
"""Two towers on a plate that meet in one upright edge, of which four faces go out."""


def test_a_part_that_touches_itself_in_an_edge_is_closed_in_its_file() -> None:
    """Both sides draw back by 2 um; volume 20 20 2 + 2 10 10 7 = 2200 mm3."""
    solid = evaluate(TOUCHING)
    assert not reread(*arrays(solid)).is_watertight
    points, faces, closed = durable(solid)
    mesh = reread(points, faces)
    assert closed
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(2200.0, rel=1e-4)
    assert np.abs(points - arrays(solid)[0]).max() <= APART_MM


def test_a_part_that_touches_nowhere_stays_as_it_is() -> None:
    """Not a vertex moves."""
    solid = evaluate(csg.Box(low_mm=(0.0, 0.0, 0.0), high_mm=(1.0, 2.0, 3.0)))
    points, _, closed = durable(solid)
    assert closed
    assert np.array_equal(points, arrays(solid)[0])
