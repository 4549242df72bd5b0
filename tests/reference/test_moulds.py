"""Moulds: closed single parts that neither overlap nor leave the cast another shape."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from geometry.castability import best_split_deg, thinnest_wall_mm
from geometry.conform import overlaps_mm3, piece_count, share_faces
from geometry.export import part_files, step_file, stl_bytes
from geometry.indenters import load_stl
from geometry.mould_parts import RIM_WIDTH_MM
from geometry.moulds import make_mould
from geometry.primitives import rounded_box, sphere
from geometry.surface import is_watertight, mesh_volume
from workbench.core.design import MouldOptions
from workbench.core.errors import DesignError, GeometryError, StoreError
from workbench.core.fabrication import MouldSet
from workbench.core.results import Solid


@pytest.fixture(scope="module")
def moulds(finger: Solid) -> MouldSet:
    """The mould of the default finger."""
    return make_mould(finger, MouldOptions())


def test_parts_are_single_closed_bodies_after_an_stl_file(moulds: MouldSet, tmp_path: Path) -> None:
    """Half A, half B and core: one piece each, closed, volume kept in float32."""
    assert [part.name for part in moulds.parts] == ["half_a", "half_b", "core"]
    for part in moulds.parts:
        path = tmp_path / f"{part.name}.stl"
        path.write_bytes(stl_bytes(part.points_mm, part.faces))
        mesh = load_stl(path)
        assert part.watertight
        assert is_watertight(mesh.faces)
        assert piece_count(mesh.points_mm, mesh.faces) == 1
        # Chords of 0.02 mm on the cavity of 4000 mm2 are at most 80 of 50,000 mm3.
        assert mesh_volume(mesh.points_mm, mesh.faces) == pytest.approx(part.volume_mm3, rel=1.6e-3)


def test_nothing_overlaps(moulds: MouldSet) -> None:
    """Pairs of parts, measured again from their meshes, and parts with the cast: 0 mm3."""
    assert moulds.overlap_mm3 <= 1e-3
    pairs = overlaps_mm3({part.name: (part.points_mm, part.faces) for part in moulds.parts})
    assert len(pairs) == 3
    assert max(pairs.values()) <= 1e-3


def test_cast_is_the_membrane_enlarged_by_the_shrinkage(moulds: MouldSet, finger: Solid) -> None:
    """V / (1 - 0.002)^3."""
    assert moulds.cast_volume_mm3 == pytest.approx(finger.volume_mm3 / 0.998**3, rel=1e-6)


def test_walls_and_explosion(moulds: MouldSet) -> None:
    """Thinnest wall: 12.5 - 5.5 - 1.7 - 2.5 = 2.8 mm between key and bolt; halves move apart."""
    # The ray from a random place of a round hole finds the narrowest spot to about 0.05 mm.
    assert moulds.thinnest_wall_mm == pytest.approx(2.8, abs=0.1)
    explode = {part.name: np.array(part.explode) for part in moulds.parts}
    assert (explode["half_a"] == -explode["half_b"]).all()
    assert explode["core"][2] < 0.0
    assert 0.0 <= moulds.split_azimuth_deg < 180.0


def test_gate_and_vents_open_into_the_wall(moulds: MouldSet) -> None:
    """Four holes through the flange on the circle of radius 14 / 0.998 mm."""
    core = next(part for part in moulds.parts if part.name == "core")
    top = core.points_mm[np.abs(core.points_mm[:, 2]) < 1e-6]
    radius = np.hypot(top[:, 0], top[:, 1])
    near = top[np.abs(radius - 14.0 / 0.998) < 0.92]
    turn = np.degrees(np.arctan2(near[:, 1], near[:, 0]))
    turns = np.unique(np.round(turn / 30.0) * 30.0 % 360.0)
    assert turns.tolist() == [0.0, 90.0, 180.0, 270.0]
    # Euler characteristic 2 - 2 g counts through holes: gate and three vents.
    points, faces = core.points_mm, core.faces
    pairs = np.stack([faces, np.roll(faces, 1, axis=1)], axis=-1).reshape(-1, 2)
    edges = np.unique(np.sort(pairs, axis=1), axis=0)
    assert len(points) - len(edges) + len(faces) == 2 - 2 * 4


def test_files_are_complete_and_step_keeps_the_names(moulds: MouldSet, tmp_path: Path) -> None:
    """STL and STEP of each part and one assembly, which reads back with three named solids."""
    from build123d import import_step

    files = part_files(moulds.parts)
    stems = ("half_a", "half_b", "core")
    expected = {f"{stem}{end}" for stem in stems for end in (".stl", ".step")}
    assert set(files) == {*expected, "mould_assembly.step"}
    path = tmp_path / "assembly.step"
    path.write_bytes(files["mould_assembly.step"].tobytes())
    assembly = import_step(str(path))
    assert [child.label for child in assembly.children] == list(stems)
    # STEP keeps 15 digits, OCCT integrates trimmed faces to about 1e-6.
    volumes = [part.volume_mm3 for part in moulds.parts]
    assert [solid.volume for solid in assembly.solids()] == pytest.approx(volumes, rel=1e-5)


def test_a_folder_that_is_not_there_is_named(moulds: MouldSet, tmp_path: Path) -> None:
    """StoreError, not a traceback of the kernel."""
    with pytest.raises(StoreError, match="cannot write"):
        step_file(moulds.parts, tmp_path / "gone" / "mould.step")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "options"),
    [
        ({"tip_ratio": 1.5}, {"shrink_percent": 0.0, "clearance_mm": 0.0}),
        ({"tip_ratio": 0.6, "cylinder_mm": 2.0}, {"wall_mm": 20.0, "vent_count": 12}),
        ({"outer_radius_mm": 6.0, "cylinder_mm": 80.0}, {"gate_diameter_mm": 3.0}),
    ],
)
def test_other_fingers_and_options(
    build_finger: Callable[..., Solid], shape: dict[str, float], options: dict[str, float]
) -> None:
    """make_mould itself refuses overlaps and pieces; all closed."""
    moulds = make_mould(build_finger(**shape), MouldOptions(**options))  # pyright: ignore
    assert all(part.watertight for part in moulds.parts)
    assert moulds.thinnest_wall_mm > 1.0


def test_gate_wider_than_the_flange_is_refused(build_finger: Callable[..., Solid]) -> None:
    """Radius 6 and wall 3 mm leave (6 / 0.998 + 3 + 3 - 2) * 2 = 20 mm across."""
    with pytest.raises(
        DesignError, match=r"gate diameter 30 mm is wider than the 20\.0 mm"
    ) as caught:
        make_mould(
            build_finger(outer_radius_mm=6.0, cylinder_mm=5.0),
            MouldOptions(gate_diameter_mm=30.0, wall_mm=3.0),
        )
    assert caught.value.at == "mould.gate_diameter_mm"
    assert RIM_WIDTH_MM == 3.0


def test_split_avoids_undercut() -> None:
    """A leaning prism: pulled along its lean's normal nothing is undercut."""
    points, faces = rounded_box(5.0, 0.0)
    leaning = points + points[:, [2]] * [0.0, 0.5, 0.0]
    azimuth, undercut = best_split_deg(leaning, faces)
    assert azimuth == 0.0
    assert undercut == 0.0


def test_thinnest_wall_of_a_plate() -> None:
    """10 x 10 x 0.7 mm: 0.7 mm."""
    points, faces = rounded_box(5.0, 0.0)
    assert thinnest_wall_mm(points * [1.0, 1.0, 0.07], faces) == pytest.approx(0.7, abs=1e-3)


def test_overlap_of_shifted_boxes() -> None:
    """Two 2 mm cubes 1.5 mm apart share 0.5 x 2 x 2 = 2 mm3: the measure is not blind."""
    points, faces = rounded_box(1.0, 0.0)
    pairs = overlaps_mm3({"one": (points, faces), "other": (points + np.array([1.5, 0, 0]), faces)})
    assert pairs == {("one", "other"): pytest.approx(2.0)}
    with pytest.raises(GeometryError, match="half is not a closed body"):
        overlaps_mm3({"half": (points, faces[1:]), "other": (points, faces)})


def test_sharing_faces_refuses_bodies_that_overlap() -> None:
    """A box standing 1 mm inside another is split by the fuse, and refused."""
    from build123d import Box, Pos

    with pytest.raises(GeometryError, match="pieces after joining"):
        share_faces({"one": Box(2, 2, 2), "other": Pos(1, 0, 0) * Box(2, 2, 2)})
    shared = share_faces({"one": Box(2, 2, 2), "other": Pos(2, 0, 0) * Box(2, 2, 2)})
    assert [body.volume for body in shared.values()] == pytest.approx([8.0, 8.0])


def test_stl_has_the_declared_layout() -> None:
    """84 bytes and 50 per triangle; unit normals out of the ball."""
    points, faces = sphere(math.pi)
    data = stl_bytes(points, faces)
    assert len(data) == 84 + 50 * len(faces)
    assert int.from_bytes(data[80:84], "little") == len(faces)
    normal = np.frombuffer(data, "<f4", 3, 84)
    assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-6)
    assert normal @ points[faces[0]].mean(axis=0) > 0.0
