"""`wb.Sensor` on a small finger: one call, its objects, its packs, and what it refuses."""

from __future__ import annotations

import dataclasses
import functools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.condensed.surface import surface_of
from tests.synthetic_light import lit
from tests.synthetic_skin import flat_skin, soft_skin
from workbench.core.base.errors import DesignError
from workbench.core.base.poses import rotations
from workbench.core.design.camera import Camera
from workbench.core.design.design import Elastomer
from workbench.core.design.lighting import LightModel
from workbench.core.design.optics import Markers, Optics
from workbench.core.result.condensed import Hardening
from workbench.sensor.halves import halved, made_whole
from workbench.sensor.pack import HEAD, Pack, read_pack, write_pack
from workbench.sensor.sensor import Sensor

pytestmark = pytest.mark.usefixtures("taichi_device")

TIP_MM = 42.0
BALL_MM = 6.0


@functools.cache
def small_pack() -> Pack:
    """A finger of coarse triangles with dots, seen by 96 x 72 pixels."""
    from sim.optics.proof.specimen import finger
    from sim.optics.studio.render import Studio
    from workbench.sensor.making import rest_depth_mm

    mesh = finger(edge_mm=1.0)
    optics = Optics(
        camera=Camera(width_px=96, height_px=72),
        light_model=LightModel("hybrid"),
        markers=Markers(visible=True),
    )
    light, table = lit(mesh, optics.light_model)
    studio = Studio(mesh, light, optics, table=table)
    outer = mesh.outer
    skin = soft_skin(outer.points_mm, outer.normals, outer.faces)
    return Pack(
        name="small",
        design_toml="name = 'small'\n",
        skin=skin,
        law=Hardening(normal=(0.4, 1.5, 0.0), deepest=0.5, errors={"sphere": 0.04}),
        material=Elastomer(),
        surface=surface_of(skin.points_mm, skin.normals, mesh.seen.points_mm, mesh.seen.normals),
        images=studio.imager.state(),
        rest_depth_mm=rest_depth_mm(studio),
        left_out=("blur out of focus",),
    )


@pytest.fixture(scope="module")
def sensor() -> Sensor:
    return Sensor(small_pack())


def at_tip(depth_mm: float, aside_mm: float = 0.0) -> np.ndarray:
    """Pose of a ball over the tip."""
    return np.array([aside_mm, 0.0, TIP_MM + BALL_MM / 2 - depth_mm, 1.0, 0.0, 0.0, 0.0])


def test_a_call_gives_image_and_force(sensor: Sensor) -> None:
    """Nothing off the skin; deeper presses push back harder and change more of the image."""
    ball = sensor.object("sphere", size_mm=BALL_MM)
    sensor.reset()
    away = sensor.render(at_tip(-1.0), ball)
    assert away.rgb.shape == (1, 72, 96, 3)
    assert away.rgb.dtype == np.uint8
    assert not away.force_N.any()
    assert not away.displacement_mm.any()
    frames = [sensor.render(at_tip(depth), ball) for depth in (0.3, 0.6)]
    forces = [frame.force_N[0] for frame in frames]
    changed = [np.abs(frame.rgb.astype(int) - away.rgb).sum() for frame in frames]
    assert forces[1][2] > 1.5 * forces[0][2] > 0.0
    assert np.abs(forces[1][:2]).max() < 0.05 * forces[1][2]
    assert changed[1] > changed[0] > 0
    # The camera looks up: pressed in, the tip is nearer.
    assert np.nanmin(frames[1].depth_mm - away.depth_mm) == pytest.approx(-0.6, abs=0.15)
    side = sensor.render(np.array([15.0 + 3.0 - 0.6, 0.0, 20.0, 1.0, 0.0, 0.0, 0.0]), ball)
    assert side.force_N[0, 0] > 0.1
    assert np.nanmax(np.abs(side.markers_px - away.markers_px)) > 0.05
    assert frames[1].within_range.all(), frames[1].notes


def test_several_at_once_are_each_alone(sensor: Sensor) -> None:
    """Three rows in one call, and each row by itself: the same bytes and numbers."""
    ball = sensor.object("sphere", size_mm=BALL_MM)
    rows = np.stack([at_tip(0.2), at_tip(0.5, 0.4), at_tip(-2.0)])
    sensor.reset(3)
    together = sensor.render(rows, ball)
    for number, row in enumerate(rows):
        sensor.reset(1)
        alone = sensor.render(row, ball)
        assert np.array_equal(alone.rgb[0], together.rgb[number])
        assert np.array_equal(alone.force_N[0], together.force_N[number])


def test_a_mesh_keeps_its_own_frame(sensor: Sensor) -> None:
    """A block whose origin is far from its middle, turned: the same force, torque about it."""
    import trimesh

    block = trimesh.creation.box((5.0, 5.0, 5.0))
    apart = np.array([7.0, -3.0, 11.0])
    shifted = block.copy()
    shifted.apply_translation(apart)
    turn = np.array([[np.cos(0.1), np.sin(0.1), 0.0, 0.0]])
    middle = np.array([0.1, 0.2, TIP_MM + 2.5 - 0.4])
    sensor.reset(1)
    one = sensor.render(np.r_[middle, turn[0]], sensor.object(block))
    sensor.reset(1)
    origin = middle - rotations(turn)[0] @ apart
    vertices, faces = np.asarray(shifted.vertices), np.asarray(shifted.faces)
    other = sensor.render(np.r_[origin, turn[0]], sensor.object((vertices, faces)))
    assert other.force_N == pytest.approx(one.force_N, rel=1e-3, abs=1e-4)
    arm = middle - origin
    told = one.torque_Nmm[0] + np.cross(arm, one.force_N[0])
    assert other.torque_Nmm[0] == pytest.approx(told, rel=1e-3, abs=2e-3)


@pytest.mark.parametrize(
    ("pose", "words"),
    [
        ([0.0, 0.0, np.nan, 1.0, 0.0, 0.0, 0.0], "pose 0 is not finite"),
        ([0.0, 0.0, 45.0, 0.0, 0.0, 0.0, 0.0], "quaternion of length 0"),
        ([0.0, 0.0, 45.0], "have shape"),
    ],
)
def test_bad_poses_are_refused(sensor: Sensor, pose: list[float], words: str) -> None:
    """With what is wrong and what a row is."""
    ball = sensor.object("sphere", size_mm=BALL_MM)
    with pytest.raises(DesignError, match=words) as caught:
        sensor.render(np.array(pose), ball)
    assert "qw, qx, qy, qz" in caught.value.hint


def test_bad_objects_are_refused(sensor: Sensor) -> None:
    """A sheet, an open box, and no object at all."""
    import trimesh

    box = trimesh.creation.box((5.0, 5.0, 5.0))
    with pytest.raises(DesignError, match="not watertight"):
        sensor.object((box.vertices, box.faces[:-1]))
    with pytest.raises(DesignError, match="there is no indenter"):
        sensor.object("hammerhead")
    flat = np.array([[0.0, 0, 0], [5, 0, 0], [0, 5, 0]])
    with pytest.raises(DesignError, match=r"encloses no volume|not watertight"):
        sensor.object((flat, np.array([[0, 1, 2], [0, 2, 1]])))


def test_it_says_when_a_pose_leaves_its_range(sensor: Sensor) -> None:
    """Deeper than what forces were fitted to."""
    ball = sensor.object("sphere", size_mm=BALL_MM)
    sensor.reset(1)
    frame = sensor.render(at_tip(1.7), ball)
    assert not frame.within_range[0]
    assert "fitted up to 0.50" in frame.notes[0]


def test_a_pack_is_read_back(sensor: Sensor, tmp_path: Path) -> None:
    """Images to a grey level, forces to a thousandth; the folder says what is in it."""
    pack = small_pack()
    written = write_pack(pack, tmp_path / "pack", {"LICENSE": b"words"})
    assert {path.name for path in written} >= {"pack.json", "design.toml", "LICENSE"}
    head = json.loads((tmp_path / "pack" / HEAD).read_text())
    assert head["image_px"] == [96, 72]
    assert head["left_out"] == ["blur out of focus"]
    assert head["largest_force_errors"] == {"sphere": 0.04}
    again = Sensor.load(tmp_path / "pack")
    ball = again.object("sphere", size_mm=BALL_MM)
    sensor.reset(1)
    for depth in (0.2, 0.6):
        one = sensor.render(at_tip(depth), ball)
        other = again.render(at_tip(depth), ball)
        assert np.abs(one.rgb.astype(int) - other.rgb).max() <= 1
        assert other.force_N == pytest.approx(one.force_N, rel=1e-3, abs=1e-4)


def test_bad_packs_are_refused(tmp_path: Path) -> None:
    """Of another format, and damaged."""
    folder = tmp_path / "pack"
    write_pack(small_pack(), folder, {})
    head = json.loads((folder / HEAD).read_text())
    (folder / HEAD).write_text(json.dumps({**head, "format": 99}))
    with pytest.raises(DesignError, match="has format 99; this program reads 1"):
        read_pack(folder)
    (folder / HEAD).write_text(json.dumps(head))
    (folder / "contact.npz").write_bytes(b"nothing")
    with pytest.raises(DesignError, match="cannot be read") as caught:
        Sensor.load(folder)
    assert "export" in caught.value.hint
    with pytest.raises(DesignError, match="size that they were packed with"):
        Sensor.load(folder, width_px=64)


def test_half_of_a_compliance_is_all_of_it() -> None:
    """To half precision; the same pairs in the same order."""
    whole = flat_skin(7, 0.8).compliance
    again = made_whole(halved(whole))
    assert np.array_equal(again.starts, whole.starts)
    assert np.array_equal(again.neighbours, whole.neighbours)
    assert np.abs(again.blocks_mm_N - whole.blocks_mm_N).max() < 1e-3


def test_rows_of_the_room(tmp_path: Path) -> None:
    """Errors, nulls and limits of a record that is made up."""
    from workbench.proof.judge import judge
    from workbench.proof.validation.sensor import room, sensor_figures
    from workbench.proof.validation.sensor.spring import spring

    depth = [0.1, 0.2, 0.4]
    figures: dict[str, Any] = {
        "depth_mm": depth,
        "normal_N": [0.02, 0.053, 0.2, 0.2],
        "full_normal_N": [0.02, 0.05, 0.2, 0.2],
        "across_N": [0.0, 0.0, 0.0, 0.045],
        "full_across_N": [0.0, 0.0, 0.0, 0.05],
        "worst_angle_deg": 1.0,
        "torque_error": 0.2,
        "full_torque_Nmm": 1.0,
        "slip": [0.0, 0.0, 0.2, 0.3],
        "full_slip": [0.0, 0.0, 0.05, 0.35],
        "ssim": {"2": 0.98},
        "null_ssim": {"2": 0.9},
        "noted": 0,
    }
    kept = dataclasses.replace(sensor_figures.RECORD, path=tmp_path / "record.json")
    slid = {"across_N": [[0.05, 0, 0], [-0.1, 0, 0]], "full_across_N": [[0.1, 0, 0], [-0.1, 0, 0]]}
    both = {"fit": {}, "cube": figures, "flower": figures, "slide": slid}
    kept.make(lambda: {"designs": {"geltip": both}})
    rows = room.contact_rows(kept)
    assert all(judge(row.name, row.case) for row in rows)
    force = [row for row in rows if row.name == "fast_force"]
    assert [row.value for row in force] == pytest.approx([0.06, 0.0, 0.06, 0.0])
    assert [row.limit for row in force] == [0.06, 0.06, 0.1, 0.1]
    # The best spring of .02, .05 and .2 N is .37 N/mm or so: half as much as a dent of .4 takes.
    assert force[1].null == pytest.approx(
        1 - 0.4 * spring(np.array(depth), np.array([0.02, 0.05, 0.2])) / 0.2
    )
    shear = next(row for row in rows if row.name == "fast_shear")
    assert shear.value == pytest.approx(0.1)
    there_and_back = next(row for row in rows if row.name == "fast_slide")
    assert there_and_back.value == pytest.approx(0.5) and not there_and_back.ok
    torque = next(row for row in rows if row.name == "fast_torque")
    assert not torque.ok
    slip = next(row for row in rows if row.name == "fast_slip")
    assert slip.value == pytest.approx(0.15) and not slip.ok
    assert slip.null == 1.0
    sheared = next(row for row in rows if row.name == "fast_slip_sheared")
    assert sheared.value == pytest.approx(0.05)


def test_what_is_timed_touches(sensor: Sensor) -> None:
    """The ball and the bolt of the benchmark press the tip in every frame, as deep as they say."""
    from workbench.proof.benchmarks import sensor as bench

    for thing in (sensor.object("sphere", size_mm=BALL_MM), bench.bolt(sensor)):
        sensor.reset(1)
        forces = [sensor.feel(pose, thing).force_N[0] for pose in bench.poses(thing, 40)[::8]]
        assert min(force[2] for force in forces) > 0.1
