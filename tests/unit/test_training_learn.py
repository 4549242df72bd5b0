"""Trainings as files: they go on where they were, refuse what is not theirs, and end as weights."""

from __future__ import annotations

import dataclasses
import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from sim.forces.network.minkunet import arrays_of
from sim.forces.network.predictor import Precision, Predictor
from sim.forces.network.spec import NetworkSpec, Target
from sim.forces.network.weights import load_weights
from sim.forces.training.settings import TrainingSettings
from sim.forces.training.trainer import Trainer
from tests.unit.made_presses import SETTINGS, made_presses
from workbench.core.base.errors import DesignError, DeviceError, SolveError, StoreError
from workbench.learning.dataset.cases import Split
from workbench.learning.training.beginning import begin, best_factor
from workbench.learning.training.checkpoint import CHECKPOINT, read_checkpoint
from workbench.learning.training.curves import COLUMNS
from workbench.learning.training.learn import train
from workbench.learning.training.learning_curve import learning_curve
from workbench.learning.training.plan import Plan, Resources, Trained
from workbench.learning.training.presses import Presses

PRESSES = made_presses(12)
SKIN = PRESSES.skins[0]
PLAN = Plan(settings=SETTINGS, target=Target.FORCE, seed=4)
CPU = Resources(device="cpu")
TIMED = ("seconds",)


def run(out: Path, plan: Plan = PLAN, presses: Presses = PRESSES, minutes: float = 0.0) -> Trained:
    """A training on the CPU."""
    resources = dataclasses.replace(CPU, minutes=minutes)
    return train(presses, plan, out, resources=resources)


def told(done: Trained) -> list[dict[str, Any]]:
    """Rows without what a clock says."""
    return [{k: v for k, v in row.items() if k not in TIMED} for row in done.rows]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Trained:
    """A training that was never stopped."""
    return run(tmp_path_factory.mktemp("whole"))


def test_a_paused_training_goes_on_to_the_same_weights(tmp_path: Path, whole: Trained) -> None:
    """Paused after each epoch, three processes' worth: rows and weights bit by bit."""
    for epochs in (1, 2):
        paused = run(tmp_path, minutes=1e-9)
        assert (len(paused.rows), paused.finished) == (epochs, False)
        assert paused.weights.exists()
    done = run(tmp_path)
    assert done.finished and told(done) == told(whole)
    assert [path.name for path in tmp_path.glob("*.weights")] == [done.weights.name]
    ours, theirs = (load_weights(each.weights).arrays for each in (done, whole))
    assert all(np.array_equal(ours[name], theirs[name]) for name in theirs)
    # Nothing is left to do: the same command says the same again.
    assert run(tmp_path).weights.name == done.weights.name


def test_files_say_what_the_rows_say(whole: Trained) -> None:
    """A line per epoch as JSON and as CSV, a chart, and the summary."""
    folder = whole.weights.parent
    lines = (folder / "curves.jsonl").read_text().splitlines()
    assert [json.loads(line) for line in lines] == list(whole.rows)
    head, *body = (folder / "curves.csv").read_text().splitlines()
    assert head.split(",") == list(COLUMNS) and len(body) == 3
    assert float(body[1].split(",")[3]) == whole.rows[1]["train_mae"]
    assert (folder / "curves.png").read_bytes()[:4] == b"\x89PNG"
    summary = json.loads((folder / "training.json").read_text())
    assert summary["weights"] == whole.weights.name and summary["finished"]
    assert summary["scores"] == whole.scores


def test_the_best_epoch_is_that_of_the_least_validation_error(whole: Trained) -> None:
    """Not the last one as such; nulls stand beside it: zero, and a tenth of it by construction."""
    errors = [row["validation_mae"] for row in whole.rows]
    assert whole.best_epoch == 1 + errors.index(min(errors))
    row = whole.rows[0]
    assert row["mpm_mae"] == pytest.approx(0.1 * row["zero_mae"], rel=1e-4)
    assert row["validation_loss"] == row["validation_mae"] / row["zero_mae"]


def test_scores_of_the_card_are_those_of_the_file(whole: Trained) -> None:
    """The file's network, in float32, on the test samples: the mean that the card states."""
    weights = load_weights(whole.weights)
    fields = PRESSES.fields(Target.FORCE, PRESSES.of_split(Split.TEST))
    predictor = Predictor(weights, SKIN.points_mm, faces=SKIN.faces, precision=Precision.SINGLE)
    apart = np.abs(predictor.predict(fields.inputs) - fields.targets).mean()
    score = weights.card["scores"]["test"]
    assert set(weights.card["scores"]) == {"validation", "test", "unseen"}
    assert score["mae"] == pytest.approx(apart, rel=1e-5)
    assert score["zero_mae"] == pytest.approx(fields.zero_mae)
    assert score["mpm_mae"] == pytest.approx(0.1 * fields.zero_mae, rel=1e-4)
    assert (score["cases"], score["samples"]) == (2, 4)


def test_the_card_says_what_readers_ask_for(whole: Trained) -> None:
    """The keys of the contract, of the data that were trained on."""
    card = load_weights(whole.weights).card
    assert card["dataset"]["per_split"]["train"] == {"cases": 6, "samples": 12}
    assert card["young_MPa"] == 0.1 and card["friction"] == 0.3 and card["solver_input"] == "mpm"
    assert card["indenters"] == ["dent"]
    (membrane,) = card["membranes"]
    assert membrane["design"] == {"name": "sheet"} and membrane["mesh_key"] == "sheet0"
    assert membrane["vertices"] == 144 and membrane["bounds_mm"][1][0] == 11.0
    training = card["training"]
    assert (training["epochs"], training["seed"], training["samples"]) == (3, 4, 12)
    assert training["parameters"] > 1000 and training["device"] == "cpu"
    states = PRESSES.of_split(Split.TRAIN)
    largest = np.linalg.norm(PRESSES.fields(Target.FORCE, states).inputs, axis=2).max()
    assert card["max_displacement_mm"] == pytest.approx(largest, rel=1e-6)
    assert 0.0 < card["displacement_p95_mm"] <= card["max_displacement_mm"]


def test_it_stops_when_validation_gets_no_better(tmp_path: Path) -> None:
    """A rate that learns nothing: after the first epoch two without a better one."""
    settings = dataclasses.replace(SETTINGS, epochs=50, patience=2, rate=1e-7, averaging=0.0)
    settings = dataclasses.replace(settings, weight_decay=0.0)
    done = run(tmp_path, dataclasses.replace(PLAN, settings=settings))
    assert done.finished and len(done.rows) == done.best_epoch + 2 < 50


@pytest.mark.parametrize("change", ["seed", "rate", "data", "target"])
def test_another_training_is_not_gone_on_with(tmp_path: Path, change: str) -> None:
    """Other data, settings, seed or target in a folder that holds a training: refused."""
    run(tmp_path, minutes=1e-9)
    plan, presses = PLAN, PRESSES
    if change == "seed":
        plan = dataclasses.replace(PLAN, seed=9)
    elif change == "rate":
        plan = dataclasses.replace(PLAN, settings=dataclasses.replace(SETTINGS, rate=1e-3))
    elif change == "target":
        plan = dataclasses.replace(PLAN, target=Target.DISPLACEMENT)
    else:
        presses = made_presses(12, seed=1)
    with pytest.raises(StoreError, match="a training of other data, settings or seed"):
        run(tmp_path, plan, presses)


def test_a_damaged_checkpoint_is_refused(tmp_path: Path) -> None:
    """Cut short, it is named with what to do; nothing in it is executed."""
    run(tmp_path, minutes=1e-9)
    path = tmp_path / CHECKPOINT
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    with pytest.raises(StoreError, match="is damaged or cut short") as caught:
        run(tmp_path)
    assert "delete it" in caught.value.hint
    torch.save({"format": 1, "key": print}, path)
    with pytest.raises(StoreError, match="is damaged"):
        read_checkpoint(tmp_path, "key")
    torch.save({"format": 7, "key": "key"}, path)
    with pytest.raises(StoreError, match="has format 7"):
        read_checkpoint(tmp_path, "key")


def spoil(monkeypatch: pytest.MonkeyPatch, at_epoch: int, error: Exception) -> None:
    """Let a training fail in the middle of an epoch."""
    real = Trainer._step

    def step(self: Trainer, *rest: Any) -> Any:
        if self.epoch == at_epoch:
            raise error
        return real(self, *rest)

    monkeypatch.setattr(Trainer, "_step", step)


@pytest.mark.parametrize(
    "error", [DeviceError("no memory left"), SolveError("the loss is nan"), KeyboardInterrupt()]
)
def test_what_stops_an_epoch_keeps_the_checkpoint_before(
    tmp_path: Path, whole: Trained, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    """Full device, NaN, Ctrl-C in epoch 3: two epochs are kept, and going on ends as ever."""
    with monkeypatch.context() as patch:
        spoil(patch, 2, error)
        with pytest.raises(type(error)):
            run(tmp_path)
    assert len((tmp_path / "curves.jsonl").read_text().splitlines()) == 2
    done = run(tmp_path)
    assert told(done) == told(whole) and done.weights.name != ""
    ours, theirs = (load_weights(each.weights).arrays for each in (done, whole))
    assert all(np.array_equal(ours[name], theirs[name]) for name in theirs)


KILLED = """
import sys
from pathlib import Path
from tests.unit.test_training_learn import run
run(Path(sys.argv[1]))
"""


@pytest.mark.slow
def test_a_killed_training_loses_the_running_epoch_only(tmp_path: Path, whole: Trained) -> None:
    """SIGKILL after the first checkpoint; the same command ends with the same weights."""
    root = Path(__file__).parents[2]
    process = subprocess.Popen([sys.executable, "-c", KILLED, str(tmp_path)], cwd=root)
    until = time.monotonic() + 120.0
    while not (tmp_path / CHECKPOINT).exists() and time.monotonic() < until:
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    process.wait()
    kept = torch.load(tmp_path / CHECKPOINT, weights_only=True)
    assert kept["trainer"]["epoch"] == len(kept["rows"]) >= 1
    done = run(tmp_path)
    assert told(done) == told(whole)


@pytest.mark.slow
def test_what_is_learned_holds_on_other_presses(tmp_path: Path) -> None:
    """60 made-up cases teach the law for dents elsewhere: far below the error of saying zero.

    Measured, over that error: validation 0.49, test 0.46, unseen 0.47; after 30 epochs test 0.30.
    """
    spec = NetworkSpec(name="made", planes=(8, 8, 12, 12, 12, 8, 8, 8), stem_planes=8)
    settings = TrainingSettings(
        name="made", spec=spec, rate=5e-3, batch=4, epochs=10, cosine=True, warm_up=0.03, clip=1.0
    )
    settings = dataclasses.replace(settings, averaging=0.98, foot=0.1, turns=2)
    presses = made_presses(120, frames=3, edges=(16,))
    done = run(tmp_path, Plan(settings=settings, target=Target.FORCE), presses)
    shares = {k: found["mae"] / found["zero_mae"] for k, found in done.scores.items()}
    assert max(shares.values()) < 0.6, shares


def test_no_case_to_train_on_is_refused(tmp_path: Path) -> None:
    """Three training cases are asked for where there are two; and a set without any."""
    few = made_presses(5)
    with pytest.raises(DesignError, match="have 3 cases to train on, 4 are asked for"):
        run(tmp_path, dataclasses.replace(PLAN, cases=4), few)
    tests = dataclasses.replace(
        few, states=tuple(dataclasses.replace(s, split=Split.TEST) for s in few.states)
    )
    with pytest.raises(DesignError, match="have 0 cases to train on"):
        run(tmp_path, presses=tests)
    assert len(dataclasses.replace(PLAN, cases=1).states(few)) == 2


def test_targets_that_are_all_zero_are_refused(tmp_path: Path) -> None:
    """No press touched: there is nothing to learn, and nothing to measure losses in."""
    nothing = PRESSES.parts["fem.contact_force_N"]
    nothing = dataclasses.replace(nothing, values=np.zeros_like(nothing.values))
    parts = {**PRESSES.parts, "fem.contact_force_N": nothing}
    with pytest.raises(DesignError, match=r"of \d+ samples to train on none has a force"):
        run(tmp_path, presses=dataclasses.replace(PRESSES, parts=parts))


def test_a_field_that_is_not_finite_stops_before_the_first_step(tmp_path: Path) -> None:
    """A packed field with NaN: named, and no checkpoint is begun."""
    field = PRESSES.parts["fem.contact_force_N"]
    values = field.values.copy()
    values[3, 1] = np.nan
    parts = {
        **PRESSES.parts,
        "fem.contact_force_N": dataclasses.replace(field, values=values),
    }
    with pytest.raises(SolveError, match="target of dent0 frame 1 has 1 of 432 values"):
        run(tmp_path, presses=dataclasses.replace(PRESSES, parts=parts))
    assert not (tmp_path / CHECKPOINT).exists()


def test_tuning_starts_at_force_times_the_ratio_of_stiffness(
    tmp_path: Path, whole: Trained
) -> None:
    """Force is proportional to E: doubled, the output's scale begins doubled; encoder unchanged."""
    base = load_weights(whole.weights)
    stiff = made_presses(12, young=0.2)
    plan = dataclasses.replace(PLAN, base=base, base_name=whole.weights.name)
    begun, old = (
        begin(presses, PRESSES.of_split(Split.TRAIN), plan, CPU) for presses in (stiff, PRESSES)
    )
    assert begun.scales.output == pytest.approx(2.0 * old.scales.output, rel=1e-4)
    assert begun.scales.input_mm == base.input_scale_mm
    done = run(tmp_path, plan, stiff)
    tuned = load_weights(done.weights)
    assert tuned.card["training"]["tuned_from"] == whole.weights.name
    assert tuned.card["young_MPa"] == 0.2
    moved = {
        name.split(".")[0]
        for name, values in tuned.arrays.items()
        if not np.array_equal(values, base.arrays[name])
    }
    assert moved <= {"ups", "up_norms", "decoder", "last"} and "decoder" in moved
    assert arrays_of(begun.network).keys() == tuned.arrays.keys()
    wrong = dataclasses.replace(plan, target=Target.DISPLACEMENT)
    with pytest.raises(DesignError, match="predicts force, not displacement"):
        run(tmp_path / "wrong", wrong, stiff)


def test_a_network_of_patches_is_trained_kept_and_tuned(tmp_path: Path) -> None:
    """The size of the patch goes from the settings into weights and card, and on when tuned."""
    settings = dataclasses.replace(
        SETTINGS, patch_spacings=2.0, takes_force=True, corrects=True, turns=1
    )
    plan = dataclasses.replace(PLAN, settings=settings)
    done = run(tmp_path / "made", plan)
    made = load_weights(done.weights)
    assert (made.patch_spacings, made.takes_force, made.corrects) == (2.0, True, True)
    card = made.card["training"]
    assert (card["patch_spacings"], card["turns"]) == (2.0, "any")
    # By one look at each sample while it learns, by four at the end.
    best = done.rows[done.best_epoch - 1]["validation_mae"]
    assert done.scores["validation"]["mae"] == pytest.approx(best, rel=0.5)
    tuning = dataclasses.replace(PLAN, base=made, base_name=done.weights.name)
    tuned = load_weights(run(tmp_path / "tuned", tuning, made_presses(12, young=0.2)).weights)
    assert tuned.patch_spacings == 2.0
    assert tuned.card["training"]["turns"] == "any"
    with pytest.raises(DesignError, match="3 turns are of whole skins"):
        dataclasses.replace(settings, turns=3)


def test_one_network_learns_two_membranes(tmp_path: Path) -> None:
    """Patches of both lie in its batches; each is scored on a skin of its own, and on the card."""
    settings = dataclasses.replace(
        SETTINGS,
        takes_force=True,
        corrects=True,
        patch_spacings=2.0,
        turns=1,
        peak_heed=3.0,
        epochs=20,
    )
    presses = made_presses(24, edges=(12, 15))
    done = run(tmp_path, dataclasses.replace(PLAN, settings=settings), presses)
    card = load_weights(done.weights).card
    assert [membrane["vertices"] for membrane in card["membranes"]] == [144, 225]
    assert card["training"]["samples"] == 24
    score, states = done.scores["validation"], presses.of_split(Split.VALIDATION)
    raw = presses.raw_errors(Target.FORCE, states)
    assert raw is not None
    assert score["mpm_mae"] == pytest.approx(raw.mean())
    assert score["mae"] < 0.9 * score["mpm_mae"]
    with pytest.raises(DesignError, match="2 membranes, and whole skins"):
        run(tmp_path / "whole", PLAN, presses)


def test_the_best_factor_is_that_of_least_squares() -> None:
    """<found, wanted> / <found, found> over all samples; nothing to go by gives 1."""
    found, wanted = np.array([[1.0, 0.0], [1.0, 4.0]]), np.array([[3.0, 9.0], [5.0, 8.0]])
    assert best_factor([found], [wanted]) == pytest.approx(40.0 / 18.0)
    assert best_factor([np.zeros((2, 2))], [wanted]) == 1.0
    assert best_factor([found], [-wanted]) == 1.0


def test_without_validation_the_last_epoch_is_kept(tmp_path: Path) -> None:
    """There is nothing to choose by, which is said; curves have no such column."""
    states = tuple(
        dataclasses.replace(s, split=Split.TEST if s.split is Split.VALIDATION else s.split)
        for s in PRESSES.states
    )
    done = run(tmp_path, presses=dataclasses.replace(PRESSES, states=states))
    assert done.best_epoch == len(done.rows) == 3
    assert any("no validation case" in note for note in done.notes)
    assert done.rows[0]["validation_mae"] is None


def test_a_learning_curve_trains_on_shares_with_equal_steps(tmp_path: Path) -> None:
    """Half and all of six cases, as many steps, scores on the same others."""
    settings = dataclasses.replace(SETTINGS, epochs=1)
    plan = dataclasses.replace(PLAN, settings=settings)
    found = learning_curve(PRESSES, plan, [0.5, 1.0], tmp_path, resources=CPU)
    assert [(row["cases"], row["samples"]) for row in found["rows"]] == [(3, 6), (6, 12)]
    cards = [load_weights(tmp_path / row["weights"]).card for row in found["rows"]]
    assert [card["training"]["cases"] for card in cards] == [3, 6]
    assert json.loads((tmp_path / "learning_curve.json").read_text()) == found
    assert (tmp_path / "learning_curve.png").read_bytes()[:4] == b"\x89PNG"
    passes = [
        torch.load(tmp_path / f"cases{cases:04d}" / CHECKPOINT, weights_only=True)["trainer"]
        for cases in (3, 6)
    ]
    steps = {int(next(iter(p["optimiser"]["state"].values()))["step"]) for p in passes}
    assert steps == {3}
    with pytest.raises(DesignError, match=r"share 1\.5 is outside"):
        learning_curve(PRESSES, plan, [1.5], tmp_path, resources=CPU)
