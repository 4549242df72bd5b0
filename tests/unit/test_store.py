"""The store: whole or absent, first writer wins, full disks leave nothing behind."""

from __future__ import annotations

import errno
import json
import os
import socket
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from workbench.core.base.errors import DamagedError, StoreError
from workbench.core.design.design import SensorDesign
from workbench.core.design.lighting import LightModel
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import Bundle, Picture
from workbench.core.result.sensing import Metrics, Shot, TactileFrames
from workbench.pipeline.store import DAMAGED, Store
from workbench.pipeline.write_once import META
from workbench.planning.plan import InlineRunner, evaluate, plan
from workbench.system.unfinished import fresh_name, is_left_behind


def drawing(value: int = 1) -> Picture:
    return Picture(png=np.full(8, value, np.uint8))


def test_round_trip_keeps_values_types_and_nesting(tmp_path: Path) -> None:
    """load(save(x)) == x, arrays mapped from disk."""
    frames = TactileFrames(
        rgb=np.zeros((1, 2, 2, 3), np.uint8),
        depth_z_mm=np.ones((1, 2, 2), np.float32),
        normal=np.zeros((1, 2, 2, 3), np.float16),
        moved=np.zeros((1, 2, 2), bool),
        marker_uv_px=np.zeros((1, 0, 2), np.float32),
        exposure=0.5,
    )
    shot = Shot(frames=frames, metrics=Metrics(values={"peak_N": 1.25}))
    store = Store(tmp_path)
    store.save("shoot", "k", shot, seconds=1.5, version=1)
    loaded = store.load("shoot", "k")
    assert loaded.metrics == shot.metrics
    assert loaded.frames.exposure == 0.5
    assert isinstance(loaded.frames.rgb, np.memmap)
    np.testing.assert_array_equal(loaded.frames.depth_z_mm, frames.depth_z_mm)
    assert store.entry("shoot", "k").seconds == 1.5


def test_round_trip_of_designs_and_file_bundles(tmp_path: Path) -> None:
    """Enumerations, mappings and names with dots survive."""
    store = Store(tmp_path)
    design = SensorDesign(shape={"tip_ratio": 1.2}).replace("optics.light_model", LightModel.LINEAR)
    store.save("a", "k", design, seconds=0.0, version=1)
    assert store.load("a", "k") == design
    store.save(
        "b", "k", Bundle(files={"x.stl": np.arange(3, dtype=np.uint8)}), seconds=0, version=1
    )
    assert store.load("b", "k").files["x.stl"].tobytes() == b"\0\1\2"


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int32, np.uint8, bool])
def test_mostly_zeros_come_back_bit_for_bit_from_less_disk(
    tmp_path: Path, dtype: type[np.generic]
) -> None:
    """Every entry and the type, from an eighth of the size at most."""
    rng = np.random.default_rng(3)
    array = np.zeros((20, 30_000, 2), dtype)
    array[:, rng.integers(0, 30_000, 300)] = 1
    store = Store(tmp_path)
    store.save("s", "k", Picture(png=array), seconds=0.0, version=1)
    loaded = store.load("s", "k").png
    assert loaded.dtype == array.dtype
    np.testing.assert_array_equal(loaded, array)
    assert not loaded.flags.writeable
    on_disk = sum(path.stat().st_size for path in store.path("s", "k").glob("*.npy"))
    # One bit an entry is an eighth of a byte; the entries themselves are a hundredth.
    assert on_disk < (0.2 if array.itemsize == 1 else 0.1) * array.nbytes
    assert store.entry("s", "k").bytes == pytest.approx(on_disk, rel=0.01)


def test_minus_zero_and_nan_survive_packing(tmp_path: Path) -> None:
    """The bits of -0.0 and NaN are those that were stored."""
    array = np.zeros(600_000, np.float32)
    array[7], array[9] = -0.0, np.nan
    store = Store(tmp_path)
    store.save("s", "k", Picture(png=array), seconds=0.0, version=1)
    np.testing.assert_array_equal(store.load("s", "k").png.view(np.uint32), array.view(np.uint32))


def test_dense_arrays_and_results_from_before_are_mapped(tmp_path: Path) -> None:
    """A full array is a plain file; a meta.json without `packed` is read as ever."""
    store = Store(tmp_path)
    array = np.ones((2, 400_000), np.float32)
    store.save("s", "k", Picture(png=array), seconds=0.0, version=1)
    path = store.path("s", "k") / META
    meta = json.loads(path.read_text())
    assert meta.pop("packed") == {}
    path.write_text(json.dumps(meta))
    loaded = store.load("s", "k").png
    assert isinstance(loaded, np.memmap)
    np.testing.assert_array_equal(loaded, array)


def test_damaged_packing_is_a_store_error(tmp_path: Path) -> None:
    """Values that do not fit their places are found out."""
    store = Store(tmp_path)
    store.save("s", "k", Picture(png=np.zeros(600_000, np.float32)), seconds=0.0, version=1)
    np.save(store.path("s", "k") / "value.png.values.npy", np.ones(3, np.float32))
    with pytest.raises(StoreError, match="damaged"):
        store.load("s", "k")


def test_first_writer_wins(tmp_path: Path) -> None:
    """A second save of the same key changes nothing and raises nothing."""
    store = Store(tmp_path)
    store.save("s", "k", drawing(1), seconds=0.0, version=1)
    store.save("s", "k", drawing(2), seconds=0.0, version=1)
    assert store.load("s", "k").png[0] == 1
    assert [p.name for p in (tmp_path / "s").iterdir()] == ["k"]


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS, errno.EACCES])
def test_failed_write_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    """A full or read-only disk is a StoreError (exit 3); earlier results stay readable."""
    store = Store(tmp_path)
    store.save("s", "old", drawing(), seconds=0.0, version=1)

    def full(*args: object, **keywords: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(np, "save", full)
    with pytest.raises(StoreError) as caught:
        store.save("s", "new", drawing(), seconds=0.0, version=1)
    assert caught.value.exit_code == 3
    assert caught.value.hint
    assert not store.has("s", "new")
    assert [p.name for p in (tmp_path / "s").iterdir()] == ["old"]
    assert store.load("s", "old").png.size == 8


def test_an_array_written_in_part_is_a_full_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """NumPy's error has no number; the designer is told of the space, not of permissions."""

    def short(*args: object, **keywords: object) -> None:
        raise OSError("8640 requested and 3040 written")

    monkeypatch.setattr(np, "save", short)
    with pytest.raises(StoreError, match="is full") as caught:
        Store(tmp_path).save("s", "new", drawing(), seconds=0.0, version=1)
    assert "free some space" in str(caught.value.hint)


def test_really_full_disk(tmp_path: Path) -> None:
    """A 1 MB file system of its own runs full: one clear StoreError, the old result intact."""
    import subprocess

    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(disk)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("needs the right to mount a small file system")
    try:
        store = Store(disk)
        store.save("s", "small", drawing(), seconds=0.0, version=1)
        with pytest.raises(StoreError, match="full"):
            store.save("s", "big", Picture(png=np.ones(2**22, np.uint8)), seconds=0, version=1)
        assert store.load("s", "small").png.size == 8
        assert not store.has("s", "big")
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_half_written_result_is_never_read(tmp_path: Path) -> None:
    """A folder without its meta file, as a killed writer leaves it, counts as absent."""
    store = Store(tmp_path)
    part = tmp_path / "s" / ".part-999999999-x"
    part.mkdir(parents=True)
    (part / "value.png.npy").write_bytes(b"half")
    assert not store.has("s", ".part-999999999-x")
    assert store.sweep() == 1
    assert not part.exists()


def test_part_of_a_living_writer_is_kept(tmp_path: Path) -> None:
    """Sweeping does not disturb a process that is writing."""
    part = tmp_path / "s" / f".part-{os.getpid()}-x"
    part.mkdir(parents=True)
    assert Store(tmp_path).sweep() == 0
    assert part.exists()


def test_part_of_another_host_is_kept_for_a_day(tmp_path: Path) -> None:
    """Its processes cannot be asked from here: only what has long stood still is swept."""
    numbers = (99_999_999, os.getpid())
    parts = [tmp_path / "s" / f".part-{pid}@elsewhere-2.lab-x" for pid in numbers]
    for part in parts:
        part.mkdir(parents=True)
    assert Store(tmp_path).sweep() == 0
    long_ago = time.time() - 25 * 3600.0
    os.utime(parts[0], (long_ago, long_ago))
    assert Store(tmp_path).sweep() == 1
    assert not parts[0].exists() and parts[1].exists()


def test_a_name_of_this_process_is_not_left_behind_and_says_where_it_runs(tmp_path: Path) -> None:
    """Two names differ; the host stands in them, so that others do not ask here for the process."""
    names = {fresh_name(), fresh_name()}
    assert len(names) == 2
    for name in names:
        assert f"-{os.getpid()}@{socket.gethostname()}-" in name
        (tmp_path / name).touch()
        assert not is_left_behind(tmp_path / name)


def cut_short(folder: Path) -> None:
    """An array of which half is there."""
    path = folder / "value.png.npy"
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def without_header(folder: Path) -> None:
    """An array that lost its first bytes."""
    path = folder / "value.png.npy"
    path.write_bytes(b"\0" * 16 + path.read_bytes()[16:])


def gone(folder: Path) -> None:
    """An array that somebody deleted."""
    (folder / "value.png.npy").unlink()


def garbled(folder: Path) -> None:
    """A description that is no JSON."""
    (folder / META).write_bytes(b"{garbage")


def emptied(folder: Path) -> None:
    """A description without content, as power loss leaves it."""
    (folder / META).write_bytes(b"")


def nothing_said(folder: Path) -> None:
    """A description that is JSON, and says nothing."""
    (folder / META).write_text("null")


def no_size(folder: Path) -> None:
    """A description with a word where the size belongs."""
    meta = json.loads((folder / META).read_text())
    (folder / META).write_text(json.dumps({**meta, "bytes": "many"}))


HARMS = [cut_short, without_header, gone, garbled, emptied, nothing_said, no_size]


@pytest.mark.parametrize("harm", HARMS)
def test_a_sweep_passes_by_what_is_damaged(harm: Callable[[Path], None], tmp_path: Path) -> None:
    """It is for whoever asks for the result to find; what was set aside is kept, the newest ten."""
    store = Store(tmp_path)
    store.on_message = lambda text: None
    store.save("s", "k", drawing(), seconds=0.0, version=1)
    harm(store.path("s", "k"))
    assert store.sweep() == 0
    for number in range(12):
        store.save("s", f"k{number}", drawing(), seconds=0.0, version=1)
        harm(store.path("s", f"k{number}"))
        assert not store.has("s", f"k{number}")
    assert store.sweep() == 2
    assert len(list((tmp_path / "damaged").iterdir())) == 10


@pytest.mark.parametrize("tree", [{"map": [1]}, {"class": "Picture", "fields": []}])
def test_a_description_of_something_else_is_set_aside(tree: object, tmp_path: Path) -> None:
    """Whole arrays under a tree that no result has."""
    store = Store(tmp_path)
    store.on_message = lambda text: None
    store.save("s", "k", drawing(), seconds=0.0, version=1)
    meta = json.loads((store.path("s", "k") / META).read_text())
    (store.path("s", "k") / META).write_text(json.dumps({**meta, "tree": tree}))
    with pytest.raises(DamagedError):
        store.load("s", "k")
    assert not store.has("s", "k")


@pytest.mark.parametrize("harm", HARMS)
@pytest.mark.parametrize("known", [False, True], ids=["other-process", "same-process"])
def test_a_damaged_result_is_set_aside_once(
    harm: Callable[[Path], None], known: bool, tmp_path: Path
) -> None:
    """It is not there any more, is said once, is kept for the curious, and is computed again."""
    store, told = Store(tmp_path), []
    store.on_message = told.append
    store.save("s", "k", drawing(), seconds=0.0, version=1)
    if known:
        assert store.has("s", "k")
    harm(store.path("s", "k"))
    if known:
        with pytest.raises(DamagedError):
            store.load("s", "k")
    assert not store.has("s", "k")
    assert not store.has("s", "k")
    assert len(told) == 1
    assert "s/k was damaged" in told[0]
    assert len(list((tmp_path / DAMAGED).iterdir())) == 1
    store.save("s", "k", drawing(), seconds=0.0, version=1)
    np.testing.assert_array_equal(store.load("s", "k").png, drawing().png)


def test_a_result_that_the_system_denies_is_not_damaged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Too many open files: said, and the result stays where it is."""
    store = Store(tmp_path)
    store.save("s", "k", drawing(), seconds=0.0, version=1)

    def refuse(*_: object, **__: object) -> None:
        raise OSError(errno.EMFILE, "Too many open files")

    with monkeypatch.context() as patch:
        patch.setattr(np, "load", refuse)
        with pytest.raises(StoreError, match="Too many open files") as caught:
            store.load("s", "k")
    assert not isinstance(caught.value, DamagedError)
    assert store.has("s", "k")


def test_a_chain_computes_what_is_damaged_again(tmp_path: Path) -> None:
    """Body and mesh are torn: a run that wants the mesh makes both anew, and one notice each."""
    design = SensorDesign(shape={"outer_radius_mm": 8.0, "cylinder_mm": 8.0})
    store, told = Store(tmp_path), []
    store.on_message = told.append
    runner, case = InlineRunner(store), PressCase()
    for _ in evaluate(design, case, runner, wanted=("mesh",)):
        pass
    calls = plan(design, case)
    build = store.path("build", calls["build"].key)
    (build / "value.membrane.points_mm.npy").write_bytes(b"torn")
    mesh = store.path("mesh", calls["mesh"].key)
    (mesh / META).write_bytes(b"torn")
    done = [o.stage for o in evaluate(design, case, runner, wanted=("mesh",)) if not o.cached]
    assert done == ["build", "mesh"]
    assert len(told) == 2


def test_damage_found_while_a_stage_reads_is_healed_too(tmp_path: Path) -> None:
    """The body is torn after it was looked into: the mesh fails, the body is built, the mesh is."""
    design = SensorDesign(shape={"outer_radius_mm": 8.0, "cylinder_mm": 8.0})
    store = Store(tmp_path)
    store.on_message = lambda text: None
    runner, case = InlineRunner(store), PressCase()
    (built,) = evaluate(design, case, runner, wanted=("build",))
    assert store.has("build", built.key)
    torn = store.path("build", built.key) / "value.membrane.points_mm.npy"
    torn.write_bytes(b"torn")
    outcomes = list(evaluate(design, case, runner, wanted=("mesh",)))
    assert [o.stage for o in outcomes] == ["build", "build", "mesh"]
    assert [o.cached for o in outcomes] == [True, False, False]


def test_sweep_removes_the_least_recently_used(tmp_path: Path) -> None:
    """Beyond the size limit the oldest result goes, the newer one stays."""
    store = Store(tmp_path, limit_bytes=10)
    for i, key in enumerate(("old", "new")):
        store.save("s", key, drawing(), seconds=0.0, version=1)
        os.utime(store.path("s", key) / META, (1000 + i, 1000 + i))
    assert store.sweep() == 1
    assert store.has("s", "new")
    assert not store.has("s", "old")


def test_interrupted_eviction_never_blocks_a_key(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An eviction whose removal is interrupted leaves the key free for the next save."""
    store = Store(tmp_path, limit_bytes=1)
    store.save("s", "k", drawing(1), seconds=0.0, version=1)
    with monkeypatch.context() as patch:
        patch.setattr("shutil.rmtree", lambda *args, **keywords: None)
        store.sweep()
    assert not store.path("s", "k").exists()
    store.save("s", "k", drawing(2), seconds=0.0, version=1)
    assert store.load("s", "k").png[0] == 2


def test_husk_without_meta_is_replaced(tmp_path: Path) -> None:
    """A folder that lost its meta file does not keep its key from being stored again."""
    store = Store(tmp_path)
    store.save("s", "k", drawing(1), seconds=0.0, version=1)
    (store.path("s", "k") / META).unlink()
    store.save("s", "k", drawing(2), seconds=0.0, version=1)
    assert store.load("s", "k").png[0] == 2
    assert [p.name for p in (tmp_path / "s").iterdir()] == ["k"]


def test_result_that_cannot_be_evicted_stops_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A sweep that may not rename removes 0 results and raises nothing."""
    store = Store(tmp_path, limit_bytes=1)
    store.save("s", "k", drawing(), seconds=0.0, version=1)

    def refused(self: Path, target: Path) -> None:
        raise PermissionError(errno.EACCES, "refused")

    monkeypatch.setattr(Path, "rename", refused)
    assert store.sweep() == 0
    assert store.has("s", "k")
