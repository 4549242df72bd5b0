"""An object's signed distance is computed once in a project, whatever process needs it next."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from geometry.surface.primitives import rounded_box
from sim.contact.objects import sampling
from sim.contact.studies.specimens import flat_block
from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.press.press import ContactSettings, Press
from workbench.pipeline.stages.object import STAGE, ObjectInputs, object_distance
from workbench.pipeline.stages.press import PressInputs, press
from workbench.pipeline.store import Store
from workbench.planning.running import run

pytestmark = pytest.mark.usefixtures("taichi_device")

GRID_MM = 0.5
MESH, POINTS = flat_block(width_mm=10.0, height_mm=2.0, grid_mm=GRID_MM)
PATH = Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.3, frames=1)


def test_a_stored_distance_presses_like_a_fresh_one_and_is_not_computed_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bit by bit the same forces, from a process that may not sample."""
    points, faces = rounded_box(2.0, 0.5)
    box = IndenterMesh(points_mm=points, faces=faces)
    indenter = Indenter(kind=IndenterKind.MESH, size_mm=4.0, mesh=box)
    given = PressInputs(
        mesh=MESH,
        points=POINTS,
        material=Elastomer(),
        indenter=indenter,
        path=PATH,
        settings=ContactSettings(),
    )
    fresh = press(given, monitor=silent)

    store, call = Store(tmp_path), STAGE.call(ObjectInputs(indenter=indenter, grid_mm=GRID_MM))
    assert not run(store, call).cached
    assert run(store, call).cached
    stored = store.load("object", call.key)
    np.testing.assert_array_equal(
        stored.coefficients,
        object_distance(
            ObjectInputs(indenter=indenter, grid_mm=GRID_MM), monitor=silent
        ).coefficients,
    )

    def refuse(*args: object, **keywords: object) -> None:
        raise AssertionError("sampled again")

    # As in a process that starts: nothing is kept, and sampling is not allowed.
    monkeypatch.setattr(sampling, "_kept", type(sampling._kept)())
    monkeypatch.setattr(sampling, "sample_indenter", refuse)
    again = press(dataclasses.replace(given, sampled=stored), monitor=silent)
    np.testing.assert_array_equal(again.reaction_N, fresh.reaction_N)
    np.testing.assert_array_equal(again.displacement_mm, fresh.displacement_mm)
    assert fresh.normal_N[-1] > 0.0
