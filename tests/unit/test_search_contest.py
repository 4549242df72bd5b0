"""Samplers compared: the hypervolume, the model, the time, what is kept and what is stale."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.toy_search import F, G, Toy, X, Y, closed_forms, toy_problem
from workbench.core.base.errors import DesignError, StoreError
from workbench.core.base.monitor import silent
from workbench.project.project import Project
from workbench.proof.judge import Judge, judge
from workbench.proof.validation.search import contest, room
from workbench.proof.validation.search.confirmed import (
    Truth,
    best_gain,
    chosen,
    confirmed,
    front_steps,
)
from workbench.proof.validation.search.duel import (
    Recorder,
    Step,
    losses_in,
    scale_of,
    searched,
    with_seed,
    within_time,
    within_trials,
)
from workbench.proof.validation.search.model import Model
from workbench.proof.validation.search.problems import TEXTS, problem_of
from workbench.proof.validation.search.response import StageClock, evaluate_designs
from workbench.proof.validation.search.samplers import OURS, RANDOM, SAMPLERS, SOBOL, TPE
from workbench.proof.validation.search.samples import (
    BASE,
    Sample,
    mend,
    read_samples,
    sobol_values,
    values_at,
)
from workbench.proof.validation.search.surface import fit_surface
from workbench.search.journal import problem_digest
from workbench.search.judged import Judged, Status
from workbench.search.problem import Problem, Vary
from workbench.system.record import Record

pytest.importorskip("optuna")


def toy_samples(
    problem: Problem, count: int, toy: Toy | None = None, press_s: float = 0.0
) -> list[Sample]:
    """Designs of the closed forms, the base first; each takes 10 s."""
    toy = toy or Toy()
    base = Sample(number=BASE, values={}, judged=toy.judge_base(silent), stage_s={})
    return [base] + [
        Sample(
            number=number,
            values=values,
            judged=dataclasses.replace(toy.judge(values, silent), seconds=10.0),
            stage_s={"press": press_s, "bake": 1.0},
        )
        for number, values in enumerate(sobol_values(problem.vary, count))
    ]


def toy_model(folder: Path, toy: Toy | None = None) -> Model:
    problem = toy_problem(folder)
    return Model(problem, toy_samples(problem, 64, toy), frozenset())


def test_hypervolume_is_told_over_that_of_the_designs() -> None:
    """Designs at (0, 1), (1, 0) and (1/2, 1/2) dominate 1/4; (1/4, 1/4) alone 9/16, so 9/4."""
    scale = scale_of(np.array([[2.0, 30.0], [4.0, 10.0], [3.0, 20.0]]))
    assert scale.whole == pytest.approx(0.25)
    assert scale.share([[2.5, 15.0]]) == pytest.approx(9.0 / 4.0)
    assert scale.share([[3.0, 20.0]]) == pytest.approx(1.0)
    # On the worst of them, or without any, nothing is dominated.
    assert scale.share([[4.0, 10.0]]) == scale.share([]) == 0.0


def test_a_surface_goes_through_a_known_function() -> None:
    """y = sin(3 a) + b^2, and c without effect: 80 points tell it between them to a hundredth."""

    def known(points: np.ndarray) -> np.ndarray:
        return np.sin(3.0 * points[:, 0]) + points[:, 1] ** 2

    points = np.random.default_rng(1).random((80, 3))
    surface = fit_surface(points, known(points))
    others = 0.1 + 0.8 * np.random.default_rng(2).random((200, 3))
    # Measured: .001.
    assert np.abs(surface.at(others) - known(others)).max() < 0.01
    assert surface.lengths[2] > 3.0 * surface.lengths[0]


def test_what_leaving_one_out_predicts_is_what_a_surface_without_it_says() -> None:
    """By the closed form, and by solving the others alone with the same lengths and variances."""
    random = np.random.default_rng(3)
    points = random.random((12, 2))
    surface = fit_surface(points, np.cos(4.0 * points[:, 0]) + 0.1 * random.random(12))
    square = ((points[:, None] - points[None]) ** 2) @ surface.lengths**-2.0
    root = np.sqrt(5.0 * square)
    smooth = surface.scale * (1.0 + root + 5.0 / 3.0 * square) * np.exp(-root)
    covariance = smooth + surface.noise * np.eye(12)
    mean, deviation = surface.values.mean(), surface.values.std()
    rest = np.arange(12) != 4
    solved = np.linalg.solve(
        covariance[np.ix_(rest, rest)], (surface.values[rest] - mean) / deviation
    )
    expected = mean + deviation * smooth[4, rest] @ solved
    assert surface.left_out[4] == pytest.approx(expected, rel=1e-6)


def test_a_model_answers_as_the_designs_did(tmp_path: Path) -> None:
    """Of the closed forms: figures between the designs, and what is refused."""
    model = toy_model(tmp_path, Toy(refused_above=1.2))
    told = model.judge({X: 0.3, Y: 0.45}, silent)
    for name, value in closed_forms(0.3, 0.45).items():
        if name in told.figures:
            # The least loss is .09, the deviation of the designs .2.
            assert told.figures[name] == pytest.approx(value, abs=0.02)
    assert set(told.figures) == {F, G}
    assert told.seconds == 10.0
    assert model.judge({X: 0.95, Y: 0.9}, silent).status is Status.REFUSED
    assert max(each.error for each in model.surfaces.values()) < 0.1
    # A straight line through the square; the model may be wrong only along it.
    assert model.wrong_share < 0.1 < model.refused_share


def test_too_few_designs_make_no_model(tmp_path: Path) -> None:
    """Nor does a response without its base."""
    problem = toy_problem(tmp_path)
    samples = toy_samples(problem, 30)
    with pytest.raises(DesignError, match="too few"):
        Model(problem, samples[:10], frozenset())
    with pytest.raises(DesignError, match="0 base"):
        Model(problem, samples[1:], frozenset())


def test_ours_beats_random_on_a_known_front(tmp_path: Path) -> None:
    """sqrt(f) + sqrt(g) = 1 on the front: 20 trials of ours dominate more in each of two seeds."""
    problem = toy_problem(tmp_path)
    grid = np.linspace(0.0, 1.0, 11)
    known = [closed_forms(x, y) for x in grid for y in grid]
    scale = scale_of(np.array([[one[F], one[G]] for one in known]))
    for seed in (1, 2):
        share = {}
        for sampler in (OURS, RANDOM):
            steps = searched(with_seed(problem, seed), Toy(), sampler, trials=20, spent_s=0.0)
            assert len(steps) == 20 and all(step.counts for step in steps)
            share[sampler] = scale.share(losses_in(steps))
        # Measured: .991 and .933, .988 and .975.
        assert share[OURS] > share[RANDOM]


@pytest.mark.parametrize("sampler", [SOBOL, RANDOM, TPE])
def test_a_sampler_alone_draws_other_designs_by_another_seed(sampler: str, tmp_path: Path) -> None:
    """And the same ones by the same seed."""
    problem = toy_problem(tmp_path)
    drawn = [
        [
            step.values[X]
            for step in searched(with_seed(problem, seed), Toy(), sampler, trials=4, spent_s=0.0)
        ]
        for seed in (1, 1, 2)
    ]
    assert drawn[0] == drawn[1]
    assert not set(drawn[0]) & set(drawn[2])


def test_equal_minutes_count_thinking_and_shared_presses(tmp_path: Path) -> None:
    """Designs take 10 s, 6 of them for the press: in 100 s fit 10, or in groups of three 1 + 2."""
    problem = toy_problem(tmp_path)
    samples = toy_samples(problem, 32, press_s=6.0)
    model = Model(problem, samples, frozenset({X}))
    alone = searched(problem, model, RANDOM, trials=10, spent_s=100.0)
    assert len(within_trials(alone, 10)) == 10
    assert [step.design_s for step in alone] == [10.0] * len(alone)
    # What is thought costs a trial.
    assert len(within_time(alone, 100.0)) == 9
    model.forget()
    ours = searched(problem, model, OURS, trials=10, spent_s=100.0)
    assert [step.design_s for step in ours[:6]] == [10.0, 4.0, 4.0] * 2
    # Groups take 18 s: five and the first of a sixth in 100 s, less what is thought.
    assert len(within_time(ours, 100.0)) in (15, 16)


def test_refused_designs_take_time_and_are_no_trials(tmp_path: Path) -> None:
    """With x + y <= .8 two thirds are refused: the recorder counts the others."""
    recorder = Recorder(toy_problem(tmp_path), Toy(refused_above=0.8), trials=9, spent_s=0.0)
    recorder.judge_base(silent)
    assert recorder.judge({X: 0.9, Y: 0.9}, silent).status is Status.REFUSED
    recorder.judge({X: 0.1, Y: 0.2}, silent)
    assert [step.counts for step in recorder.steps] == [False, True]
    assert [step.losses is None for step in recorder.steps] == [True, False]
    assert len(within_trials(recorder.steps, 1)) == 2


def test_designs_of_a_response_are_spread_over_what_may_vary() -> None:
    """A range, equal factors, whole numbers and choices: each part of an axis has its share."""
    vary = (
        Vary(path="a", title="a", low=2.0, high=4.0),
        Vary(path="b", title="b", low=0.01, high=1.0, log=True),
        Vary(path="c", title="c", low=1, high=4, whole=True),
        Vary(path="d", title="d", choices=("one", "two")),
    )
    assert values_at(vary, np.array([0.25, 0.5, 0.999, 0.49])) == {
        "a": 2.5,
        "b": 0.1,
        "c": 4,
        "d": "one",
    }
    found = sobol_values(vary, 400)
    assert len(found) == 400
    assert [sum(one["c"] == whole for one in found) for whole in (1, 2, 3, 4)] == pytest.approx(
        [100] * 4, abs=4
    )
    assert sobol_values(vary, 400) == found


def test_a_response_goes_on_after_a_torn_line(tmp_path: Path) -> None:
    """Killed in the line of the fourth design: three are kept, that one is evaluated again."""
    problem, path = toy_problem(tmp_path), tmp_path / "toy.jsonl"
    evaluate_designs(problem, Toy(), path, [BASE, 0, 1, 2])
    whole = path.read_bytes()
    path.write_bytes(whole[:-40])
    assert set(read_samples(path, problem_digest(problem))) == {BASE, 0, 1}
    mend(path)
    toy = Toy()
    evaluate_designs(problem, toy, path, [BASE, 0, 1, 2, 3])
    found = read_samples(path, problem_digest(problem))
    assert list(found) == [BASE, 0, 1, 2, 3]
    assert [dict(values) for values in toy.asked] == sobol_values(problem.vary, 400)[2:4]
    one = found[2]
    assert one.judged.figures == closed_forms(float(one.values[X]), float(one.values[Y]))
    assert one.stage_s.keys() == {"toy"}


def test_a_response_of_another_problem_or_a_damaged_one_is_refused(tmp_path: Path) -> None:
    """Lines of two problems are never mixed."""
    problem, path = toy_problem(tmp_path), tmp_path / "toy.jsonl"
    evaluate_designs(problem, Toy(), path, [0])
    other = dataclasses.replace(problem, goals=problem.goals[:1])
    with pytest.raises(DesignError, match="another problem"):
        evaluate_designs(other, Toy(), path, [1])
    path.write_bytes(b"{}\n")
    with pytest.raises(StoreError, match="line 1"):
        read_samples(path, problem_digest(problem))


def test_the_clock_adds_up_what_each_stage_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Told of the mesh at 0 and 1 s, of the press from 3 s on, and of the end at 7 s."""
    times = iter([0.0, 0.0, 1.0, 3.0, 7.0])
    monkeypatch.setattr("time.monotonic", lambda: next(times))
    clock = StageClock()
    for note in ("mesh 0 %", "mesh 50 %", "press 0 %", ""):
        clock(0.5, note)
    assert clock.stage_s == {"mesh": 3.0, "press": 4.0}


@pytest.mark.parametrize(("name", "varied"), [("light", 6), ("mixed", 8)])
def test_problems_are_searches_that_the_product_takes(
    name: str, varied: int, tmp_path: Path
) -> None:
    """Two goals each; of the mixed one a choice, a whole number, and castable as a limit."""
    problem = problem_of(name, Project(tmp_path))
    assert (len(problem.vary), len(problem.goals)) == (varied, 2)
    if name == "mixed":
        assert any(vary.choices for vary in problem.vary)
        assert any(vary.whole for vary in problem.vary)
        assert [limit.figure for limit in problem.limits] == ["checks_bad"]
    with pytest.raises(DesignError, match="no problem"):
        problem_of(f"{name}s", Project(tmp_path))


def test_fronts_are_evaluated_for_real_once(tmp_path: Path) -> None:
    """A model whose losses are halved promises more than the designs hold."""
    problem = toy_problem(tmp_path)
    steps = [
        Step(
            values={X: x, Y: y},
            losses=tuple(0.5 * closed_forms(x, y)[name] for name in (F, G)),
            counts=True,
            thought_s=0.0,
            design_s=10.0,
        )
        for x, y in [(0.2, 0.5), (0.8, 0.5), (0.2, 0.9)]
    ]
    front = front_steps(steps)
    assert [step.values[X] for step in front] == [0.2, 0.8]
    scale = scale_of(np.array([[0.0, 1.25], [1.25, 0.0], [0.5, 0.5]]))
    assert len(chosen(front, scale, 1)) == 1
    runs, toy = {(OURS, 1): steps}, Toy()
    truth = Truth(problem, toy, tmp_path / "fronts.jsonl")
    final = Truth(problem, Toy(), tmp_path / "final.jsonl")
    found = confirmed(problem, runs, scale, truth, final)
    (true,) = found["true"]
    losses = [[closed_forms(x, 0.5)[name] for name in (F, G)] for x in (0.2, 0.8)]
    assert true == {"sampler": OURS, "seed": 1, "designs": 2, "share": scale.share(losses)}
    assert found["front_error"] == pytest.approx(0.5)
    # The base has 1.25 and .25: (.2, .5) has .04 and .64, (.8, .5) has .64 and .04.
    (gain,) = found["gains"]
    assert gain == {"seed": 1, "draft": pytest.approx(0.488), "own": gain["draft"]}
    assert sorted(one.values[X] for one in truth.asked) == [0.2, 0.8]
    # Another process finds what was evaluated.
    again, second = Toy(), tmp_path / "fronts.jsonl"
    assert confirmed(problem, runs, scale, Truth(problem, again, second), final) == found
    assert (len(toy.asked), len(again.asked)) == (2, 0)


def test_the_contest_is_held_again_on_a_model_that_knows_the_fronts(tmp_path: Path) -> None:
    """The second model has more designs, nearer to the fronts; those that are counted stay."""
    model = toy_model(tmp_path)
    truth = Truth(model.problem, Toy(), tmp_path / "fronts.jsonl")
    found = contest.refined(model, truth, truth, 12)
    assert found["designs"] == 64
    assert 0 < found["added"] < len(truth.asked)
    assert found["front_error"] < found["first"]["front_error"]
    assert len(found["runs"]) == len(found["true"]) == len(contest.SEEDS) * len(SAMPLERS)
    assert json.dumps(found, allow_nan=False)


def test_a_front_without_an_allowed_design_gains_nothing(tmp_path: Path) -> None:
    """And says so instead of a number."""
    assert best_gain(toy_problem(tmp_path), [], *[_truth()] * 2) == {"draft": None, "own": None}


def _truth() -> Any:
    class Nothing:
        def judge(self, values: Any) -> Judged:
            return Judged(status=Status.JUDGED, figures=closed_forms(1.0, 1.0))

    return Nothing()


def made(folder: Path, changes: dict[str, Any], designs: int = 400) -> list[Any]:
    """Rows of a record of one problem, made by today's code; `changes` are of its head."""
    shares = {OURS: 0.9, SOBOL: 0.7, RANDOM: 0.6, TPE: 0.95}
    runs = [
        {"sampler": name, "seed": 1, "at_trials": share, "at_minutes": share, "share": share}
        for name, share in shares.items()
    ]
    problem = {
        "designs": designs,
        "added": 70,
        "trials": 60,
        "ceiling": 1.1,
        "errors": {F: 0.1},
        "wrong_share": 0.02,
        "refused_share": 0.2,
        "runs": runs,
        "true": runs,
        "front_error": 0.05,
        "first": {"front_error": 0.4},
        "gains": [{"seed": 1, "draft": 0.3, "own": 0.25}],
    }
    kept: Record = dataclasses.replace(contest.RECORD, path=folder / "contest.json")
    figures = {"problems": {"light": problem}}
    kept.path.write_text(json.dumps({**kept.head(), **figures, **changes}))
    return room.rows(kept)


def test_rows_pass_where_ours_is_ahead(tmp_path: Path) -> None:
    """.9 is more than Sobol's .7 and random's .6, less than TPE's .95; a quarter is a fifth."""
    rows = made(tmp_path, {})
    assert len({(row.name, row.case) for row in rows}) == len(rows)
    pairs = [row for row in rows if row.name.startswith(room.NAME) and "seed" in row.case]
    assert len(pairs) == 3 * (len(SAMPLERS) - 1)
    for row in pairs:
        assert row.ok == ("against TPE" not in row.case)
        assert (row.value, row.null) == (0.9, 0.6)
    (gain,) = [row for row in rows if row.name == "search_gain"]
    assert gain.ok and gain.limit == room.GAIN_LIMIT
    assert judge("search_gain") is Judge.NONE
    assert {judge(row.name) for row in rows if row.name != "search_gain"} == {Judge.ITSELF}


def test_a_problem_that_is_not_on_record_is_not_measured(tmp_path: Path) -> None:
    """Nor passed; and too few designs are said in every case."""
    rows = made(tmp_path, {}, designs=210)
    (missing,) = [row for row in rows if "not measured" in row.case]
    assert "pad" in missing.case and not missing.ok and missing.value is None
    assert all("210 designs of 400, too few" in row.case for row in rows if row is not missing)
    none = dataclasses.replace(contest.RECORD, path=tmp_path / "none.json")
    assert [row.ok for row in room.rows(none)] == [False] * len(TEXTS)


def test_a_record_by_other_code_is_stale(tmp_path: Path) -> None:
    """Its rows are not met, whatever they say."""
    rows = [row for row in made(tmp_path, {"code": "another"}) if row.value is not None]
    assert rows and all(row.stale and not row.ok for row in rows)
