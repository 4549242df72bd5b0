"""Which side touches: 21 objects on feet are turned over by what is suggested, others are not."""

from __future__ import annotations

import dataclasses
import itertools
from pathlib import Path

import numpy as np
import pytest

from geometry.objects.everyday import EVERYDAY
from geometry.objects.touching import meant_side, touching_patch
from sim.optics.studio.geometric_dent import lower_face_mm
from tests.made_indenters import HEADS, M, on_a_foot, write_stl
from workbench.core.design.turning import AS_IT_CAME
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.press.texture import Pattern, Texture
from workbench.edit.indenter_choice import choose_indenter, of_mesh
from workbench.live.indenter_display import display_mesh
from workbench.pipeline.touching_side import meant_turn, touching_notice

STEP_MM, DEEP_MM = 0.2, 1.0
LINE = np.arange(-9.9, 10.0, STEP_MM)
PLACES = np.stack(np.meshgrid(LINE, LINE, indexing="ij"), axis=-1).reshape(-1, 2)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Indenter]:
    """The set of 21, as it comes from its STL files."""
    folder = tmp_path_factory.mktemp("set")
    return {
        name: choose_indenter(str(write_stl(on_a_foot(name), folder / f"{name}.stl")))
        for name in HEADS
    }


def pressed_mm(indenter: Indenter) -> np.ndarray:
    """How deep the object goes into a plane, `DEEP_MM` from first touch, over x and y [mm]."""
    points, faces = display_mesh(indenter)
    return np.maximum(DEEP_MM - lower_face_mm(points, faces, PLACES), 0.0)


def overlap(one: np.ndarray, other: np.ndarray) -> float:
    """What two imprints have in common, over what both have together."""
    return float(np.minimum(one, other).sum() / np.maximum(one, other).sum())


def silhouette(name: str) -> np.ndarray:
    """Places below the upper millimetre of a head, seen from above, by exact sections."""
    head = HEADS[name]()
    top_mm = head.bounding_box()[5]
    section = head.trim_by_plane((0.0, 0.0, 1.0), top_mm - DEEP_MM).project()
    inside = np.zeros(len(PLACES), bool)
    for polygon in section.to_polygons():
        start, stop = polygon, np.roll(polygon, -1, axis=0)
        x, y = PLACES[:, :1], PLACES[:, 1:]
        straddles = (start[:, 1] > y) != (stop[:, 1] > y)
        rise = np.where(stop[:, 1] == start[:, 1], 1.0, stop[:, 1] - start[:, 1])
        at = start[:, 0] + (y - start[:, 1]) / rise * (stop[:, 0] - start[:, 0])
        # Holes are polygons too: what is inside an even number is outside.
        inside ^= ((straddles & (x < at)).sum(axis=1) % 2).astype(bool)
    return inside


def test_the_set_has_21_objects_that_touch_alike(files: dict[str, Indenter]) -> None:
    """As the files come, every object presses its square foot: one imprint for all."""
    assert len(files) == 21
    prints = [pressed_mm(indenter) for indenter in files.values()]
    # Rays beside an edge of the foot may fall on either side of it.
    assert min(overlap(prints[0], other) for other in prints[1:]) > 0.97


def test_the_suggestion_makes_all_21_recognisable(files: dict[str, Indenter]) -> None:
    """Turned by it alone, no two imprints share 90 %, and each has its head's own silhouette."""
    prints = {}
    for name, indenter in files.items():
        turn_deg = meant_turn(indenter)
        assert turn_deg == (180.0, 0.0, 0.0), name
        turned = dataclasses.replace(indenter, turn_deg=turn_deg)
        assert meant_turn(turned) is None, name
        prints[name] = pressed_mm(turned)
    alike = {
        pair: overlap(prints[pair[0]], prints[pair[1]])
        for pair in itertools.combinations(prints, 2)
    }
    assert max(alike.values()) < 0.9, max(alike.items(), key=lambda item: item[1])
    rows = len(LINE)
    for name, found in prints.items():
        # Half a turn about X mirrors y.
        mirrored = silhouette(name).reshape(rows, rows)[:, ::-1].ravel()
        touched = found > 0.0
        iou = (touched & mirrored).sum() / (touched | mirrored).sum()
        # A place in 0.2 mm off along an outline of 60 mm or so.
        assert iou > 0.85, (name, iou)


def test_a_head_on_a_lying_foot_is_found_too() -> None:
    """The published sets lie on a side of foot and head: the head is toward -X there."""
    lying = on_a_foot("cross").rotate((0.0, -90.0, 0.0)).to_mesh()
    points = np.asarray(lying.vert_properties, dtype=np.float64)[:, :3]
    mesh = IndenterMesh(points_mm=points, faces=np.asarray(lying.tri_verts, dtype=np.int32))
    assert meant_turn(of_mesh(mesh)) == pytest.approx((0.0, -90.0, 0.0))


@pytest.mark.parametrize("kind", [k for k in IndenterKind if k is not IndenterKind.MESH])
def test_no_shape_of_the_gallery_is_asked_about(kind: IndenterKind) -> None:
    """Neither as a kind, nor were it a file: sharp or rounded it stands as it is meant to."""
    assert touching_notice(Indenter(kind=kind)) == ""
    for edge_mm in (0.0, 0.45):
        points, faces = display_mesh(Indenter(kind=kind, edge_radius_mm=edge_mm))
        assert meant_side(points, faces) is None


@pytest.mark.parametrize("name", EVERYDAY)
def test_no_everyday_object_is_asked_about(name: str) -> None:
    """They lie with what a hand meets down."""
    assert touching_notice(choose_indenter(name)) == ""


def test_a_plain_block_and_a_textured_one_are_not_asked_about(tmp_path: Path) -> None:
    """A cube has no structured side; a texture on the touching side says which is meant."""
    path = write_stl(M.cube((8.0, 8.0, 8.0), True), tmp_path / "cube.stl")
    assert touching_notice(choose_indenter(str(path))) == ""
    path = write_stl(on_a_foot("cross"), tmp_path / "cross.stl")
    texture = Texture(pattern=Pattern.WAVES, height_mm=0.2)
    assert touching_notice(choose_indenter(str(path), texture=texture)) == ""


def test_the_notice_names_the_turn(files: dict[str, Indenter]) -> None:
    """What is typed next stands in it."""
    assert "--turn-deg 180,0,0" in touching_notice(files["dots"])
    assert files["dots"].turn_deg == AS_IT_CAME


def test_the_touching_side_is_the_lowest_part() -> None:
    """0.5 mm up a cone of 90 degrees: a cap of radius 0.5 mm, its lowest point the apex."""
    points, faces = display_mesh(Indenter(kind=IndenterKind.CONE, edge_radius_mm=0.0))
    patch_mm, triangles = touching_patch(points, faces, 0.5)
    lowest = points[:, 2].min()
    assert patch_mm[:, 2].min() == pytest.approx(lowest)
    assert patch_mm[:, 2].max() == pytest.approx(lowest + 0.5)
    assert np.hypot(*patch_mm[:, :2].T).max() == pytest.approx(0.5, abs=1e-6)
    assert triangles.max() < len(patch_mm)
