"""Folders of labelled photographs: what is read, and what is refused with file, column, remedy."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from tests.synthetic_touches import (
    HEIGHT,
    WIDTH,
    dots,
    photographed,
    sequence_folder,
    touched,
    with_windows,
)
from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import silent
from workbench.core.design.camera import Camera
from workbench.core.design.design import SensorDesign
from workbench.learning.dataset.photo_export import export_images
from workbench.pipeline.store import Store
from workbench.report.image_files import png_bytes
from workbench.tasks.dent_sight import DentSight
from workbench.tasks.examples import examples
from workbench.tasks.photo_folder import PhotoFolder
from workbench.tasks.rendered import Looker, Renders, rendered
from workbench.tasks.seen_images import whole
from workbench.tasks.task import Net, task_of

CAMERA = Camera(width_px=4 * WIDTH, height_px=4 * HEIGHT)


def read(folder: Path, task: str = "objects") -> list:
    """Everything a task takes from a folder."""
    return list(PhotoFolder.open(folder).seen(task_of(task), whole(Net.OWN), CAMERA))


def test_photographs_count_as_their_difference_from_rest(tmp_path: Path) -> None:
    """A spot 75 or 150 grey levels over its surroundings, and nothing beside it."""
    seen = read(photographed(tmp_path, 8))
    assert len(seen) == 8
    assert {each.labels["object"] for each in seen} == {"cross", "hexagon", "sphere", "flower"}
    assert {int(each.change.grey.max()) for each in seen} <= {75, 150}
    assert all(each.change.grey.min() == 0 for each in seen)


def test_folders_name_the_classes_where_there_is_no_table(tmp_path: Path) -> None:
    """ball/ and key/ with a photograph each."""
    for name in ("ball", "key"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "1.png").write_bytes(png_bytes(dots(1.0)))
    (tmp_path / "idle.png").write_bytes(png_bytes(dots(0.0)))
    found = examples(task_of("objects"), read(tmp_path))
    assert (found.outputs, found.truth.tolist()) == (("ball", "key"), [0, 1])
    with pytest.raises(DesignError, match=r"has no labels.csv with the column peak_MPa"):
        read(tmp_path, "safety")


def test_sequences_are_eight_photographs_in_order(tmp_path: Path) -> None:
    """Dots that stand still have no motion, those that slip move by 4 of 48 px."""
    seen = read(sequence_folder(tmp_path), "slip")
    assert [len(each.change.grey) for each in seen] == [8] * 12
    assert all(
        each.motion == pytest.approx(4.0 / WIDTH * float(each.labels["slip"]), abs=0.02)
        for each in seen
    )


def test_columns_of_a_pose_may_have_any_name(tmp_path: Path) -> None:
    """Those that are there, and the depth."""
    found = examples(task_of("pose"), read(photographed(tmp_path, 6), "pose"))
    assert found.outputs == ("pose_x_mm", "pose_y_mm", "depth_mm")


def broken(folder: Path, old: str, new: str) -> None:
    """Change a word of the table."""
    path = folder / "labels.csv"
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


@pytest.mark.parametrize(
    ("old", "new", "task", "message"),
    [
        ("object", "thing", "objects", "labels.csv has no column object"),
        ("photo", "file", "objects", "labels.csv has no column photo"),
        ("peak_MPa", "peak_kPa", "safety", "labels.csv has no column peak_MPa"),
        ("p001.png", "p999.png", "objects", "cannot read .*p999.png: No such file"),
        ("object", "object", "slip", "labels.csv has no column slip"),
    ],
)
def test_what_the_table_lacks_is_named(
    tmp_path: Path, old: str, new: str, task: str, message: str
) -> None:
    """File and column stand in the message, and a remedy below."""
    broken(photographed(tmp_path, 4), old, new)
    with pytest.raises(DesignError, match=message) as error:
        read(tmp_path, task)
    assert error.value.hint and error.value.at == "--photos"


def test_a_value_that_is_no_number_is_named(tmp_path: Path) -> None:
    """With the photograph whose line it is in."""
    photographed(tmp_path, 4)
    first = (tmp_path / "labels.csv").read_text().splitlines()[1].split(",")
    broken(tmp_path, ",".join(first), ",".join([*first[:4], "deep", *first[5:]]))
    with pytest.raises(DesignError, match=r"p000.png: peak_MPa is 'deep', not a number"):
        read(tmp_path, "safety")


def test_a_short_sequence_is_refused(tmp_path: Path) -> None:
    """Seven photographs where eight are looked at."""
    sequence_folder(tmp_path, 2)
    path = tmp_path / "labels.csv"
    path.write_text("\n".join(path.read_text().splitlines()[:-1]) + "\n")
    with pytest.raises(DesignError, match="sequence 's01' has 7 photographs, fewer than 8"):
        read(tmp_path, "slip")


def test_photographs_of_other_sizes_are_refused(tmp_path: Path) -> None:
    """One of them, or all against the camera of the design."""
    photographed(tmp_path, 4)
    wide = Camera(width_px=640, height_px=360)
    with pytest.raises(DesignError, match="48 x 36 pixels, the camera of the design 640 x 360"):
        list(PhotoFolder.open(tmp_path).seen(task_of("objects"), whole(Net.OWN), wide))
    (tmp_path / "p002.png").write_bytes(png_bytes(dots(0.0)[:30]))
    with pytest.raises(DesignError, match=r"p002.png has 48 x 30 pixels, idle.png 48 x 36"):
        read(tmp_path)


def test_folders_without_photographs_are_refused(tmp_path: Path) -> None:
    """No folder, no photograph at rest, no photograph."""
    with pytest.raises(DesignError, match="there is no folder"):
        PhotoFolder.open(tmp_path / "none")
    with pytest.raises(DesignError, match=r"has no idle.png"):
        PhotoFolder.open(tmp_path)
    (tmp_path / "idle.png").write_bytes(png_bytes(dots(0.0)))
    with pytest.raises(DesignError, match="names no photographs"):
        PhotoFolder.open(tmp_path)


def test_a_class_that_renders_do_not_have_is_named(tmp_path: Path) -> None:
    """With the photograph, and what the classes are."""
    broken(photographed(tmp_path, 8), "flower", "spoon")
    with pytest.raises(DesignError, match=r"p003.png shows spoon, which the renders do not"):
        examples(task_of("objects"), read(tmp_path), ("cross", "hexagon", "sphere", "flower"))


def test_an_exported_data_set_reads_as_what_it_was(tmp_path: Path) -> None:
    """Images, classes and places of the folder are those of the data set."""
    data, task = touched(tmp_path / "data", cases=10), task_of("objects")
    assert export_images(data, tmp_path / "photos", silent) == 20
    own = Renders(data, marked=False)
    looker = Looker(view=whole(Net.OWN), data=data, images=own)
    ours = examples(task, rendered(task, looker, silent))
    theirs = examples(task, read(tmp_path / "photos"))
    assert (ours.inputs == theirs.inputs).all() and ours.outputs == theirs.outputs
    assert ours.places.tolist() == theirs.places.tolist()
    assert ours.truth.tolist() == theirs.truth.tolist()
    with pytest.raises(DesignError, match="is not empty"):
        export_images(data, tmp_path / "photos", silent)


def test_two_processes_see_what_one_sees(tmp_path: Path) -> None:
    """In the same order, where dents are read; a reader stays in the process that opened it."""
    data, task = touched(tmp_path / "data", cases=6), task_of("objects")
    plain = Looker(view=whole(Net.OWN), data=data, images=Renders(data, marked=False))
    dents = DentSight(SensorDesign(), Store(tmp_path / "store"))
    dents._readers[b"opened"] = lambda: None  # type: ignore[assignment]
    looker = dataclasses.replace(plain, view=dataclasses.replace(plain.view, dents=dents))
    one = rendered(task, plain, silent)
    two = rendered(task, looker, silent, jobs=2)
    assert [each.name for each in two] == [each.name for each in one]
    assert all((a.change.grey == b.change.grey).all() for a, b in zip(one, two, strict=True))


def test_windows_are_exported_as_sequences(tmp_path: Path) -> None:
    """Two windows of two frames for each case, by the command."""
    data = touched(tmp_path / "data", cases=3)
    with pytest.raises(DesignError, match="lists no sequences"):
        from workbench.learning.dataset.photo_export import export_windows

        export_windows(data, tmp_path / "empty", silent)
    with_windows(data, 2)
    words = ["dataset", "export", str(data.folder), "--windows", str(tmp_path / "photos")]
    assert main(words) == 0
    rows = PhotoFolder.open(tmp_path / "photos").rows
    assert len(rows) == 12
    assert {row["slip"] for row in rows} == {"0", "1"} and {row["frame"] for row in rows} == {
        "0",
        "1",
    }
