"""`workbench train`: what may be typed, what is printed, and where it can run."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from sim.forces.network.weights import load_weights
from tests.unit.made_presses import made_presses
from workbench.cli.command_line import main
from workbench.learning.training.packed import write_packed
from workbench.learning.training.presses import Presses

TINY = ("--preset", "tiny", "--epochs", "1")
ROOT = Path(__file__).parents[2]


@pytest.fixture
def packed(tmp_path: Path) -> Path:
    """Made-up presses as a packed file."""
    return put(tmp_path / "made.presses", made_presses(12))


def put(path: Path, presses: Presses) -> Path:
    """Write presses to a packed file."""
    write_packed(path, presses)
    return path


@pytest.fixture(autouse=True)
def on_the_cpu(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small nets on small sheets: what is tested needs no GPU."""
    monkeypatch.setenv("WORKBENCH_DEVICE", "cpu")


def train(tmp_path: Path, *words: object) -> int:
    """Run a command of `workbench train`."""
    first, *rest = map(str, words)
    return main(["train", first, "--project", str(tmp_path / "p"), *rest])


def test_make_prints_epochs_and_scores(
    tmp_path: Path, packed: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An epoch a line on stderr beside the nulls; weights and what they score on stdout."""
    assert train(tmp_path, "make", packed, *TINY, "--out", tmp_path / "out") == 0
    answer, beside = capsys.readouterr()
    assert "epoch 1 of 1: loss" in beside and "contact solver" in beside
    assert "trained 1 epochs" in answer and "of zero" in answer
    (weights,) = (tmp_path / "out").glob("*.weights")
    assert str(weights) in answer and load_weights(weights).target == "force"


def test_json_is_one_object_per_line(
    tmp_path: Path, packed: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Rows of epochs, then what came of it."""
    out = tmp_path / "out"
    assert train(tmp_path, "make", packed, *TINY, "--out", out, "--json", "--seed", 3) == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    epochs = [line for line in lines if line.get("stage") == "train"]
    assert [row["epoch"] for row in epochs] == [1]
    assert lines[-1]["finished"] and Path(lines[-1]["weights"]).exists()
    assert lines[-1]["scores"]["unseen"]["samples"] == 4


def test_tune_begins_with_weights(
    tmp_path: Path, packed: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Twice as stiff: the note says so, the card names the weights it began with."""
    assert train(tmp_path, "make", packed, *TINY, "--out", tmp_path / "base") == 0
    (base,) = (tmp_path / "base").glob("*.weights")
    stiff = put(tmp_path / "stiff.presses", made_presses(12, young=0.2))
    words = ("--epochs", 1, "--turns", 1, "--cases", 2, "--out", tmp_path / "tuned")
    assert train(tmp_path, "tune", stiff, "--weights", base, *words) == 0
    assert f"output scale of {base.name} is multiplied by" in capsys.readouterr().err
    (tuned,) = (tmp_path / "tuned").glob("*.weights")
    card = load_weights(tuned).card["training"]
    assert (card["tuned_from"], card["cases"]) == (base.name, 2)


def test_curve_says_a_line_per_share(
    tmp_path: Path, packed: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A third and all of six cases."""
    words = (*TINY, "--fractions", 0.34, 1, "--out", tmp_path / "curve")
    assert train(tmp_path, "curve", packed, *words) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ["2", "6"]
    assert train(tmp_path, "curve", packed, *words, "--cases", 3) == 2


def test_pack_says_what_it_packed(
    tmp_path: Path, packed: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A packed file can be packed again; its name must say what it is."""
    assert train(tmp_path, "pack", packed, "--out", tmp_path / "again.presses") == 0
    assert "24 samples of 12 cases" in capsys.readouterr().out
    assert train(tmp_path, "pack", packed, "--out", tmp_path / "again.npz") == 2
    assert "again.presses" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("--rate", "0"), "rate 0 is outside"),
        (("--turns", "100"), "turns 100 is outside"),
        (("--cases", "7"), "7 are asked for"),
        (("--minutes", "-1"), "time -1 minutes is outside"),
    ],
)
def test_bad_options_are_refused(
    tmp_path: Path,
    packed: Path,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    named: str,
) -> None:
    """Exit code 2, one message, one hint, no checkpoint."""
    out = tmp_path / "out"
    assert train(tmp_path, "make", packed, *TINY, "--out", out, *words) == 2
    beside = capsys.readouterr().err
    assert named in beside and "hint" in beside
    assert not (out / "checkpoint.pt").exists()


def test_no_data_set_is_one_message(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A folder that holds none."""
    assert train(tmp_path, "make", tmp_path, *TINY, "--out", tmp_path / "out") == 3
    assert "there is no data set" in capsys.readouterr().err


BARE = """
import sys
class Refuse:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in sys.argv[1].split(","):
            raise ImportError(f"{name} is not on a lent machine")
sys.meta_path.insert(0, Refuse())
import torch
from workbench.cli import main
sys.exit(main(sys.argv[2:]))
"""
HEAVY = (
    "build123d,cv2,embreex,manifold3d,OCP,PIL,potpourri3d,pymeshlab,pytetwild,pyvista,shapely,"
    "taichi,tomli_w,trimesh,viser,websockets,mitsuba"
)


@pytest.mark.slow
def test_it_trains_where_only_pytorch_and_numpy_are(tmp_path: Path, packed: Path) -> None:
    """The other packages refused to load: weights as ever, and a note that no chart is drawn."""
    words = ["train", "make", str(packed), *TINY, "--out", str(tmp_path / "out")]
    done = subprocess.run(
        [sys.executable, "-c", BARE, HEAVY, *words],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "OpenCV is missing" in done.stderr
    assert list((tmp_path / "out").glob("*.weights"))
    assert not (tmp_path / "out" / "curves.png").exists()
