"""The held-out set that ships: what is read is what was packed, and what is damaged is refused."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.synthetic_presses import made_up
from tests.unit.test_evaluation import untrained
from workbench.core.base.errors import StoreError
from workbench.learning.dataset.cases import Split
from workbench.learning.dataset.folder import DataSet
from workbench.learning.evaluation.evaluate import Named, evaluate_field
from workbench.learning.evaluation.held_out import PARTS, STEPS, HeldOut
from workbench.learning.evaluation.packing import chosen_states, made_from
from workbench.learning.evaluation.scoring import Way, compared
from workbench.learning.evaluation.sources import open_source, states


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> DataSet:
    return made_up(tmp_path_factory.mktemp("pad"), cases=20)


@pytest.fixture(scope="module")
def packed(data: DataSet, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("packed") / "heldout.npz"
    path.write_bytes(made_from(data, name="data"))
    return path


def test_fields_are_kept_to_a_step_of_their_largest(data: DataSet, packed: Path) -> None:
    """Rounding to 1/32767 of the largest moves a value by half of that, float32 a little more."""
    found = open_source(packed)
    assert isinstance(found, HeldOut)
    known = {case.id: case for case in data.cases()}
    assert found.key == data.key
    for case, frame in states(found):
        ours, theirs = found.sample(case, frame), data.sample(known[case.id], frame)
        assert case == known[case.id]
        for solver in ("mpm", "fem"):
            for part in PARTS:
                mine = getattr(getattr(ours, solver), part)
                true = getattr(getattr(theirs, solver), part)
                most = float(np.abs(true).max())
                assert np.abs(mine - true).max() <= 0.51 / STEPS * most
                assert np.abs(mine).max() == pytest.approx(most, rel=1e-6)
        assert np.array_equal(ours.normal, theirs.normal)
        assert (ours.depth_mm, ours.shear_mm) == (theirs.depth_mm, theirs.shear_mm)


def test_the_skin_is_the_same_to_the_bit(data: DataSet, packed: Path) -> None:
    """The network's voxels depend on it."""
    skin = HeldOut.open(packed).skin
    assert np.array_equal(skin.points_mm, data.skin.points_mm)
    assert np.array_equal(skin.faces, data.skin.faces)
    assert np.array_equal(skin.areas_mm2, data.skin.areas_mm2)
    assert np.allclose(skin.normals, data.skin.normals)


def test_it_holds_three_frames_of_each_held_out_case(data: DataSet, packed: Path) -> None:
    """Half depth, full depth, last of the shear; nothing of the training."""
    found = HeldOut.open(packed)
    assert not found.cases(Split.TRAIN) and not found.cases(Split.VALIDATION)
    for split in (Split.TEST, Split.UNSEEN):
        ids = [case.id for case in found.cases(split)]
        assert ids == [case.id for case in data.cases(split)]
    assert all(found.frames(case) == [0, 1, 3] for case in found.cases())
    assert len(states(found)) == len(chosen_states(states(data)))


def test_scores_are_those_of_the_data_set(data: DataSet, packed: Path) -> None:
    """On the same frames, to the rounding: 1.5e-5 of the peak, against errors of a hundredth."""
    named = Named(name="w", weights=untrained(data))
    small = compared(evaluate_field(open_source(packed), named, name="packed").samples)
    kept = {(case.id, frame) for case, frame in chosen_states(states(data))}
    rows = evaluate_field(data, named, name="data").samples
    full = compared([row for row in rows if (row.case.id, row.frame) in kept])
    for way in Way:
        assert small.ways[way].mae == pytest.approx(full.ways[way].mae, rel=1e-3)


def test_a_smaller_file_keeps_fewer_cases_of_every_kind(data: DataSet, tmp_path: Path) -> None:
    """Three quarters of the bytes; the first and the last case stay."""
    whole = made_from(data, name="data")
    content = made_from(data, most_bytes=3 * len(whole) // 4, name="data")
    assert len(content) <= 3 * len(whole) // 4
    path = tmp_path / "small.npz"
    path.write_bytes(content)
    ids = [case.id for case in HeldOut.open(path).cases()]
    every = list(dict.fromkeys(case.id for case, _ in states(data)))
    assert 1 < len(ids) < len(every)
    assert (ids[0], ids[-1]) == (every[0], every[-1])
    with pytest.raises(StoreError, match="one case takes"):
        made_from(data, most_bytes=100, name="data")


def rewritten(path: Path, place: Path, **changes: Any) -> Path:
    """The file with other entries in its head or among its arrays."""
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    head = json.loads(arrays.pop("head").tobytes())
    for name, value in changes.items():
        (arrays if name in arrays else head)[name] = value
    encoded = np.frombuffer(json.dumps(head).encode(), np.uint8)
    np.savez_compressed(place, allow_pickle=False, head=encoded, **arrays)
    return place


def test_a_damaged_file_is_refused(packed: Path, tmp_path: Path) -> None:
    """Cut short, of another format, with another recipe or other numbers, or not one at all."""
    cut = tmp_path / "cut.npz"
    cut.write_bytes(packed.read_bytes()[:-100])
    with pytest.raises(StoreError, match="truncated or damaged"):
        HeldOut.open(cut)
    with pytest.raises(StoreError, match="it has format 9"):
        HeldOut.open(rewritten(packed, tmp_path / "a.npz", format=9))
    with pytest.raises(StoreError, match="its recipe is not the one"):
        HeldOut.open(rewritten(packed, tmp_path / "b.npz", key="0" * 32))
    with np.load(packed) as file:
        points_mm = file["points_mm"] + 1e-9
    with pytest.raises(StoreError, match="its content is not what"):
        HeldOut.open(rewritten(packed, tmp_path / "c.npz", points_mm=points_mm))
    cases = [{**row, "split": "unseen"} for row in HeldOut.open(packed).manifest["cases"]]
    with pytest.raises(StoreError, match="its content is not what"):
        HeldOut.open(rewritten(packed, tmp_path / "d.npz", cases=cases))
    text = tmp_path / "text.npz"
    text.write_text("no archive")
    with pytest.raises(StoreError, match="cannot be used"):
        open_source(text)
    with zipfile.ZipFile(tmp_path / "empty.npz", "w"):
        pass
    with pytest.raises(StoreError, match="cannot be used"):
        open_source(tmp_path / "empty.npz")
