"""Timed trajectories: sampling, files, a moving sensor, and where they touch."""

from pathlib import Path

import numpy as np
import pytest

from sim.contact.motion.approach import plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.readout.verdict import check_depth
from sim.contact.studies.specimens import finger, flat_block
from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.core.base.frames import quaternion
from workbench.core.base.mapping import from_table, to_table
from workbench.core.base.poses import (
    between,
    composed,
    inverses,
    pose_rows,
    rotations,
    sensor_poses,
)
from workbench.core.press.indenter import Indenter
from workbench.core.press.motion import Mover, release, roll, slide
from workbench.core.press.press import Press
from workbench.core.press.trajectory import COLUMNS, Trajectory
from workbench.core.result.sensing import Contact
from workbench.edit.trajectories import pose_csv, press_poses, read_trajectory

BLOCK, _ = flat_block(width_mm=16.0, height_mm=4.0, grid_mm=1.0)
FINGER, _ = finger(grid_mm=2.0)
COLLIDER = make_collider(Indenter(), grid_mm=0.5)
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
IDENTITY = np.array([[0.0, 0.0, 0.0, *UPRIGHT]])


def straight_down(*heights_mm: float, every_s: float = 0.0) -> Trajectory:
    """A row a second at these heights over the origin."""
    poses = tuple((0.0, 0.0, height, *UPRIGHT) for height in heights_mm)
    times = tuple(float(k) for k in range(len(poses)))
    return Trajectory(times_s=times, poses=poses, every_s=every_s)


def contact_of(indenter_pose: np.ndarray, normal: np.ndarray) -> Contact:
    """A contact that knows its poses only."""
    count = len(indenter_pose)
    nothing = {
        name: np.zeros(count)
        for name in ("residual", "penetration_mm", "friction_ratio", "sliding", "displacement_mm")
    }
    forces = {
        name: np.zeros((count, 3)) for name in ("reaction_N", "moment_Nmm", "support_N", "cut_N")
    }
    return Contact(
        indenter_pose=indenter_pose,
        normal=normal,
        target_mm=np.zeros(3),
        tangent_u=np.zeros(3),
        grid_mm=1.0,
        active_radius_mm=1.0,
        particles=0,
        substeps=0,
        device="cpu",
        **nothing,
        **forces,
    )


def random_poses(count: int, seed: int) -> np.ndarray:
    source = np.random.default_rng(seed)
    wxyz = source.normal(size=(count, 4))
    wxyz *= np.sign(wxyz[:, :1]) / np.linalg.norm(wxyz, axis=1, keepdims=True)
    return np.concatenate([source.normal(size=(count, 3)) * 20.0, wxyz], axis=1)


def test_rotation_and_quaternion_are_inverse() -> None:
    """quaternion(rotations(q)) = q for unit q with w >= 0."""
    poses = random_poses(20, 1)
    matrices = rotations(poses[:, 3:])
    np.testing.assert_allclose(pose_rows(poses[:, :3], matrices), poses, atol=1e-12)
    np.testing.assert_allclose(
        matrices @ np.swapaxes(matrices, 1, 2), np.tile(np.eye(3), (20, 1, 1)), atol=1e-12
    )


def test_pose_times_its_inverse_is_nothing() -> None:
    """p p^-1 = p^-1 p = identity."""
    poses = random_poses(20, 2)
    nothing = np.tile(IDENTITY, (20, 1))
    np.testing.assert_allclose(composed(poses, inverses(poses)), nothing, atol=1e-12)
    np.testing.assert_allclose(composed(inverses(poses), poses), nothing, atol=1e-12)


def test_half_way_of_a_turn_is_half_the_angle() -> None:
    """From 0 to 80 degrees about Z, share 0.25 is 20 degrees; a sign of q changes nothing."""
    angle = np.radians(40.0)
    end = np.array([[4.0, 0.0, 0.0, np.cos(angle), 0.0, 0.0, np.sin(angle)]])
    for sign in (1.0, -1.0):
        other = end * [1, 1, 1, sign, sign, sign, sign]
        found = between(IDENTITY, other, np.array([0.25]))[0]
        exact = [1.0, 0.0, 0.0, np.cos(angle / 4), 0.0, 0.0, np.sin(angle / 4)]
        np.testing.assert_allclose(found, exact, atol=1e-12)


def test_rows_become_frames_or_times_do() -> None:
    """Four rows are three frames; every 0.8 s of 3 s there are 0.8, 1.6, 2.4 and 3 s."""
    rows = straight_down(8.0, 7.0, 6.5, 6.0)
    assert rows.frame_count == 3
    np.testing.assert_array_equal(rows.at_progress(np.arange(4.0))[:, 2], [8.0, 7.0, 6.5, 6.0])
    timed = straight_down(8.0, 7.0, 6.5, 6.0, every_s=0.8)
    assert timed.frame_count == 4
    np.testing.assert_allclose(timed.frame_times_s(), [0.0, 0.8, 1.6, 2.4, 3.0], atol=1e-12)
    found = timed.at_progress(np.arange(5.0))[:, 2]
    np.testing.assert_allclose(found, [8.0, 7.2, 6.7, 6.3, 6.0], atol=1e-12)
    # 0.1 s does not divide 3 s in binary: no frame of a rounding error follows.
    assert straight_down(8.0, 7.0, 6.5, 6.0, every_s=0.1).frame_count == 30


def test_functions_and_arrays_make_the_same_trajectory() -> None:
    """z = 8 - t at 0, 1, 2 s, by a function and by arrays; both survive a table."""
    by_function = Trajectory.from_function(lambda t: (0.0, 0.0, 8.0 - t, *UPRIGHT), range(3))
    poses = np.array([[0.0, 0.0, 8.0 - t, *UPRIGHT] for t in range(3)])
    assert by_function == Trajectory.from_arrays(np.arange(3.0), poses)
    assert by_function == straight_down(8.0, 7.0, 6.0)
    press = Press(trajectory=by_function, mover=Mover.SENSOR, object_pose=(0.0, 0.0, 9.0, *UPRIGHT))
    assert from_table(Press, to_table(press)) == press


def test_speed_changes_labels_alone() -> None:
    """Ten times as slow: the same poses of every frame, other times."""
    fast = straight_down(8.0, 7.0, 6.0)
    slow = Trajectory(times_s=(0.0, 10.0, 20.0), poses=fast.poses)
    progress = np.linspace(0.0, 2.0, 9)
    np.testing.assert_allclose(slow.at_progress(progress), fast.at_progress(progress), atol=1e-12)
    assert Press(trajectory=slow).times_s().tolist() == [0.0, 10.0, 20.0]


@pytest.mark.parametrize(
    ("times", "pose", "message"),
    [
        ((0.0, 0.0), (0, 0, 8, 1, 0, 0, 0), "row 2: t_s 0 s does not come after 0 s of row 1"),
        ((0.0, float("nan")), (0, 0, 8, 1, 0, 0, 0), "row 2: t_s is nan"),
        ((0.0,), (0, 0, 8, 1, 0, 0, 0), "1 times and 2 poses"),
        ((0.0, 1.0), (0, 0, 8, 1, 1, 0, 0), "row 2: the quaternion has length 1.414, not 1"),
        ((0.0, 1.0), (0, 0, 8, 0, 0, 0, 0), "length 0.000"),
        ((0.0, 1.0), (0, float("inf"), 8, 1, 0, 0, 0), "row 2: y_mm is inf"),
        ((0.0, 1.0), (0, 0, 8, 1, 0, 0), "row 2 has 6 numbers, a pose has 7"),
    ],
)
def test_bad_rows_are_refused(
    times: tuple[float, ...], pose: tuple[float, ...], message: str
) -> None:
    """The row, the column and the value."""
    with pytest.raises(DesignError) as raised:
        Trajectory(times_s=times, poses=((0.0, 0.0, 9.0, *UPRIGHT), pose))  # type: ignore[arg-type]
    assert message in raised.value.message
    assert raised.value.at == "press.trajectory"
    assert raised.value.hint


def test_bad_frame_times_are_refused() -> None:
    """Longer than the path, negative, and one row only."""
    for every_s in (4.0, -1.0, float("nan")):
        with pytest.raises(DesignError, match="time between frames"):
            straight_down(8.0, 7.0, 6.0, every_s=every_s)
    with pytest.raises(DesignError, match="row count of the trajectory 1 is outside 2 to 20000"):
        straight_down(8.0)
    with pytest.raises(DesignError, match="3000 rows, each a frame; the limit is 2000 frames"):
        straight_down(*np.linspace(8.0, 7.0, 3000))


def test_quaternions_within_rounding_are_normalised() -> None:
    """Three digits of a turn by 90 degrees: length 1.0000 after 0.7071."""
    poses = ((0.0, 0.0, 8.0, *UPRIGHT), (0.0, 0.0, 7.0, 0.707, 0.707, 0.0, 0.0))
    trajectory = Trajectory(times_s=(0.0, 1.0), poses=poses)
    np.testing.assert_allclose(trajectory.poses[1][3:5], [0.5**0.5] * 2, rtol=1e-12)


def test_target_is_the_middle_of_what_is_covered() -> None:
    """From x = -2 to 4 mm, 1 mm deep in a block: the middle is 1 mm, first touch 3 - 1 mm high."""
    rows = [(-2.0, 8.0), (-2.0, 6.0), (0.0, 6.0), (2.0, 6.0), (4.0, 6.0), (4.0, 8.0)]
    poses = tuple((x, 0.0, z, *UPRIGHT) for x, z in rows)
    press = Press(trajectory=Trajectory(times_s=tuple(range(6)), poses=poses))
    approach = plan_approach(BLOCK.outer, COLLIDER, press)
    # Vertices are 0.4 mm apart.
    np.testing.assert_allclose(approach.target_mm, [1.0, 0.0, 4.0], atol=0.2)
    np.testing.assert_allclose(approach.normal, [0.0, 0.0, 1.0], atol=1e-12)
    assert approach.deepest_mm == pytest.approx(1.0, abs=1e-3)
    assert approach.aside_mm == pytest.approx(6.0)
    assert [approach.pressing(frame) for frame in range(5)] == [True] * 4 + [False]
    assert [approach.continues(frame) for frame in range(5)] == [1, 1, 2, 3, 1]
    np.testing.assert_array_equal(approach.pose(3.0)[0], [2.0, 0.0, 6.0])
    origins, turned = approach.poses(np.array([0.5, 4.0]))
    np.testing.assert_allclose(origins, [[-2.0, 0.0, 7.0], [4.0, 0.0, 6.0]], atol=1e-12)
    np.testing.assert_array_equal(turned[0], np.eye(3))


def test_small_object_between_vertices_is_found() -> None:
    """A ball of 0.5 mm, 0.1 mm deep between four vertices, covers none of them 0.28 mm away."""
    collider = make_collider(Indenter(size_mm=0.5), grid_mm=0.5)
    poses = ((0.2, 0.2, 5.0, *UPRIGHT), (0.2, 0.2, 4.15, *UPRIGHT))
    press = Press(trajectory=Trajectory(times_s=(0.0, 1.0), poses=poses))
    approach = plan_approach(BLOCK.outer, collider, press)
    assert approach.overlaps_mm.tolist() == [0.0, 0.0]
    assert approach.deepest_mm == pytest.approx(0.1, abs=1e-3)
    assert not approach.pressing(0)


def test_path_that_bends_within_a_frame_is_travelled() -> None:
    """Down 2 mm and up again within one frame: 4 mm of way, though it ends where it began."""
    heights = (7.5, 5.5, 7.5, 6.5, 5.5)
    press = Press(trajectory=straight_down(*heights, every_s=2.0))
    approach = plan_approach(BLOCK.outer, COLLIDER, press)
    assert approach.travel_mm(0, 3.0) == pytest.approx(4.0)
    assert approach.travel_mm(1, 3.0) == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("heights", "words"),
    [
        ((18.0, 16.0), ("never touches", "frame 1 of 1, 9 mm away")),
        ((6.5, 6.0), ("starts inside the membrane", "row 1", "0.50 mm")),
        ((3.2, 8.0), ("starts inside the membrane",)),
    ],
)
def test_paths_that_make_no_sense_are_refused(
    heights: tuple[float, ...], words: tuple[str, ...]
) -> None:
    """A block 4 mm high under a ball of radius 3 mm: what is wrong, by how much, in which row."""
    with pytest.raises(DesignError) as raised:
        plan_approach(BLOCK.outer, COLLIDER, Press(trajectory=straight_down(*heights)))
    assert all(word in raised.value.message for word in words)
    assert raised.value.at == "press.trajectory"


def test_start_in_the_cavity_is_refused_and_beside_is_not() -> None:
    """A small ball on the axis of the finger is 13 mm behind its skin; outside it is not."""
    collider = make_collider(Indenter(size_mm=2.0), grid_mm=0.5)

    def begin(x_mm: float) -> None:
        poses = ((x_mm, 0.0, 20.0, *UPRIGHT), (15.5, 0.0, 20.0, *UPRIGHT))
        press = Press(trajectory=Trajectory(times_s=(0.0, 1.0), poses=poses))
        plan_approach(FINGER.outer, collider, press)

    with pytest.raises(DesignError, match=r"1\d\.\d\d mm behind its skin"):
        begin(1.0)
    begin(18.0)


def test_trajectory_into_the_support_is_refused() -> None:
    """Row 3 is 1 mm too deep, a ball of radius 3 mm at 2 mm: which row and how much is told."""
    press = Press(trajectory=straight_down(8.0, 6.0, 2.0, 8.0))
    approach = plan_approach(BLOCK.outer, COLLIDER, press)
    with pytest.raises(DesignError) as raised:
        check_depth(BLOCK.inner.points_mm, approach)
    assert "frame 2 of 3 (row 3 of the trajectory)" in raised.value.message
    assert "reaches 1 mm into the rigid support" in raised.value.message


def test_leaving_the_scene_is_refused() -> None:
    """600 mm away in row 2; a sensor may be anywhere in the room, but not far from the object."""
    away = ((0.0, 0.0, 8.0, *UPRIGHT), (0.0, 600.0, 8.0, *UPRIGHT))
    far = Trajectory(times_s=(0.0, 1.0), poses=away)
    with pytest.raises(DesignError, match="row 2: the trajectory leaves the scene, 600 mm"):
        Press(trajectory=far)
    room = tuple((x + 900.0, y, z, *q) for x, y, z, *q in straight_down(8.0, 7.0).poses)
    Press(trajectory=Trajectory(times_s=(0.0, 1.0), poses=room), mover=Mover.SENSOR)  # type: ignore[arg-type]


def test_trajectory_takes_no_strokes_and_poses_no_press() -> None:
    """What contradicts is refused, one message each."""
    path = straight_down(8.0, 6.0)
    pose = (0.0, 0.0, 8.0, *UPRIGHT)
    for fields, at in (
        ({"trajectory": path, "strokes": (release(),)}, "press.trajectory"),
        ({"object_pose": pose}, "press.object_pose"),
        ({"trajectory": path, "object_pose": pose}, "press.object_pose"),
    ):
        with pytest.raises(DesignError) as raised:
            Press(**fields)
        assert raised.value.at == at


def test_sensor_that_moves_sees_the_object_come() -> None:
    """Sensor poses S and object O in a room: the object is at S^-1 O, turned room and all."""
    seen = np.array([[0.3, 0.0, 8.0, *UPRIGHT], [0.1, 0.0, 6.0, *UPRIGHT]])
    angle = 0.2
    seen[1, 3:] = [np.cos(angle), 0.0, np.sin(angle), 0.0]
    standing = random_poses(1, 3)
    sensors = composed(standing, inverses(seen))
    press = Press(
        trajectory=Trajectory.from_arrays(np.arange(2.0), sensors),
        mover=Mover.SENSOR,
        object_pose=tuple(standing[0]),
    )
    approach = plan_approach(BLOCK.outer, COLLIDER, press)
    for progress in (0.0, 1.0):
        origin, rotation = approach.pose(progress)
        row = seen[int(progress)]
        np.testing.assert_allclose(origin, row[:3], atol=1e-10)
        np.testing.assert_allclose(rotation, rotations(row[3:]), atol=1e-10)


def test_sensor_pushed_up_is_a_press_down() -> None:
    """Without an object's pose the ball stands on the target: 1 mm up is 1 mm deep."""
    path = Trajectory(
        times_s=(0.0, 1.0, 2.0), poses=tuple((5.0, 6.0, 7.0 + z, *UPRIGHT) for z in (0.0, 0.5, 1.0))
    )
    press = Press(trajectory=path, mover=Mover.SENSOR, target_mm=(0.0, 0.0, 4.0))
    approach = plan_approach(BLOCK.outer, COLLIDER, press)
    down = plan_approach(BLOCK.outer, COLLIDER, Press(target_mm=(0.0, 0.0, 4.0), frames=2))
    for progress in (0.0, 0.7, 2.0):
        np.testing.assert_allclose(approach.pose(progress)[0], down.pose(progress)[0], atol=1e-9)
    np.testing.assert_allclose(approach.sensor_poses(), path.poses[1:], atol=1e-9)
    assert down.sensor_poses().shape == (0, 7)


@pytest.mark.parametrize("mover", list(Mover))
@pytest.mark.parametrize("standing", [True, False])
def test_poses_read_back_give_the_same_path(tmp_path: Path, mover: Mover, standing: bool) -> None:
    """Press, slide, roll and release as poses.csv, read again as a trajectory: the same poses."""
    strokes = (slide(1.0, 0.5, frames=2), roll(20.0, frames=2), release(frames=2))
    press = Press(target_mm=(0.0, 0.0, 4.0), frames=2, strokes=strokes, mover=mover)
    approach = plan_approach(BLOCK.outer, COLLIDER, press)
    frames = np.arange(1.0, approach.frame_count + 1.0)
    contact = contact_of(pose_rows(*approach.poses(frames)), approach.normal)
    file = tmp_path / "poses.csv"
    times, poses = press_poses(press, contact)
    file.write_text(pose_csv(times, poses))
    assert len(poses) == approach.frame_count + 1
    trajectory = read_trajectory(file)
    assert trajectory.times_s == tuple(times)
    placed = None
    if standing and mover is Mover.SENSOR:
        placed = tuple(composed(poses[:1], pose_rows(*approach.poses(np.zeros(1))))[0])
    again = Press(target_mm=press.target_mm, trajectory=trajectory, mover=mover, object_pose=placed)
    back = plan_approach(BLOCK.outer, COLLIDER, again)
    progress = np.linspace(0.0, approach.frame_count, approach.frame_count + 1)
    for found, exact in zip(back.poses(progress), approach.poses(progress), strict=True):
        # 15 digits of 7 mm through two products of quaternions.
        np.testing.assert_allclose(found, exact, atol=1e-9)
    # And once more, from the trajectory's own contact.
    contact = contact_of(pose_rows(*back.poses(frames)), back.normal)
    for found, exact in zip(press_poses(again, contact), (times, poses), strict=True):
        np.testing.assert_allclose(found, exact, atol=1e-9)


def test_sensor_poses_keep_the_object_still() -> None:
    """S_k rel_k is the same place in the room for every frame."""
    seen = random_poses(6, 4)
    sensors = sensor_poses(seen, random_poses(1, 5)[0])
    placed = composed(sensors, seen)
    np.testing.assert_allclose(placed, np.tile(placed[:1], (6, 1)), atol=1e-10)


HEADER = ",".join(COLUMNS)
GOOD = f"{HEADER}\n0,0,0,8,1,0,0,0\n1,0,0,6,1,0,0,0\n"
BAD_FILES = {
    "missing column": (GOOD.replace(",qz", ",q_z"), "the column qz is missing"),
    "column twice": (GOOD.replace(",qz", ",qw"), "the column qw is twice"),
    "no header": ("0,0,0,8,1,0,0,0\n1,0,0,6,1,0,0,0\n", "the column t_s is missing"),
    "empty": ("", "the column t_s is missing"),
    "semicolons": (GOOD.replace(",", ";"), "the column t_s is missing"),
    "one row": (
        f"{HEADER}\n0,0,0,8,1,0,0,0\n",
        "has 1 rows of poses; a trajectory needs at least 2",
    ),
    "a word": (GOOD.replace("6", "deep"), "row 2 (line 3), column z_mm: 'deep' is not a"),
    "nan": (GOOD.replace("6", "nan"), "row 2 (line 3), column z_mm: 'nan' is not a"),
    "short row": (GOOD.replace("6,1,0,0,0", "6,1,0"), "row 2 (line 3), column qy: '' is not a"),
    "time stands": (GOOD.replace("\n1,", "\n0,"), "row 2: t_s 0 s does not come after 0 s"),
    "not a rotation": (GOOD.replace("6,1,", "6,2,"), "row 2: the quaternion has length 2.000"),
}


@pytest.mark.parametrize("case", BAD_FILES)
def test_bad_files_are_refused(tmp_path: Path, case: str) -> None:
    """File, row and column stand in the message."""
    text, message = BAD_FILES[case]
    file = tmp_path / "path.csv"
    file.write_text(text)
    with pytest.raises(DesignError) as raised:
        read_trajectory(file)
    assert message in raised.value.message
    assert "path.csv" in raised.value.message
    assert raised.value.hint
    assert raised.value.at == "press.trajectory"


def test_unreadable_files_are_refused(tmp_path: Path) -> None:
    """A folder, nothing, bytes that are no text, and 17 MB."""
    large, binary = tmp_path / "large.csv", tmp_path / "binary.csv"
    with large.open("wb") as file:
        file.truncate(17_000_000)
    binary.write_bytes(b"\xff\xfe\x00\x81")
    for path in (tmp_path, tmp_path / "none.csv", binary, large):
        with pytest.raises(DesignError, match=r"cannot be read|17 MB, more than 16 MB"):
            read_trajectory(path)


def test_columns_may_stand_in_any_order_and_extra_ones_are_told(tmp_path: Path) -> None:
    """A spreadsheet's file: BOM, spaces, an empty line, a column of forces; not part of the key."""
    file = tmp_path / "path.csv"
    file.write_text(
        "\ufeffqw, qx,qy,qz,force_N,z_mm,y_mm,x_mm,t_s\n1,0,0,0,5,8,0,0,0\n\n1,0,0,0,5,6,0,0,1\n",
        encoding="utf-8",
    )
    trajectory = read_trajectory(file)
    assert trajectory == straight_down(8.0, 6.0)
    assert trajectory.notice == "path.csv: ignored column 'force_N'"
    assert Press(trajectory=trajectory).notice == trajectory.notice
    assert digest(trajectory) == digest(straight_down(8.0, 6.0))


def test_quaternion_column_order_is_scalar_first(tmp_path: Path) -> None:
    """qw, qx, qy, qz of 90 degrees about X turns the body's Y to Z."""
    file = tmp_path / "path.csv"
    half = 0.5**0.5
    file.write_text(f"{HEADER}\n0,0,0,8,1,0,0,0\n1,0,0,6,{half},{half},0,0\n")
    turned = rotations(np.array(read_trajectory(file).poses[1][3:]))
    np.testing.assert_allclose(turned @ [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(quaternion(turned), [half, half, 0.0, 0.0], atol=1e-12)
