"""LeRobot v3.0 data sets: read back by pyarrow and av, and by LeRobot's own reader where it is.

`LEROBOT_PYTHON` names the Python of an environment with `lerobot`, which cannot live in ours.
"""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.synthetic_touches import HEIGHT, WIDTH, touched
from tests.unit import lerobot_reader
from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import silent
from workbench.core.base.packages import PackageError
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.sample import Sample, to_bytes
from workbench.learning.lerobot import film, statistics
from workbench.learning.lerobot.episode import wrench
from workbench.learning.lerobot.export import export_lerobot, whole_cases

av = pytest.importorskip("av")
parquet = pytest.importorskip("pyarrow.parquet")

KEY = "observation.images.tactile"
CASES = 7


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[DataSet, Path]:
    """A data set whose objects move on, and what was written of it."""
    folder = tmp_path_factory.mktemp("lerobot")
    data = touched(folder / "data", cases=CASES)
    for case in data.cases():
        for frame in data.frames(case):
            sample = data.sample(case, frame)
            pose = sample.pose + np.r_[0.0, 0.0, -sample.depth_mm, 0.0, 0.0, 0.0, 0.0]
            data.path(case, frame).write_bytes(to_bytes(dataclasses.replace(sample, pose=pose)))
    words = ["dataset", "export", str(data.folder), "--lerobot", str(folder / "out")]
    assert main(words) == 0
    return data, folder / "out"


def all_samples(data: DataSet) -> list[Sample]:
    """In the order of the episodes."""
    return [data.sample(case, f) for case in whole_cases(data) for f in range(case.frames)]


def table(root: Path, name: str) -> dict[str, list]:
    return parquet.read_table(root / name).to_pydict()


def test_frames_are_those_of_the_data_set(made: tuple[DataSet, Path]) -> None:
    """Forces, poses, and as actions the next poses; indices as the format counts them."""
    data, root = made
    samples = all_samples(data)
    frames = table(root, "data/chunk-000/file-000.parquet")
    poses = np.array([sample.pose for sample in samples])
    assert np.array(frames["observation.contact_pose"]) == pytest.approx(poses, abs=1e-5)
    skin = data.skin.points_mm
    wrenches = np.array([wrench(sample, skin) for sample in samples])
    assert np.array(frames["observation.force"]) == pytest.approx(wrenches, abs=1e-6)
    last = np.array(frames["frame_index"]) == 1
    following = np.where(last[:, None], poses, np.roll(poses, -1, axis=0))
    assert np.array(frames["action"]) == pytest.approx(following, abs=1e-5)
    assert frames["index"] == list(range(2 * CASES))
    assert frames["frame_index"] == [0, 1] * CASES
    assert frames["episode_index"] == [number for number in range(CASES) for _ in range(2)]
    assert frames["timestamp"] == pytest.approx([0.0, 0.1] * CASES)


def test_films_show_each_image_without_loss(made: tuple[DataSet, Path]) -> None:
    """Decoded by FFmpeg: equal to the last bit, at k / fps, every second a key frame."""
    data, root = made
    with av.open(str(root / f"videos/{KEY}/chunk-000/file-000.mp4")) as file:
        assert file.streams.video[0].average_rate == 10
        frames = list(file.decode(video=0))
    images = [frame.to_ndarray(format="rgb24") for frame in frames]
    assert np.array_equal(images, [sample.image for sample in all_samples(data)])
    assert [frame.time for frame in frames] == pytest.approx(np.arange(2 * CASES) / 10)
    assert all(frame.key_frame for frame in frames[::2])


def test_info_tells_what_is_there(made: tuple[DataSet, Path]) -> None:
    """Totals, episodes by split, patterns of paths that lead to files, shapes of features."""
    data, root = made
    info = json.loads((root / "meta/info.json").read_text())
    assert (info["codebase_version"], info["fps"]) == ("v3.0", 10)
    assert (info["total_episodes"], info["total_frames"]) == (CASES, 2 * CASES)
    assert (root / info["data_path"].format(chunk_index=0, file_index=0)).exists()
    order = [case.split.value for case in whole_cases(data)]
    for split, episodes in info["splits"].items():
        first, last = map(int, episodes.split(":"))
        assert set(order[first:last]) == {split}
    assert sum(len(range(*map(int, e.split(":")))) for e in info["splits"].values()) == CASES
    assert info["features"][KEY]["shape"] == [HEIGHT, WIDTH, 3]
    columns = parquet.read_schema(root / "data/chunk-000/file-000.parquet")
    assert set(columns.names) == set(info["features"]) - {KEY}
    for name in columns.names:
        kind = info["features"][name]
        assert columns.field(name).type in (kind["dtype"], *_lists(kind)), name


def _lists(kind: dict) -> list[object]:
    import pyarrow as pa

    return [pa.list_(pa.float32(), kind["shape"][0])] + [pa.float32()] * (
        kind["dtype"] == "float32"
    )


def test_episodes_say_where_their_frames_are(made: tuple[DataSet, Path]) -> None:
    """Rows, seconds of the film and statistics of each; tasks are the names of pandas' rows."""
    data, root = made
    episodes = table(root, "meta/episodes/chunk-000/file-000.parquet")
    assert episodes["dataset_from_index"] == list(range(0, 2 * CASES, 2))
    assert episodes["dataset_to_index"] == list(range(2, 2 * CASES + 1, 2))
    assert episodes[f"videos/{KEY}/from_timestamp"] == pytest.approx(np.arange(CASES) / 5)
    assert episodes[f"videos/{KEY}/to_timestamp"] == pytest.approx(np.arange(1, CASES + 1) / 5)
    first = np.stack([sample.image for sample in all_samples(data)[:2]]) / 255.0
    means = episodes[f"stats/{KEY}/mean"][0]
    assert np.ravel(means) == pytest.approx(first.mean(axis=(0, 1, 2)))
    tasks = parquet.read_table(root / "meta/tasks.parquet")
    told = json.loads(tasks.schema.metadata[b"pandas"])
    names = tasks.column(told["index_columns"][0]).to_pylist()
    assert [
        names[k] for k in table(root, "data/chunk-000/file-000.parquet")["task_index"][::2]
    ] == [task for (task,) in episodes["tasks"]]


def test_statistics_are_those_of_all_pixels_and_numbers() -> None:
    """Of random images and numbers, beside NumPy's own."""
    rng = np.random.default_rng(1)
    images = rng.integers(3, 250, (4, 9, 7, 3)).astype(np.uint8)
    found = statistics.of_histogram(sum(map(statistics.histogram, images)), 4)
    scaled = images.reshape(-1, 3) / 255.0
    for name, value in {
        "min": scaled.min(axis=0),
        "max": scaled.max(axis=0),
        "mean": scaled.mean(axis=0),
        "std": scaled.std(axis=0),
        **{
            name: np.quantile(scaled, share, axis=0, method="inverted_cdf")
            for name, share in statistics.QUANTILES.items()
        },
    }.items():
        assert found[name].shape == (3, 1, 1)
        assert found[name].ravel() == pytest.approx(value, abs=1e-9), name
    numbers = rng.normal(size=(11, 6))
    assert statistics.of_values(numbers)["q90"] == pytest.approx(np.quantile(numbers, 0.9, axis=0))


def test_the_torque_is_about_the_objects_origin() -> None:
    """Two forces of 1 N at arms of 2 mm on either side: a couple of 4 N mm, no force."""
    from tests.synthetic_presses import IndenterKind
    from workbench.learning.dataset.sample import Solved

    force = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, 0.0, 0.0]], np.float32)
    moved = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [5.0, 5.0, 5.0]], np.float32)
    solved = Solved(
        displacement_mm=moved,
        contact_force_N=force,
        sliding=np.zeros(3, bool),
        reaction_N=-force.sum(axis=0),
        tangential_N=0.0,
        residual=0.0,
        balance=0.0,
        converged=True,
        seconds=0.0,
    )
    sample = Sample(
        case="",
        frame=0,
        recipe="",
        indenter=IndenterKind.SPHERE.value,
        depth_mm=0.1,
        shear_mm=(0.0, 0.0),
        pose=np.array([10.0, 0.0, 3.0, 1.0, 0.0, 0.0, 0.0]),
        target_mm=np.zeros(3),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        mpm=solved,
    )
    skin = np.array([[11.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    # The skin pushes the object down at x = 12 and up at x = 8: it turns about +y.
    assert wrench(sample, skin) == pytest.approx([0.0, 0.0, 0.0, 0.0, 4.0, 0.0])


def test_a_full_film_is_followed_by_another(
    made: tuple[DataSet, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of no size at all, each episode has a film of its own."""
    data, _ = made
    monkeypatch.setattr(film, "VIDEO_MB", 0.0)
    export_lerobot(data, tmp_path / "out", silent, marked=True)
    assert len(list((tmp_path / f"out/videos/{KEY}/chunk-000").iterdir())) == CASES
    episodes = table(tmp_path / "out", "meta/episodes/chunk-000/file-000.parquet")
    assert episodes[f"videos/{KEY}/file_index"] == list(range(CASES))
    assert episodes[f"videos/{KEY}/from_timestamp"] == [0.0] * CASES


def test_what_cannot_be_written_is_refused(
    made: tuple[DataSet, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A folder with something in it, a case without its last frame, no package."""
    data, root = made
    with pytest.raises(DesignError, match="is not empty"):
        export_lerobot(data, root, silent)
    part = touched(tmp_path / "part", cases=2)
    part.path(part.all_cases[0], 1).unlink()
    assert export_lerobot(part, tmp_path / "one", silent).left_out == 1
    part.path(part.all_cases[1], 1).unlink()
    with pytest.raises(DesignError, match="none of the 2 cases"):
        export_lerobot(part, tmp_path / "none", silent)
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(PackageError, match="package av"):
        export_lerobot(data, tmp_path / "without", silent)


@pytest.mark.slow
@pytest.mark.skipif("LEROBOT_PYTHON" not in os.environ, reason="LEROBOT_PYTHON names no Python")
def test_lerobots_own_reader_finds_what_was_written(
    made: tuple[DataSet, Path], tmp_path: Path
) -> None:
    """Images to the last bit, numbers in single precision, tasks, statistics and a look ahead."""
    data, root = made
    done = subprocess.run(
        [os.environ["LEROBOT_PYTHON"], lerobot_reader.__file__, str(root), str(tmp_path / "seen")],
        env={**os.environ, "HF_HUB_OFFLINE": "1", "HF_HOME": str(tmp_path / "hub")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout.splitlines()[-1])
    samples = all_samples(data)
    images = np.stack([sample.image for sample in samples])
    assert np.array_equal(np.load(tmp_path / "seen.npy"), images)
    poses = np.array([sample.pose for sample in samples])
    wrenches = [wrench(sample, data.skin.points_mm) for sample in samples]
    assert np.array(told["observation.force"]) == pytest.approx(np.array(wrenches), abs=1e-6)
    assert np.array(told["observation.contact_pose"]) == pytest.approx(poses, abs=1e-5)
    assert np.array(told["ahead"][0]) == pytest.approx(poses[1], abs=1e-5)
    assert (told["episodes"], told["fps"], len(told["tasks"])) == (CASES, 10, 2 * CASES)
    assert told["tasks"][0] == f"press the object {samples[0].indenter} on the skin"
    assert told["mean"] == pytest.approx(images.mean(axis=(0, 1, 2)) / 255.0)
