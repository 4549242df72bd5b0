"""A data set on disk: what is read is what was written, and what is damaged is refused."""

from __future__ import annotations

import dataclasses
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.unit.test_dataset_cases import flat_skin
from workbench.core.base.errors import SolveError, StoreError
from workbench.core.press.fem import DRAFT_MM
from workbench.learning.dataset.agreement import agreement
from workbench.learning.dataset.begin import begin
from workbench.learning.dataset.card import card_text
from workbench.learning.dataset.cases import Split, cases_of
from workbench.learning.dataset.estimate import estimate, estimate_text
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.json_lines import append_row, read_rows
from workbench.learning.dataset.lock import held
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.recipes import load_recipe, recipe_from_toml
from workbench.learning.dataset.repair import repair
from workbench.learning.dataset.sample import Sample, Solved, from_bytes, to_bytes
from workbench.learning.making.collect import finish
from workbench.learning.making.solving import Report
from workbench.learning.making.watch import SetProgress, Watch
from workbench.report.image_files import png_bytes
from workbench.system.lock_file import LOCK
from workbench.system.whole_files import write_atomically

SKIN = flat_skin(5.0, 0.5)
VERTICES = len(SKIN.points_mm)


def recipe(cases: int = 6) -> Recipe:
    """A press and a shear of a few cases, on the draft mesh."""
    return dataclasses.replace(load_recipe("small"), cases=cases, hex_mm=DRAFT_MM)


def started(folder: Path, cases: int = 6) -> DataSet:
    """An empty data set on a flat skin."""
    plan = recipe(cases)
    return begin(folder, plan.table, SKIN, cases_of(plan))


def solved(rng: np.random.Generator, *, stress: bool) -> Solved:
    """A state in which a tenth of the skin moved."""
    moved = rng.random(VERTICES) < 0.1
    shown = moved[:, None].astype(np.float32)
    stress_MPa = shown * rng.normal(size=(VERTICES, 6)).astype(np.float32)
    return Solved(
        displacement_mm=shown * rng.normal(size=(VERTICES, 3)).astype(np.float32),
        contact_force_N=shown * rng.normal(size=(VERTICES, 3)).astype(np.float32),
        sliding=moved & (rng.random(VERTICES) < 0.5),
        reaction_N=rng.normal(size=3),
        tangential_N=0.25,
        residual=1e-7,
        balance=1e-8,
        converged=True,
        seconds=0.5,
        **({"cauchy_MPa": stress_MPa} if stress else {}),
    )


def a_sample(data: DataSet, number: int = 0, frame: int = 0) -> Sample:
    """A made-up sample of a case."""
    case, rng = data.all_cases[number], np.random.default_rng([number, frame])
    pixels = rng.integers(0, 256, (6, 8, 3), dtype=np.uint8)
    return Sample(
        case=case.id,
        frame=frame,
        recipe=data.key,
        indenter=case.indenter.value,
        depth_mm=case.depth_at(frame),
        shear_mm=case.shear_at(frame),
        pose=rng.normal(size=7),
        target_mm=np.zeros(3),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        mpm=solved(rng, stress=False),
        fem=solved(rng, stress=True),
        png=png_bytes(pixels),
        png_markers=png_bytes(255 - pixels),
    )


def write(data: DataSet, number: int = 0, frame: int = 0) -> Path:
    """Write a made-up sample into a data set."""
    path = data.path(data.all_cases[number], frame)
    write_atomically(path, to_bytes(a_sample(data, number, frame)))
    return path


def test_what_is_read_is_what_was_written(tmp_path: Path) -> None:
    """Fields bit by bit, images pixel by pixel, skin areas sum to 10 x 10 mm2."""
    data = started(tmp_path)
    write(data, 2, 11)
    again = DataSet.open(tmp_path)
    case, found = next(again.samples())
    assert (case.id, found.frame) == (data.all_cases[2].id, 11)
    expected = a_sample(data, 2, 11)
    for of in ("mpm", "fem"):
        for item in dataclasses.fields(Solved):
            mine = getattr(getattr(expected, of), item.name)
            assert np.array_equal(getattr(getattr(found, of), item.name), mine), item.name
    assert np.array_equal(found.pose, expected.pose)
    assert np.array_equal(found.image, 255 - found.image_markers)
    assert np.isclose(again.skin.areas_mm2.sum(), 100.0)
    assert np.array_equal(again.skin.points_mm, SKIN.points_mm)
    assert again.all_cases == data.all_cases


def test_vertices_at_rest_are_not_stored(tmp_path: Path) -> None:
    """A tenth of the rows is moved, so the file is about a tenth of the dense fields."""
    data = started(tmp_path)
    with np.load(write(data)) as file:
        rows = len(file["fem.index"])
        assert file["fem.displacement_mm"].shape == (rows, 3)
        assert file["fem.cauchy_MPa"].dtype == np.float32
    fem = a_sample(data).fem
    assert fem is not None and rows == np.count_nonzero(fem.displacement_mm.any(axis=1))


def test_a_field_that_is_not_finite_is_never_written(tmp_path: Path) -> None:
    """NaN in a force, or in a residual, is an error of the solver and leaves no file."""
    sample = a_sample(started(tmp_path))
    assert sample.fem is not None
    force = sample.fem.contact_force_N.copy()
    force[7, 1] = np.nan
    bad = dataclasses.replace(sample.fem, contact_force_N=force)
    with pytest.raises(SolveError, match=r"fem\.contact_force_N of frame 1"):
        to_bytes(dataclasses.replace(sample, fem=bad))
    bad = dataclasses.replace(sample.fem, displacement_mm=np.full_like(force, np.nan))
    with pytest.raises(SolveError, match=r"fem\.displacement_mm"):
        to_bytes(dataclasses.replace(sample, fem=bad))
    bad = dataclasses.replace(sample.fem, residual=float("nan"))
    with pytest.raises(SolveError, match=r"fem\.residual"):
        to_bytes(dataclasses.replace(sample, fem=bad))


def damage(path: Path, how: str) -> None:
    """Spoil a sample's file."""
    content = path.read_bytes()
    if how == "truncated":
        path.write_bytes(content[: len(content) // 2])
    elif how == "empty":
        path.write_bytes(b"")
    elif how == "a bit":
        # In the middle of an array, which the checksum of its entry covers.
        place = content.index(b"fem.cauchy_MPa") + 400
        flipped = bytes([content[place] ^ 4])
        path.write_bytes(content[:place] + flipped + content[place + 1 :])
    elif how == "not finite":
        with np.load(path) as file:
            arrays = {name: file[name].copy() for name in file.files}
        arrays["mpm.displacement_mm"][0, 0] = np.inf
        np.savez(path, **arrays)


@pytest.mark.parametrize("how", ["truncated", "empty", "a bit", "not finite"])
def test_damaged_samples_are_refused_and_repaired(tmp_path: Path, how: str) -> None:
    """The file is named with what to do; repair drops it and no other."""
    data = started(tmp_path)
    kept, spoilt = write(data, 0, 0), write(data, 0, 1)
    damage(spoilt, how)
    with pytest.raises(StoreError, match="cannot be used") as caught:
        list(data.samples())
    assert str(spoilt) in caught.value.message
    assert "dataset repair" in caught.value.hint
    ((dropped, reason),) = repair(tmp_path)
    assert dropped == spoilt and not spoilt.exists() and kept.exists() and reason
    assert len(list(data.samples())) == 1


def test_a_sample_of_another_data_set_is_refused(tmp_path: Path) -> None:
    """Of another recipe, of another case, and of another skin."""
    data = started(tmp_path / "a")
    stranger = dataclasses.replace(a_sample(data), recipe="0" * 32)
    path = data.path(data.all_cases[0], 0)
    write_atomically(path, to_bytes(stranger))
    with pytest.raises(StoreError, match="another recipe"):
        data.sample(data.all_cases[0], 0)
    write_atomically(path, to_bytes(a_sample(data, 1, 4)))
    with pytest.raises(StoreError, match="it is frame 4 of triangle"):
        data.sample(data.all_cases[0], 0)
    with pytest.raises(ValueError, match="this data set's 12"):
        from_bytes(to_bytes(a_sample(data)), 12)


def test_foreign_folders_are_refused(tmp_path: Path) -> None:
    """No data set, another format, an edited recipe, another skin: each says what to do."""
    with pytest.raises(StoreError, match="there is no data set"):
        DataSet.open(tmp_path)
    started(tmp_path)
    path = tmp_path / "manifest.json"
    good = json.loads(path.read_text())

    def refused(manifest: object, words: str) -> None:
        path.write_text(json.dumps(manifest))
        with pytest.raises(StoreError, match=words) as caught:
            DataSet.open(tmp_path)
        assert caught.value.hint

    refused({**good, "format": 99}, "has format 99")
    refused({**good, "recipe": {**good["recipe"], "depth_mm": 2.0}}, "not the one it was begun")
    refused({**good, "mesh": "0" * 32}, "not the skin that the manifest names")
    refused({"program": "1.0"}, "cannot be read")
    refused([], "cannot be read")
    path.write_text(json.dumps(good)[:40])
    with pytest.raises(StoreError, match="damaged"):
        DataSet.open(tmp_path)
    path.write_text(json.dumps(good))
    cases = (tmp_path / "cases.jsonl").read_text()
    (tmp_path / "cases.jsonl").write_text(cases.replace("train", "holiday"))
    with pytest.raises(StoreError, match=r"cases\.jsonl cannot be read: .*holiday"):
        DataSet.open(tmp_path)
    (tmp_path / "cases.jsonl").write_text(cases)
    (tmp_path / "skin.npz").write_bytes((tmp_path / "skin.npz").read_bytes()[:500])
    with pytest.raises(StoreError, match=r"skin\.npz cannot be read"):
        DataSet.open(tmp_path)


def test_a_data_set_only_grows(tmp_path: Path) -> None:
    """More cases keep what is done; fewer forget none; another recipe or folder is refused."""
    write(started(tmp_path, 4), 1, 0)
    assert len(started(tmp_path, 9).all_cases) == 9
    again = started(tmp_path, 2)
    assert len(again.all_cases) == 9
    assert again.counts()["samples_done"] == 1
    other = dataclasses.replace(recipe(), seed=1)
    with pytest.raises(StoreError, match="another recipe"):
        begin(tmp_path, other.table, SKIN, cases_of(other))
    with pytest.raises(StoreError, match="the mesh of the data set"):
        begin(tmp_path, recipe().table, flat_skin(5.0, 0.25), cases_of(recipe()))
    path = tmp_path / "manifest.json"
    manifest = json.loads(path.read_text())
    manifest["stages"]["press"] -= 1
    path.write_text(json.dumps(manifest))
    with pytest.raises(StoreError, match=r"press \d+ then, \d+ now"):
        started(tmp_path)
    assert DataSet.open(tmp_path).counts()["samples_done"] == 1
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "letter.txt").write_text("keep me")
    with pytest.raises(StoreError, match="is not empty and holds no data set"):
        started(tmp_path / "full")


def test_splits_and_repeats_choose_samples(tmp_path: Path) -> None:
    """Cases of a split only; the approach of a pair's second shear counts once."""
    plan = dataclasses.replace(recipe(), indenters=recipe().indenters[:1], cases=86)
    data = begin(tmp_path, plan.table, SKIN, cases_of(plan))
    second = data.all_cases[85]
    assert second.first_new == 10
    for frame in (9, 10):
        write(data, 85, frame)
    assert [s.frame for _, s in data.samples()] == [10]
    assert [s.frame for _, s in data.samples(repeats=True)] == [9, 10]
    others = [split for split in Split if split is not second.split]
    assert not any(list(data.samples(split)) for split in others)
    counts = data.counts()
    assert (counts["samples_done"], counts["samples_distinct"]) == (2, 1)
    assert counts["samples_by_split"][second.split.value] == 2


WRITER = """
import sys
from pathlib import Path
from tests.unit.test_dataset_folder import DataSet, write
data = DataSet.open(Path(sys.argv[1]))
for number in range(len(data.all_cases)):
    for frame in range(data.all_cases[number].frames):
        write(data, number, frame)
"""


def test_a_killed_writer_leaves_whole_samples_only(tmp_path: Path) -> None:
    """SIGKILL among hundreds of writes: every file that has its name can be read."""
    data = started(tmp_path, 84)
    root = Path(__file__).parents[2]
    writer = subprocess.Popen([sys.executable, "-c", WRITER, str(tmp_path)], cwd=root)
    folder = tmp_path / "cases"
    until = time.monotonic() + 60.0
    while len(list(folder.glob("*/*.npz"))) < 12 and time.monotonic() < until:
        time.sleep(0.01)
    writer.send_signal(signal.SIGKILL)
    assert writer.wait() == -signal.SIGKILL
    found = list(data.samples(repeats=True))
    assert 12 <= len(found) < 84 * 15
    assert len(found) == len(list(folder.glob("*/*.npz")))
    assert repair(tmp_path) == []
    assert not list(folder.glob("*/.part-*"))


def test_a_second_process_is_refused(tmp_path: Path) -> None:
    """The lock names its holder; one of a process that has ended is taken over."""
    with held(tmp_path):
        with pytest.raises(StoreError, match=f"process {os.getpid()} is making"), held(tmp_path):
            pass
        assert (tmp_path / LOCK).exists()
    assert not (tmp_path / LOCK).exists()
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    host = os.uname().nodename
    (tmp_path / LOCK).write_text(json.dumps({"pid": gone.pid, "host": host}))
    with held(tmp_path):
        assert json.loads((tmp_path / LOCK).read_text())["pid"] == os.getpid()
    (tmp_path / LOCK).write_text(json.dumps({"pid": gone.pid, "host": "elsewhere"}))
    with pytest.raises(StoreError, match="on elsewhere"), held(tmp_path):
        pass
    assert not list(tmp_path.glob(".part-*"))


def test_failures_are_counted_and_told(tmp_path: Path) -> None:
    """A case that failed is in the file, the counts and the card, and its samples not awaited."""
    data = started(tmp_path, 3)
    told: list[SetProgress] = []
    watch = Watch(data, data.all_cases, {case.id: 0 for case in data.all_cases}, 0, told.append)
    for frame in range(4):
        write(data, 0, frame)
    error = {"error": "SolveError", "message": "frame 5 did not converge", "frame": 4}
    watch.ended(data.all_cases[0], Report(id=data.all_cases[0].id, written=4, error=error))
    for frame in range(15):
        write(data, 1, frame)
    report = Report(id=data.all_cases[1].id, written=15, mpm_s=3.0, fem_s=6.0, cpu_s=9.0)
    watch.ended(data.all_cases[1], report)
    watch.look(())
    assert told[-1].failed == 1
    assert (told[-1].done, told[-1].total) == (4 + 15, 4 + 15 + 15)
    finish(data)
    again = DataSet.open(tmp_path)
    counts = again.manifest["counts"]
    assert (counts["cases_failed"], counts["cases_done"], counts["samples_done"]) == (1, 1, 19)
    text = card_text(again)
    assert "frame 5 did not converge" in text and "1 failed" in text
    assert "Draft mesh" in text
    assert (tmp_path / "preview.png").exists()


def test_the_card_measures_how_far_the_solvers_are_apart(tmp_path: Path) -> None:
    """FEM moves 1 mm with 3 N, MPM .9 mm with 2 N: ratio 1.5, .1 mm apart, 10 % of the largest."""
    data = started(tmp_path)
    assert agreement(data) is None
    sample = a_sample(data)
    assert sample.mpm is not None and sample.fem is not None
    inward = np.zeros((VERTICES, 3), np.float32)
    inward[:20, 2] = -1.0
    inward[20, 0] = 0.05
    fem = dataclasses.replace(
        sample.fem, displacement_mm=inward, reaction_N=np.array([0.5, 0.0, 3.0])
    )
    mpm = dataclasses.replace(
        sample.mpm,
        displacement_mm=inward * np.float32(0.9),
        reaction_N=np.array([0.0, 0.0, 2.0]),
    )
    content = to_bytes(dataclasses.replace(sample, fem=fem, mpm=mpm))
    write_atomically(data.path(data.all_cases[0], 0), content)
    found = agreement(data)
    assert found is not None
    assert np.allclose(found.force_ratio, [1.5])
    # Kept in single precision.
    assert np.allclose(found.rms_mm, [0.1], atol=1e-6)
    finish(data)
    assert "1.50 times" in (tmp_path / "card.md").read_text()
    assert "10 % of the largest" in (tmp_path / "card.md").read_text()


def test_costs_are_measured_or_not_known() -> None:
    """9 core-seconds for 15 samples are .6 each: 9,980 samples take 1.6633 core-hours."""
    assert "nothing is known" in estimate_text(estimate([], 30))
    row = {"frames": 15, "mpm_s": 3.0, "fem_s": 5.0, "image_s": 1.0, "cpu_s": 9.0}
    row["seconds"] = 12.0
    found = estimate([row], 30, jobs=4)
    # 12 s a case of 15 samples, shared out to four processes.
    assert np.isclose(found["hours_left"], 30 * 0.8 / 3600 / 4)
    assert np.isclose(found["core_hours_paper"], 9980 * 0.6 / 3600)
    assert np.isclose(found["core_hours_left"], 30 * 0.6 / 3600)
    assert "1.7 core-hours" in estimate_text(found)


def test_rows_survive_a_line_cut_off(tmp_path: Path) -> None:
    """A torn last line is left out when read, and closed before the next is added."""
    path = tmp_path / "rows.jsonl"
    append_row(path, {"id": "a"})
    with path.open("a") as file:
        file.write('{"id": "b"')
    assert read_rows(path) == [{"id": "a"}]
    append_row(path, {"id": "c"})
    assert read_rows(path) == [{"id": "a"}, {"id": "c"}]
    path.write_text("nonsense\n")
    with pytest.raises(StoreError, match="a line that is not JSON"):
        read_rows(path)


def test_example_of_the_page_reads_a_data_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its loop comes to the sample of training, and its recipe is one."""
    text = (Path(__file__).parents[2] / "docs" / "data-sets.md").read_text()
    (code,) = re.findall(r"^```python\n([^`]*wb\.DataSet.*?)^```$", text, re.M | re.S)
    data = started(tmp_path / "sets" / "finger", 20)
    for number, case in enumerate(data.all_cases):
        if case.split is Split.TRAIN:
            write(data, number, 3)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(code, names)
    assert names["case"].split is Split.TRAIN
    assert [field.shape for field in names["fields"]] == [(VERTICES, 3)] * 3
    assert names["labels"][1] > 0.0
    (recipe_text,) = re.findall(r'^```toml\n(design = "trunk".*?)^```$', text, re.M | re.S)
    assert recipe_from_toml(recipe_text).points == 40
