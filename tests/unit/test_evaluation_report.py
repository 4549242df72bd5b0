"""The report of an evaluation, its command, and the rows of `validate forces` that it feeds."""

from __future__ import annotations

import dataclasses
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from sim.forces.network.checks import sparse_dense_difference
from sim.forces.network.spec import Target
from sim.forces.network.weights import Storage
from tests.synthetic_presses import made_up
from tests.unit.test_evaluation import untrained
from workbench.cli import validate_rooms as validate
from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError, DeviceError, StoreError
from workbench.learning.dataset.folder import DataSet
from workbench.learning.evaluation import charts, heat_maps, sheets
from workbench.learning.evaluation.published import MAE, over_peak
from workbench.learning.evaluation.sources import open_source
from workbench.learning.evaluation.speed import efficiency, efficiency_html
from workbench.pipeline import shipped
from workbench.pipeline.weight_files import save_weights
from workbench.proof.benchmarks.forces import shell
from workbench.proof.benchmarks.records import kept_at, read_record, shipped_records, write_record
from workbench.proof.row import failed, stated
from workbench.proof.validation.learned import learned_scores as learned
from workbench.proof.validation.learned import learned_speed, learned_stiffness
from workbench.proof.validation.learned.stiffness_figures import scored


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Nominal and soft sets, untrained weights of both fields, tuned ones of the force."""
    place = tmp_path_factory.mktemp("evaluation")
    base = made_up(place / "base", cases=12)
    soft = made_up(place / "soft", young_MPa=0.0725, cases=12)
    for target in (Target.FORCE, Target.DISPLACEMENT):
        save_weights(place / "weights", untrained(base, target), storage=Storage.SINGLE)
    save_weights(place / "tuned", untrained(soft), storage=Storage.SINGLE)
    return place


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Heat maps in the time of a test."""
    sheet = np.zeros((8, 8, 3), np.uint8)
    monkeypatch.setattr(sheets, "heat_map", lambda skin, pair: sheet)


def options(folder: Path) -> list[str]:
    paths = sorted((folder / "weights").iterdir()) + sorted((folder / "tuned").iterdir())
    return [word for path in paths for word in ("--weights", str(path))]


@pytest.mark.usefixtures("undrawn")
def test_the_command_writes_scores_report_and_sheets(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """From data set to page; every number of the JSON is finite or null."""
    words = [str(folder / "base"), *options(folder), "--stiffness", str(folder / "soft")]
    assert main(["evaluate", *words, "--no-speed", "--out", str(tmp_path), "--json"]) == 0
    last = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert "On unseen objects the error of the learned force" in last["verdicts"][0]
    assert "not reached" in last["verdicts"][0]
    scores = json.loads((tmp_path / "scores.json").read_text(), parse_constant=pytest.fail)
    unseen = scores["fields"]["force"]["splits"]["unseen"]
    assert unseen["learned_over_zero"] == pytest.approx(
        unseen["learned"]["mae"] / unseen["zero"]["mae"]
    )
    assert list(scores["fields"]) == ["force", "displacement"]
    assert [row["target"] for row in scores["stiffness"]] == ["force", "displacement"]
    assert scores["stiffness"][0]["truth_off_proportion"] < 1e-6
    page = (tmp_path / "report.html").read_text()
    assert "tuned here" in page and "untuned, times the ratio of E" in page
    assert "2.77e-4 mm and 8.6e-6 N" in page and "flower" in page
    # Self-contained: no script, nothing from elsewhere.
    assert "<script" not in page and not re.search(r"(src|href)='(?!data:)", page)
    for name in ("force_press", "force_shear", "displacement_press", "displacement_shear"):
        assert (tmp_path / f"{name}.png").stat().st_size > 0


@pytest.mark.usefixtures("undrawn")
def test_a_packed_set_is_evaluated_like_the_data_set(folder: Path, tmp_path: Path) -> None:
    """Packed by the command and scored by it."""
    pack = tmp_path / "heldout.npz"
    assert main(["evaluate", str(folder / "base"), "--pack", str(pack)]) == 0
    weights = options(folder)[:4]
    out = tmp_path / "out"
    assert main(["evaluate", str(pack), *weights, "--no-speed", "--out", str(out)]) == 0
    scores = json.loads((out / "scores.json").read_text())
    assert scores["data"]["name"] == "heldout"
    assert scores["fields"]["force"]["press_depths_mm"].keys() == {"0.2", "0.4"}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "it is not said what to write"),
        (["--out", "OUT", "--pack", "FILE"], "it is not said what to write"),
        (["--pack", "FILE", "--most-mb", "0"], "0 MB hold nothing"),
        (["--out", "OUT", "--weights", "FORCE", "--weights", "FORCE"], "both predict force"),
        (["--out", "OUT", "--weights", "TUNED"], "no weights were trained there"),
    ],
)
def test_what_makes_no_sense_is_refused(
    words: list[str], message: str, folder: Path, tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    """Exit code 2 and a sentence."""
    places = {
        "OUT": tmp_path / "out",
        "FILE": tmp_path / "file",
        "FORCE": next((folder / "weights").glob("*-force-*")),
        "TUNED": next((folder / "tuned").iterdir()),
    }
    given = [str(places.get(word, word)) for word in words]
    assert main(["evaluate", str(folder / "base"), *given]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.usefixtures("undrawn")
def test_a_machine_that_cannot_draw_still_reports(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The page says what is missing."""

    def unable(skin: object, pair: object) -> np.ndarray:
        raise DeviceError("no off-screen renderer works here")

    monkeypatch.setattr(sheets, "heat_map", unable)
    words = [str(folder / "base"), *options(folder)[:4], "--no-speed", "--out", str(tmp_path)]
    assert main(["evaluate", *words]) == 0
    assert "not drawn: no off-screen renderer" in (tmp_path / "report.html").read_text()
    assert not list(tmp_path.glob("*.png"))


def test_colours_are_white_at_nothing_and_unlike_at_the_ends() -> None:
    """Blue below, red above, the same beyond the ends."""
    low, none, high = heat_maps.diverging(np.array([-2.0, 0.0, 2.0]))
    assert none.min() > 240
    assert low[2] > 150 > low[0] and high[0] > 150 > high[2]
    assert np.array_equal(heat_maps.diverging(np.array(-1.0)), low)


@pytest.mark.slow
def test_a_heat_map_shows_what_each_says(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A network that says nothing: white, then blue where Z is pressed, and red what it lacks."""
    size = 60
    monkeypatch.setattr(heat_maps, "TILE_PX", size)
    monkeypatch.setattr(heat_maps, "_caption", lambda text: np.zeros((1, size, 3), np.uint8))
    data = DataSet.open(folder / "base")
    middle = [case for case in data.cases() if case.position.name == "x0.0_y0.0"]
    case = (middle or data.cases())[0]
    sample = data.sample(case, case.press_frames - 1)
    assert sample.fem is not None
    pair = heat_maps.Pair(
        sample=sample,
        found=np.zeros_like(sample.fem.contact_force_N),
        truth=sample.fem.contact_force_N,
        moved_mm=sample.fem.displacement_mm,
        unit="N",
    )
    sheet = heat_maps.heat_map(data.skin, pair).astype(int)
    last = sheet[1 + 2 * (size + 1) :][:size]
    found, truth, apart = (
        last[size // 2 - 3 : size // 2 + 3, size * k + size // 2 - 3 : size * k + size // 2 + 3]
        for k in range(3)
    )
    redness = [float((tile[..., 0] - tile[..., 2]).mean()) for tile in (found, truth, apart)]
    assert abs(redness[0]) < 20 and redness[1] < -60 and redness[2] > 60


def test_charts_leave_out_what_is_not_a_number() -> None:
    """Two dots of three; a histogram counts all values."""
    nan = float("nan")
    drawn = charts.lines("t", ["a", "b", "c"], {"learned": [1.0, nan, 2.0]}, below="")
    assert drawn.count("<circle") == 2
    drawn = charts.histogram("t", [0.1, 0.2, 0.9, 0.9], below="")
    counts = [float(value) for value in re.findall(r"<title>([\d.]+)</title>", drawn)]
    assert sum(counts) == 4.0
    assert "nothing to count" in charts.histogram("t", [], below="")


def test_the_papers_force_is_carried_to_our_mesh() -> None:
    """Nodal forces grow with the area of a point: 0.8 mm instead of 0.4 mm is four times."""
    fine, coarse = np.full(9, 0.16), np.full(9, 0.64)
    assert over_peak(Target.FORCE, 0.01, fine) == pytest.approx(MAE[Target.FORCE] / 0.01)
    assert over_peak(Target.FORCE, 0.01, coarse) == pytest.approx(4.0 * MAE[Target.FORCE] / 0.01)
    displaced = over_peak(Target.DISPLACEMENT, 1.0, coarse)
    assert displaced == pytest.approx(MAE[Target.DISPLACEMENT])


@pytest.fixture
def nothing_shipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    place = tmp_path / "shipped"
    monkeypatch.setattr(shipped, "FOLDER", place)
    return place


def test_without_weights_every_row_fails_and_says_why(nothing_shipped: Path) -> None:
    """No row passes silently: names as promised, a reason, no value."""
    found = [row for target in learned.WORDS for row in learned.score_rows(target)]
    nowhere = dataclasses.replace(learned_stiffness.RECORD, path=nothing_shipped / "none.json")
    stiff = learned_stiffness.rows(nowhere)
    assert all("there is none" in row.case and not row.ok for row in stiff)
    assert {row.name for row in stiff} >= {"learned_stiffness_force"}
    assert not any(row.ok for row in found) and all(row.value is None for row in found)
    names = {row.name for row in found}
    for way in ("mpm", "zero"):
        for split in ("unseen", "test"):
            assert f"learned_force_ratio_{way}_{split}" in names
            assert f"learned_deformation_ratio_{way}_{split}" in names
    assert "learned_force_over_peak_unseen" in names
    assert all("no trained network" in row.case or "no held-out set" in row.case for row in found)


def ship(folder: Path, place: Path, *, packs: bool = True) -> None:
    """Ship the untrained weights, and held-out sets."""
    shutil.copytree(folder / "weights", place)
    if packs:
        (place / "held_out").mkdir()
        packed = str(place / "held_out/geltip-1.npz")
        assert main(["evaluate", str(folder / "base"), "--pack", packed]) == 0


def test_rows_of_shipped_weights(folder: Path, nothing_shipped: Path) -> None:
    """Untrained, so they miss the limits with a value beside its null."""
    ship(folder, nothing_shipped)
    found = learned.score_rows(Target.FORCE)
    rows = {row.name: row for row in found}
    assert all(row.case.startswith("geltip: ") for row in found if "_ratio_mpm_" in row.name)
    to_zero = rows["learned_force_ratio_zero_unseen"]
    assert to_zero.value is not None and to_zero.null is not None
    assert not to_zero.ok and to_zero.limit == 0.12
    assert to_zero.value > 0.9 and 0.0 < to_zero.null < 1.0
    to_mpm = rows["learned_force_ratio_mpm_unseen"]
    assert to_mpm.limit == 1.0 and to_mpm.null == pytest.approx(1.0 / to_zero.null)
    worst = rows["learned_force_worst_object_unseen"]
    assert not worst.ok and worst.value is not None and worst.value >= to_mpm.value
    total, bias = rows["learned_total_ratio_unseen"], rows["learned_peak_bias_unseen"]
    assert (total.limit, bias.limit) == (0.02, 0.1) and not total.ok and not bias.ok
    peak = rows["learned_force_over_peak_unseen"]
    assert peak.reference is not None and peak.reference < peak.null < 1.0


def test_rows_of_another_stiffness(folder: Path, tmp_path: Path) -> None:
    """From a record, which another set of weights makes stale; what is not on it fails."""
    kept = dataclasses.replace(learned_stiffness.RECORD, path=tmp_path / "stiffness.json")
    weights = [*(folder / "weights").iterdir(), *(folder / "tuned").iterdir()]
    soft, base = (open_source(folder / name) for name in ("soft", "base"))
    kept.make(lambda: {"found": scored(soft, sorted(weights), base, name="soft")})
    stiff = {(row.name, row.case.split(",")[0]): row for row in learned_stiffness.rows(kept)}
    halved = stiff["learned_stiffness_force", "E halved"]
    assert halved.ok and halved.null is not None
    assert not stiff["learned_stiffness_force", "E doubled; not measured: not on record"].ok
    truth = stiff["learned_stiffness_truth_force", "E halved"]
    assert truth.value is not None and truth.value < 1e-4 and truth.null == pytest.approx(1.0)
    other = dataclasses.replace(kept, files=())
    assert not any(row.ok for row in learned_stiffness.rows(other))


def test_weights_without_samples_fail(folder: Path, nothing_shipped: Path) -> None:
    """And with a data set that is named they are scored."""
    ship(folder, nothing_shipped, packs=False)
    assert all("no held-out set" in row.case for row in learned.score_rows(Target.FORCE))
    rows = learned.score_rows(Target.FORCE, folder / "base")
    assert all(row.value is not None for row in rows)


def test_rows_of_weights_that_saw_the_cases_fail(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Weights of another set, on test cases that they may have been trained on."""
    base = DataSet.open(folder / "base")
    weights = dataclasses.replace(untrained(base), card={"indenters": ["cross"]})
    save_weights(tmp_path, weights, storage=Storage.SINGLE)
    monkeypatch.setattr(shipped, "FOLDER", tmp_path)
    rows = learned.score_rows(Target.FORCE, folder / "base")
    assert not any(row.ok for row in rows)
    assert all("nothing says that" in row.case for row in rows)


def test_sparse_equals_dense_within_the_promise() -> None:
    """Rounding alone; a convolution that ignores its neighbours is told apart."""
    points_mm = shell(200)
    assert sparse_dense_difference(points_mm, double=True) <= 1e-12
    assert 0.0 < sparse_dense_difference(points_mm, double=False) <= 1e-6
    assert sparse_dense_difference(points_mm, double=True, own_voxel_only=True) > 0.1


def record(place: Path, kind: str, fps: tuple[float, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """A record as if measured on such a device."""
    from workbench.pipeline import devices
    from workbench.proof.benchmarks import records

    monkeypatch.setattr(devices, "chosen_device", lambda: kind)
    monkeypatch.setattr(records, "device_name", lambda kind: f"a {kind} device")
    names = ("network_1k", "network_5k", "network_25k")
    rows = [stated(n, "c", v, unit="1/s") for n, v in zip(names, fps, strict=False)]
    rows.append(failed("image_320", "c", unit="1/s", why="no GPU"))
    source = "workbench.proof.benchmarks.timing"
    write_record(kept_at(place, "bench", [source]), "efficiency", lambda: rows)


def test_frame_rates_of_a_gpu_come_from_its_record(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """1,500, 1,000, 500 and 300 are asked; without a record of a GPU the rows fail."""
    place = tmp_path / "records"
    record(place / "cpu.json", "cpu", (9e9, 9e9, 9e9), monkeypatch)
    rows = learned_speed.recorded_rows(place)
    assert [row.ok for row in rows] == [False] * 4
    assert all("no record of a GPU" in row.case for row in rows)
    record(place / "gpu.json", "cuda", (1500.0, 999.0), monkeypatch)
    rows = learned_speed.recorded_rows(place)
    sizes = ("1k", "5k", "25k", "patch_25k")
    assert [row.name for row in rows] == [f"learned_inference_gpu_{size}" for size in sizes]
    assert [row.ok for row in rows] == [True, False, False, False]
    assert "a cuda device" in rows[0].case and rows[0].null == 100.0
    assert "not in the record" in rows[2].case
    older = json.loads((place / "gpu.json").read_bytes()) | {"code": "else"}
    (place / "gpu.json").write_text(json.dumps(older))
    row = learned_speed.recorded_rows(place)[0]
    assert row.stale and not row.ok and "made by other code" in row.case
    (place / "gpu.json").write_text("{}")
    assert not any(row.ok for row in learned_speed.recorded_rows(place))
    with pytest.raises(StoreError, match=r"gpu\.json cannot be read"):
        read_record(place / "gpu.json")


def test_the_efficiency_table_has_the_papers_nine_rates(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """250/33/10, 100/25/10 and 100/76/62, ours between them; what nobody measured is a dash."""
    record(tmp_path / "gpu.json", "cuda", (2000.0, 1500.0, 700.0), monkeypatch)
    table = efficiency({"network_5k": 42.0}, shipped_records(tmp_path))
    paper = [row["fps"][0] for row in table["rows"]]
    assert [fps for fps in paper if fps] == [250, 33, 10, 100, 25, 10, 100, 76, 62]
    settled = [row["what"] for row in table["rows"] if row["frame"] == "a settled press"]
    assert settled == ["deformation"] * 3
    network = {row["row"]: row["fps"] for row in table["rows"]}
    assert network["network_5k"][1:] == [42.0, 1500.0]
    assert network["image_320"][1:] == [None, None]
    page = efficiency_html(table)
    assert "a cuda device" in page and page.count("–") == 2 * 6 + 2 + 4 * 3


def test_only_the_room_forces_takes_data() -> None:
    """Others measure on none."""
    assert set(validate.with_data("forces", Path("x"))) == set(validate.ROOMS)
    with pytest.raises(DesignError, match="measures on no data set"):
        validate.with_data("optics", Path("x"))


def test_ways_keep_their_stroke_and_others_have_one_each() -> None:
    """A chart that lacks a way draws the next as all charts do; what is no way goes by order."""
    two = charts.lines("t", ["a"], {"learned": [1.0], "zero": [2.0]}, below="")
    assert charts.STROKES[2][0] in two and charts.STROKES[1][0] not in two
    own = charts.bars("t", ["a"], {"here": [1.0], "there": [2.0]}, below="")
    assert charts.STROKES[0][0] in own and charts.STROKES[1][0] in own
