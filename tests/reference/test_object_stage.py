"""An object's signed distance is computed once in a project, whatever process needs it next."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from geometry.primitives import rounded_box
from sim.contact.objects import sampling
from sim.contact.specimens import flat_block
from workbench.core.design import Elastomer
from workbench.core.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.monitor import silent
from workbench.core.press import ContactSettings, Press
from workbench.stages import Call, object_distance, press, run
from workbench.store import Store

pytestmark = pytest.mark.usefixtures("taichi_device")

GRID_MM = 0.5
MESH, POINTS = flat_block(width_mm=10.0, height_mm=2.0, grid_mm=GRID_MM)
CASE = (
    Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.3, frames=1),
    ContactSettings(),
)


def test_a_stored_distance_presses_like_a_fresh_one_and_is_not_computed_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bit by bit the same forces, from a process that may not sample."""
    points, faces = rounded_box(2.0, 0.5)
    box = IndenterMesh(points_mm=points, faces=faces)
    indenter = Indenter(kind=IndenterKind.MESH, size_mm=4.0, mesh=box)
    fresh = press(MESH, POINTS, Elastomer(), indenter, *CASE, monitor=silent)

    store, call = Store(tmp_path), Call("object", (indenter, GRID_MM))
    assert not run(store, call).cached
    assert run(store, call).cached
    stored = store.load("object", call.key)
    np.testing.assert_array_equal(
        stored.coefficients, object_distance(indenter, GRID_MM, monitor=silent).coefficients
    )

    def refuse(*args: object, **keywords: object) -> None:
        raise AssertionError("sampled again")

    # As in a process that starts: nothing is kept, and sampling is not allowed.
    monkeypatch.setattr(sampling, "_kept", type(sampling._kept)())
    monkeypatch.setattr(sampling, "sample_indenter", refuse)
    again = press(MESH, POINTS, Elastomer(), indenter, *CASE, stored, monitor=silent)
    np.testing.assert_array_equal(again.reaction_N, fresh.reaction_N)
    np.testing.assert_array_equal(again.displacement_mm, fresh.displacement_mm)
    assert fresh.normal_N[-1] > 0.0
