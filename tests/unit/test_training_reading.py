"""Data for training: several sets become one, and what does not belong is refused by name."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.forces.network.spec import Target
from tests.unit.made_presses import made_presses
from tests.unit.test_dataset_cases import flat_skin
from tests.unit.test_dataset_folder import SKIN, a_sample, damage, started, write
from workbench.core.base.errors import DesignError, StoreError
from workbench.learning.dataset.begin import begin
from workbench.learning.dataset.cases import Split, cases_of
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.recipe import Recipe
from workbench.learning.dataset.recipes import load_recipe
from workbench.learning.dataset.sample import Sample, to_bytes
from workbench.learning.training.packed import read_packed, write_packed
from workbench.learning.training.presses import Presses
from workbench.learning.training.reading import read_presses
from workbench.system.whole_files import write_atomically


def put(data: DataSet, sample: Sample, number: int, frame: int) -> Path:
    """Write a sample as that of a frame."""
    path = data.path(data.all_cases[number], frame)
    write_atomically(path, to_bytes(sample))
    return path


def changed(data: DataSet, number: int = 0, frame: int = 0, **changes: Any) -> None:
    """Write a made-up sample with other fields."""
    put(data, dataclasses.replace(a_sample(data, number, frame), **changes), number, frame)


def edit_manifest(folder: Path, edit: Callable[[dict[str, Any]], None]) -> None:
    """Change the manifest of a data set."""
    manifest = json.loads((folder / "manifest.json").read_text())
    edit(manifest)
    (folder / "manifest.json").write_text(json.dumps(manifest))


def test_fields_are_those_of_the_samples(tmp_path: Path) -> None:
    """Input, target and the contact solver's own error, each from the sample it belongs to."""
    data = started(tmp_path)
    write(data, 0, 0)
    write(data, 3, 7)
    found = read_presses([tmp_path])
    assert [state.name for state in found.states] == [
        f"{data.all_cases[0].id} frame 1",
        f"{data.all_cases[3].id} frame 8",
    ]
    assert [state.split for state in found.states] == [c.split for c in data.all_cases[0:4:3]]
    sample = a_sample(data, 3, 7)
    assert sample.mpm is not None and sample.fem is not None
    for target, truth in (
        (Target.FORCE, sample.fem.contact_force_N),
        (Target.DISPLACEMENT, sample.fem.displacement_mm),
        (Target.STRESS, sample.fem.cauchy_MPa),
    ):
        fields = found.fields(target, [1])
        assert np.array_equal(fields.inputs[0], sample.mpm.displacement_mm)
        assert np.array_equal(fields.targets[0], truth)
    raw = found.raw_errors(Target.FORCE, [1])
    apart = np.abs(sample.mpm.contact_force_N - sample.fem.contact_force_N).mean()
    assert raw is not None and raw[0] == pytest.approx(apart, rel=1e-5)


@pytest.mark.parametrize(("gone", "words"), [("mpm", "the contact solver"), ("fem", "finite el")])
def test_a_data_set_of_one_solver_is_refused(tmp_path: Path, gone: str, words: str) -> None:
    """The message says which is missing, the hint how to make it with both."""
    nothing: dict[str, Any] = {gone: None}
    changed(started(tmp_path), **nothing)
    with pytest.raises(DesignError, match=f"holds nothing by {words}") as caught:
        read_presses([tmp_path])
    assert "--solver both" in caught.value.hint


@pytest.mark.parametrize("how", ["truncated", "not finite"])
def test_a_damaged_sample_stops_the_training(tmp_path: Path, how: str) -> None:
    """Never left out in silence: the file is named."""
    data = started(tmp_path)
    write(data, 0, 0)
    damage(write(data, 0, 1), how)
    with pytest.raises(StoreError, match=r"001\.npz cannot be used"):
        read_presses([tmp_path])


def test_samples_that_did_not_converge_are_left_out_and_counted(tmp_path: Path) -> None:
    """Of either solver; the first is named."""
    data = started(tmp_path)
    write(data, 0, 0)
    for frame, solver in ((1, "mpm"), (2, "fem")):
        sample = a_sample(data, 0, frame)
        loose = dataclasses.replace(getattr(sample, solver), converged=False)
        changed(data, 0, frame, **{solver: loose})
    found = read_presses([tmp_path])
    assert [state.frame for state in found.states] == [0]
    name = data.all_cases[0].id
    assert found.about["left_out"] == [f"{name} frame 2", f"{name} frame 3"]


def test_two_data_sets_of_a_skin_are_one(tmp_path: Path) -> None:
    """The second holds six cases more; what both hold counts once."""
    small, large = started(tmp_path / "a", 4), started(tmp_path / "b", 10)
    for data, numbers in ((small, (0, 1)), (large, (1, 5))):
        for number in numbers:
            write(data, number, 0)
    found = read_presses([tmp_path / "a", tmp_path / "b"])
    cases = [large.all_cases[number].id for number in (0, 1, 5)]
    assert [state.case for state in found.states] == cases
    assert found.about["sets"] == ["a", "b"]


def other(plan: Recipe, **changes: Any) -> Recipe:
    """A recipe whose material is another."""
    material = dataclasses.replace(plan.design.material, **changes)
    return dataclasses.replace(plan, design=dataclasses.replace(plan.design, material=material))


def test_data_sets_that_differ_in_more_than_presses_are_refused(tmp_path: Path) -> None:
    """Skin, material, mesh size or version of a solver: each is named."""
    plan = dataclasses.replace(load_recipe("small"), cases=4)

    def refused(words: str, second: Recipe, half_mm: float = 0.5) -> None:
        folder = tmp_path / words.replace(" ", "_")
        begin(folder, second.table, flat_skin(5.0, half_mm), cases_of(second))
        with pytest.raises(StoreError, match=f"differ in .*{words}"):
            read_presses([tmp_path / "first", folder])

    begin(tmp_path / "first", plan.table, SKIN, cases_of(plan))
    refused("skin", plan, 0.25)
    refused("material", other(plan, young_MPa=0.3))
    refused("hex_mm", dataclasses.replace(plan, hex_mm=0.6))
    data = begin(tmp_path / "again", plan.table, SKIN, cases_of(plan))
    write(data, 0, 0)
    assert len(read_presses([tmp_path / "first", tmp_path / "again"]).states) == 1

    def older(manifest: dict[str, Any]) -> None:
        manifest["stages"]["fem"] -= 1

    edit_manifest(tmp_path / "again", older)
    with pytest.raises(StoreError, match="differ in version of fem"):
        read_presses([tmp_path / "first", tmp_path / "again"])


def test_a_pair_in_two_splits_is_refused(tmp_path: Path) -> None:
    """Another seed deals another split: what one set tests, the other would learn."""
    plan = dataclasses.replace(load_recipe("small"), cases=84)
    for name, seed in (("a", 0), ("b", 1)):
        own = dataclasses.replace(plan, seed=seed)
        begin(tmp_path / name, own.table, SKIN, cases_of(own))
    with pytest.raises(StoreError, match="what is tested would have been learned") as caught:
        read_presses([tmp_path / "a", tmp_path / "b"])
    assert "--seed" in caught.value.hint


def same(one: Presses, two: Presses) -> bool:
    """Whether two hold the same, bit by bit."""
    return one.key == two.key and one.about == two.about and one.states == two.states


def test_packed_data_come_back_bit_by_bit(tmp_path: Path) -> None:
    """Fields, states and where they come from; of one target only, the others are refused."""
    data = started(tmp_path / "set")
    for number in range(3):
        write(data, number, number)
    whole = read_presses([tmp_path / "set"])
    write_packed(tmp_path / "all.presses", whole)
    again = read_presses([tmp_path / "all.presses"])
    assert same(whole, again)
    for split in Split:
        assert again.of_split(split) == whole.of_split(split)
    write_packed(
        tmp_path / "force.presses", read_presses([tmp_path / "set"], targets=[Target.FORCE])
    )
    force = read_packed(tmp_path / "force.presses")
    one, two = (each.fields(Target.FORCE, [2]) for each in (force, whole))
    assert np.array_equal(one.targets, two.targets)
    with pytest.raises(DesignError, match=r"holds no fem\.cauchy_MPa"):
        force.fields(Target.STRESS, [0])
    with pytest.raises(DesignError, match="a packed file among them"):
        read_presses([tmp_path / "all.presses", tmp_path / "set"])


@pytest.mark.parametrize("how", ["cut", "bit", "other", "format"])
def test_a_damaged_packed_file_is_refused(tmp_path: Path, how: str) -> None:
    """Cut short, a bit flipped, no such file at all, another format: never a wrong field."""
    path = tmp_path / "made.presses"
    write_packed(path, made_presses(6))
    content = path.read_bytes()
    if how == "cut":
        path.write_bytes(content[:-200])
    elif how == "bit":
        half = len(content) // 2
        path.write_bytes(content[:half] + bytes([content[half] ^ 4]) + content[half + 1 :])
    elif how == "other":
        path.write_bytes(b"something else")
    else:
        with np.load(path) as file:
            arrays = {name: file[name] for name in file.files}
        head = json.loads(arrays["head"].tobytes())
        arrays["head"] = np.frombuffer(json.dumps({**head, "format": 99}).encode(), np.uint8)
        with path.open("wb") as file:
            np.savez(file, **arrays)
    with pytest.raises(StoreError, match="cannot be used") as caught:
        read_packed(path)
    assert "train pack" in caught.value.hint
    assert how != "format" or "format 99" in caught.value.message
