"""The image preview that follows the sliders: its geometry, and what it asks for."""

from __future__ import annotations

import dataclasses
import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry.objects.indenters import primitive_mesh
from sim.optics.raster.dents import SOFTNESS_MM
from sim.optics.studio.geometric_dent import geometric_dent, lower_face_mm
from workbench.core.base.monitor import silent
from workbench.core.design.lighting import LightModel
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.result.results import Skin
from workbench.live.image_preview import ImagePreview, image_preview_call
from workbench.pipeline.store import Store
from workbench.planning import running
from workbench.planning.plan import plan
from workbench.project.named_designs import load_design
from workbench.project.state import fresh_state

FACET_MM = 0.012
"""The drawn ball is a polyhedron, .0064 mm inside the sphere; 2.5 mm aside its face is steep, and
that is .0064 * 3 / sqrt(9 - 2.5^2) = .0116 mm of height."""


def flat_skin(half_mm: float = 8.0, step_mm: float = 0.25) -> Skin:
    """A square of the plane z = 10, far above its own foot at z = 0."""
    line = np.arange(-half_mm, half_mm + step_mm / 2, step_mm)
    x, y = np.meshgrid(line, line, indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, 10.0)], axis=1)
    points = np.vstack([points, [[0.0, 0.0, 0.0]]])
    number = np.arange(x.size).reshape(x.shape)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    faces = np.concatenate(
        [np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))]
    ).astype(np.int32)
    return Skin(points_mm=points, faces=faces, normals=np.tile([0.0, 0.0, 1.0], (len(points), 1)))


def ball(size_mm: float = 6.0) -> tuple[np.ndarray, np.ndarray]:
    """A sphere as the front draws it."""
    return primitive_mesh(Indenter(kind=IndenterKind.SPHERE, size_mm=size_mm))


def test_lower_face_of_a_ball_is_its_cap() -> None:
    """r - sqrt(r^2 - x^2) below the equator, nothing beyond it."""
    x = np.array([0.0, 1.0, 2.0, 2.5, 3.5])
    found = lower_face_mm(*ball(), np.stack([x, np.zeros(5)], axis=1))
    assert found[:4] == pytest.approx(3.0 - np.sqrt(9.0 - x[:4] ** 2), abs=FACET_MM)
    assert found[4] == math.inf


@pytest.mark.parametrize("depth_mm", [0.5, 1.0])
def test_a_ball_dents_a_plane_to_its_depth(depth_mm: float) -> None:
    """s ln(1 + exp(o / s)) with o = d - (r - sqrt(r^2 - x^2)) along -z, and no motion across."""
    skin = flat_skin()
    moved = geometric_dent(skin, *ball(), target_mm=np.array([0.0, 0.0, 10.0]), depth_mm=depth_mm)
    radius = np.linalg.norm(skin.points_mm[:, :2], axis=1)
    inside = (radius < 2.5) & (skin.points_mm[:, 2] > 5.0)
    overlap = depth_mm - (3.0 - np.sqrt(9.0 - radius[inside] ** 2))
    exact = SOFTNESS_MM * np.logaddexp(0.0, overlap / SOFTNESS_MM)
    # The overlap is as far off as the drawn ball is; the softened one changes by no more than it.
    assert -moved[inside, 2] == pytest.approx(exact, abs=FACET_MM)
    assert not moved[:, :2].any()
    assert not moved[radius > 3.5].any()


def test_an_object_is_as_wide_as_its_widest_side() -> None:
    """A bar 30 mm long and 1 mm thin dents the skin along all of it."""
    import trimesh

    bar = trimesh.creation.box((30.0, 1.0, 1.0))
    skin = flat_skin(16.0)
    moved = geometric_dent(
        skin, np.array(bar.vertices), np.array(bar.faces), target_mm=np.array([0.0, 0.0, 10.0]),
        depth_mm=0.5,
    )  # fmt: skip
    top = (skin.points_mm[:, 2] > 5.0) & (np.abs(skin.points_mm[:, :2]) < [14.9, 0.4]).all(axis=1)
    assert np.abs(skin.points_mm[top, 0]).max() > 14.6
    even_mm = SOFTNESS_MM * np.logaddexp(0.0, 0.5 / SOFTNESS_MM)
    assert -moved[top, 2] == pytest.approx(np.full(top.sum(), even_mm), rel=1e-4)


def test_the_dent_begins_where_the_object_touches_first() -> None:
    """At depth 0 on a slanted ridge the deepest point is the ridge, though the target is beside."""
    skin = flat_skin()
    points = np.array(skin.points_mm)
    points[:, 2] += np.where(points[:, 2] > 5.0, -0.2 * np.abs(points[:, 0] - 1.0), 0.0)
    ridge = dataclasses.replace(skin, points_mm=points)
    moved = geometric_dent(ridge, *ball(), target_mm=np.array([0.5, 0.0, 10.0]), depth_mm=0.0)
    deepest = int(np.argmin(moved[:, 2]))
    # There the overlap is nought exactly; the motion is kept in single precision.
    assert moved[deepest, 2] == pytest.approx(-SOFTNESS_MM * math.log(2.0), rel=1e-6)
    assert abs(points[deepest, 0] - 0.75) <= 0.26


def test_an_image_preview_asks_for_no_photons_and_few_pixels() -> None:
    """Hybrid is lit by straight light, 160 pixels wide; the paper's linear field stays."""
    state = fresh_state(load_design("geltip"))
    call = image_preview_call(state.design, state.case)
    assert call.optics.light_model is LightModel.DIRECT
    assert call.optics.camera.width_px == 160
    linear = state.design.replace("optics.light_model", LightModel.LINEAR)
    assert image_preview_call(linear, state.case).optics.light_model is LightModel.LINEAR
    assert pickle.loads(pickle.dumps(call)) == call


def test_an_image_preview_sees_the_dent_where_the_press_aims(tmp_path: Path) -> None:
    """The pad pressed at its middle changes in the middle of its image and not in the corners."""
    state = fresh_state(load_design("pad"))
    store, kept = Store(tmp_path), dict[str, Any]()
    running.run(store, plan(state.design, state.case)["build"])
    seen: ImagePreview = image_preview_call(state.design, state.case).answer(store, kept, silent)
    change = np.abs(seen.images[1].astype(int) - seen.images[0]).max(axis=2)
    rows, columns = change.shape
    assert change[rows // 4 : -rows // 4, columns // 4 : -columns // 4].max() > 20
    assert change[: rows // 8].max() == 0
    moved = dataclasses.replace(state.case.press, depth_mm=0.2)
    less = image_preview_call(state.design, dataclasses.replace(state.case, press=moved))
    fainter: ImagePreview = less.answer(store, kept, silent)
    assert (fainter.images[0] == seen.images[0]).all()
    faint = np.abs(fainter.images[1].astype(int) - fainter.images[0]).max()
    assert 0 < faint < change.max()
