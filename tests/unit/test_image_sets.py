"""`workbench compare` on small runs that are written here."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError
from workbench.report.image_files import png_bytes
from workbench.variants.image_sets import compare_sets, page, pairs

HEIGHT, WIDTH = 40, 48
SPOT = (slice(10, 26), slice(12, 30))
PRESS = {"indenter": "sphere", "angle_deg": 15.0, "depths_mm": [0.5, 1.0], "position_mm": 35.0}


def write_run(
    folder: Path,
    change: int,
    press: dict[str, Any] | None = None,
    size: tuple[int, int] = (HEIGHT, WIDTH),
) -> Path:
    """A background of 90 and two frames whose spot is brighter by `change` and twice that."""
    folder.mkdir(parents=True)
    shape = (*size, 3)
    background = np.full(shape, 90, dtype=np.uint8)
    (folder / "background.png").write_bytes(png_bytes(background))
    for number in range(2):
        image = background.copy()
        image[SPOT] += np.uint8(change * (number + 1))
        (folder / f"frame_{number:03d}.png").write_bytes(png_bytes(image))
    summary = {"press": PRESS if press is None else press}
    (folder / "summary.json").write_text(json.dumps(summary))
    return folder


def test_two_runs_pair_frame_by_frame(tmp_path: Path) -> None:
    """Changes of 20 and 40 beside 25 and 50: MAE 5 and 10 in the box, the null 25 and 50."""
    found = pairs(write_run(tmp_path / "ours", 20), write_run(tmp_path / "theirs", 25))
    assert [dict(pair.labels) for pair in found] == [
        {"indenter": "sphere", "angle_deg": "15.0", "depth_mm": depth, "position_mm": "35.0"}
        for depth in ("0.50", "1.00")
    ]
    assert [pair.box for pair in found] == [SPOT, SPOT]
    (total, *_) = compare_sets(tmp_path / "ours", tmp_path / "theirs")
    assert (total.mae_grey, total.null_mae_grey) == (7.5, 37.5)


def test_sets_pair_by_the_names_of_their_runs(tmp_path: Path) -> None:
    """Runs that only one set has are left out."""
    for name in ("a", "b", "c"):
        write_run(tmp_path / "ours" / name, 20, {**PRESS, "indenter": name})
    for name in ("b", "c", "d"):
        write_run(tmp_path / "theirs" / name, 25, {**PRESS, "indenter": name})
    scores = compare_sets(tmp_path / "ours", tmp_path / "theirs")
    assert [row.value for row in scores if row.group == "indenter"] == ["b", "c"]
    assert scores[0].pairs == 4
    assert [row.value for row in scores if row.group == "depth_mm"] == ["0.50", "1.00"]
    assert {row.group for row in scores} == {
        "all",
        "indenter",
        "angle_deg",
        "depth_mm",
        "position_mm",
    }


def test_a_frame_without_change_is_compared_whole(tmp_path: Path) -> None:
    """No contact box: every pixel counts."""
    ours, theirs = write_run(tmp_path / "ours", 0), write_run(tmp_path / "theirs", 0)
    assert [pair.box for pair in pairs(ours, theirs)] == [None, None]


def test_a_run_without_a_press_has_no_labels(tmp_path: Path) -> None:
    """An older summary still compares."""
    found = pairs(write_run(tmp_path / "ours", 9, {}), write_run(tmp_path / "theirs", 9, {}))
    assert [dict(pair.labels) for pair in found] == [{}, {}]


def refused(ours: Path, theirs: Path) -> DesignError:
    with pytest.raises(DesignError) as caught:
        pairs(ours, theirs)
    assert caught.value.hint and caught.value.at == "compare"
    return caught.value


def test_images_of_other_sizes_are_refused(tmp_path: Path) -> None:
    """Both sizes are named."""
    ours = write_run(tmp_path / "ours", 9, size=(HEIGHT, 60))
    message = refused(ours, write_run(tmp_path / "theirs", 9)).message
    assert "has 60 x 40 pixels, its reference 48 x 40" in message


def test_a_folder_without_a_run_is_refused(tmp_path: Path) -> None:
    """It names the folder and the file that is missing."""
    (tmp_path / "empty").mkdir()
    message = refused(tmp_path / "empty", write_run(tmp_path / "theirs", 9)).message
    assert f"{tmp_path / 'empty'} holds no run" in message and "summary.json" in message


def test_sets_without_a_common_run_are_refused(tmp_path: Path) -> None:
    """Two runs a side, no name in common."""
    for side, names in {"ours": "ab", "theirs": "cd"}.items():
        for name in names:
            write_run(tmp_path / side / name, 9)
    message = refused(tmp_path / "ours", tmp_path / "theirs").message
    assert "no run of" in message and "has the name of a run of" in message


def test_runs_without_a_common_frame_are_refused(tmp_path: Path) -> None:
    """Equal names, but no frame number in both."""
    ours, theirs = write_run(tmp_path / "ours", 9), write_run(tmp_path / "theirs", 9)
    for number in range(2):
        (ours / f"frame_{number:03d}.png").rename(ours / f"frame_{number + 5:03d}.png")
    assert "no image of" in refused(ours, theirs).message


def test_a_damaged_image_is_refused(tmp_path: Path) -> None:
    """It names the file."""
    ours, theirs = write_run(tmp_path / "ours", 9), write_run(tmp_path / "theirs", 9)
    (ours / "frame_001.png").write_bytes(b"not an image")
    assert "frame_001.png cannot be read" in refused(ours, theirs).message


def test_a_missing_background_is_refused(tmp_path: Path) -> None:
    """The null needs it."""
    ours, theirs = write_run(tmp_path / "ours", 9), write_run(tmp_path / "theirs", 9)
    (theirs / "background.png").unlink()
    assert "background.png cannot be read" in refused(ours, theirs).message


def test_a_damaged_summary_is_refused(tmp_path: Path) -> None:
    """No traceback from a run that was cut off."""
    ours, theirs = write_run(tmp_path / "ours", 9), write_run(tmp_path / "theirs", 9)
    (theirs / "summary.json").write_text('{"press": ')
    assert "summary.json is not JSON" in refused(ours, theirs).message


@pytest.mark.parametrize(
    ("summary", "told"),
    [
        ([1, 2], "its press is no table"),
        ({"press": 3}, "its press is no table"),
        ({"press": {"depths_mm": ["deep"]}}, "deep in depths_mm"),
        ({"press": {"depths_mm": 3}}, "depths_mm that are no list"),
        ({"press": {"position_mm": "here"}}, "here in position_mm"),
        ({"press": {"position_mm": 10**400}}, "in position_mm"),
    ],
)
def test_a_summary_of_something_else_is_refused(
    tmp_path: Path, summary: object, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Valid JSON that no run wrote: exit code 2 and what is wrong."""
    ours, theirs = write_run(tmp_path / "ours", 9), write_run(tmp_path / "theirs", 9)
    (theirs / "summary.json").write_text(json.dumps(summary))
    message = refused(ours, theirs).message
    assert "summary.json" in message and told in message
    assert main(["compare", str(ours), str(theirs), "--project", str(tmp_path / "p")]) == 2
    assert told in capsys.readouterr().err


def test_only_numbered_frames_are_compared(tmp_path: Path) -> None:
    """An image frame_x.png of the designer's own is passed over."""
    ours, theirs = write_run(tmp_path / "ours", 9), write_run(tmp_path / "theirs", 9)
    for run in (ours, theirs):
        (run / "frame_x.png").write_bytes((run / "frame_000.png").read_bytes())
    assert len(pairs(ours, theirs)) == 2


def test_a_background_of_another_size_is_refused(tmp_path: Path) -> None:
    """The null must have the size of the frames; both sizes are named."""
    ours, theirs = write_run(tmp_path / "ours", 9), write_run(tmp_path / "theirs", 9)
    other = np.full((HEIGHT, 60, 3), 90, dtype=np.uint8)
    (theirs / "background.png").write_bytes(png_bytes(other))
    message = refused(ours, theirs).message
    assert "background.png has 60 x 40 pixels, frame_000.png 48 x 40" in message


def test_further_cameras_are_compared_as_well(tmp_path: Path) -> None:
    """Camera 2 changes by 10 beside 20; camera 3 is in one run only and left out."""
    ours, theirs = write_run(tmp_path / "ours", 20), write_run(tmp_path / "theirs", 20)
    write_run(ours / "camera_2", 10)
    write_run(theirs / "camera_2", 20)
    write_run(theirs / "camera_3", 20)
    scores = {row.value: row for row in compare_sets(ours, theirs) if row.group == "camera"}
    assert list(scores) == ["1", "2"]
    # Frames differ by 0 and 0, then by 10 and 20 grey levels in the box.
    assert (scores["1"].mae_grey, scores["2"].mae_grey) == (0.0, 15.0)


def test_compare_needs_a_folder_to_write_into(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`--out` that is a file: exit code 2, and the file stays."""
    ours, theirs = write_run(tmp_path / "ours", 9), write_run(tmp_path / "theirs", 9)
    file = tmp_path / "file"
    file.write_text("mine")
    words = ["compare", str(ours), str(theirs), "--out", str(file)]
    assert main([*words, "--project", str(tmp_path / "p")]) == 2
    assert "is a file" in capsys.readouterr().err and file.read_text() == "mine"


def test_compare_prints_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`--json` prints what `comparison.json` holds; the page has a row for each group."""
    ours, theirs = write_run(tmp_path / "ours", 20), write_run(tmp_path / "theirs", 25)
    out = tmp_path / "out"
    words = ["compare", str(ours), str(theirs), "--out", str(out), "--json"]
    assert main([*words, "--project", str(tmp_path / "p")]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads((out / "comparison.json").read_text())
    assert printed[0]["mae_grey"] == 7.5 and printed[0]["null_mae_grey"] == 37.5
    text = (out / "comparison.html").read_text()
    # One row of headings and one for each of the groups all, indenter, angle, two depths, position.
    assert text.count("<tr>") == 1 + len(printed) == 7
    assert main(["compare", str(ours), str(theirs), "--project", str(tmp_path / "p")]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 7 and lines[1].split()[:2] == ["all", "2"]


def test_compare_says_what_is_wrong(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 2 and one message."""
    theirs = write_run(tmp_path / "theirs", 9)
    words = ["compare", str(tmp_path / "none"), str(theirs), "--project", str(tmp_path / "p")]
    assert main(words) == 2
    assert "holds no run" in capsys.readouterr().err


def test_the_page_escapes_what_runs_are_called(tmp_path: Path) -> None:
    """A name with a tag in it stays text."""
    press = {**PRESS, "indenter": "<b>ball</b>"}
    ours = write_run(tmp_path / "ours", 20, press)
    text = page(compare_sets(ours, write_run(tmp_path / "theirs", 25, press)), "<i>title</i>")
    assert "<b>ball" not in text and "<i>title" not in text
    assert "&lt;b&gt;ball" in text
