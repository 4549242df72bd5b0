"""Pictures in design files: found, kept by their content, shipped, and refused with the field."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from sim.optics.raster.photo_file import read_rgb
from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.project import photos
from workbench.project.design_toml import (
    check_design,
    design_from_toml,
    design_table,
    design_to_toml,
)
from workbench.project.named_designs import load_design
from workbench.project.photos import design_photos, shipped_photos
from workbench.project.project import Project

HEAD = 'schema = 1\nname = "w"\nfamily = "finger"\n'
GELTIP = "geltip_idle_640x480.png"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A design file with a background and a pattern of markers beside it."""
    image = np.arange(48 * 64 * 3, dtype=np.uint8).reshape(48, 64, 3)
    cv2.imwrite(str(tmp_path / "idle.png"), image)
    (tmp_path / "pictures").mkdir()
    cv2.imwrite(str(tmp_path / "pictures" / "dots.png"), 255 - image)
    text = HEAD + '[optics]\nbackground = "idle.png"\n[optics.markers]\npicture = "dots.png"\n'
    text += "[optics.camera]\nwidth_px = 64\nheight_px = 48\n"
    (tmp_path / "w.toml").write_text(text)
    return tmp_path


def test_a_design_file_names_pictures_beside_it(folder: Path) -> None:
    """Beside the file or in its folder `pictures`; the content is the file's."""
    held = design_photos(load_design(str(folder / "w.toml")))
    assert [picture.name for picture in held.values()] == ["idle.png", "dots.png"]
    background = held["optics.background"]
    assert background.data.tobytes() == (folder / "idle.png").read_bytes()


def test_saved_designs_keep_their_pictures_and_travel(folder: Path) -> None:
    """Saved, the originals deleted, the project moved: the same design, with the same names."""
    design = load_design(str(folder / "w.toml"))
    project = Project(folder / "project")
    project.save_design("w", design)
    assert len(list((project.folder / "pictures").iterdir())) == 2
    (folder / "idle.png").unlink()
    moved = folder / "elsewhere"
    project.folder.rename(moved)
    again = load_design(str(moved / "designs" / "w.toml"))
    assert again == design and digest(again) == digest(design)
    assert [picture.name for picture in design_photos(again).values()] == ["idle.png", "dots.png"]
    assert design_to_toml(again) == design_to_toml(design)


def test_an_edit_does_not_read_the_pictures_again(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once for each picture; again, and refused each time, for a camera of another size."""
    decoded: list[int] = []
    decode = cv2.imdecode

    def counted(data: np.ndarray, flags: int) -> object:
        decoded.append(len(data))
        return decode(data, flags)

    photos._check_background.cache_clear()
    photos._check_readable.cache_clear()
    monkeypatch.setattr(cv2, "imdecode", counted)
    design = load_design(str(folder / "w.toml"))
    assert len(decoded) == 2
    check_design(design.replace("optics.ring.power", 2.0))
    check_design(design.replace("optics.camera.sensor.gamma", 2.2))
    assert len(decoded) == 2
    for _ in range(2):
        with pytest.raises(DesignError, match="64 x 48 pixels, the camera 80 x 48"):
            check_design(design.replace("optics.camera.width_px", 80))
    assert len(decoded) == 4


def test_equal_pictures_of_other_names_are_one(folder: Path) -> None:
    """The content decides what is computed anew, not the name."""
    design = load_design(str(folder / "w.toml"))
    (folder / "idle.png").rename(folder / "other.png")
    text = (folder / "w.toml").read_text().replace("idle.png", "other.png")
    other = design_from_toml(text, roots=(folder,))
    assert other == design and digest(other) == digest(design)


def test_shipped_pictures_need_no_file() -> None:
    """`builtin:NAME` is read without a folder and written as itself."""
    design = design_from_toml(HEAD + f'[optics]\nbackground = "builtin:{GELTIP}"\n')
    assert design_table(design)["optics"]["background"] == f"builtin:{GELTIP}"
    assert design_from_toml(design_to_toml(design)) == design


def test_three_photographs_are_shipped_with_their_notice() -> None:
    """640 x 480 each; the MIT notice lies beside them."""
    from importlib import resources

    photos = shipped_photos()
    assert len(photos) == 3
    for picture in photos.values():
        assert read_rgb(picture, at="optics.background").shape == (480, 640, 3)
    notice = resources.files("designs") / "backgrounds" / "NOTICE.md"
    assert "Copyright (c) 2025 XuyangZhang0223" in notice.read_text()


@pytest.mark.parametrize(
    ("named", "says"),
    [
        ('"gone.png"', "there is no picture file 'gone.png'"),
        ('"builtin:geltip.png"', "there is no shipped picture 'geltip.png'"),
        ("3", "is 3, expected the path of a picture"),
        ('""', "expected the path of a picture"),
        ('"w.toml"', "w.toml is not a picture"),
    ],
)
def test_a_missing_picture_is_refused_with_its_field(folder: Path, named: str, says: str) -> None:
    """The field, the name, and where it was looked for."""
    for table, at in (
        ("[optics]\nbackground", "optics.background"),
        ("[optics.markers]\npicture", "optics.markers.picture"),
    ):
        with pytest.raises(DesignError) as caught:
            design_from_toml(f"{HEAD}{table} = {named}\n", roots=(folder,))
        assert says in caught.value.message
        assert caught.value.at == at and caught.value.hint


def test_each_place_is_named_once(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also of a file named without its folder, whose own folder's folder is not that folder."""
    (folder / "idle.png").unlink()
    monkeypatch.chdir(folder)
    with pytest.raises(DesignError) as caught:
        load_design("w.toml")
    places = caught.value.hint.removeprefix("looked for ").partition(";")[0].split(" and ")
    assert str(folder / "idle.png") in places
    assert len(set(places)) == len(places) == 4


def test_a_photograph_of_another_size_is_refused_with_the_design(folder: Path) -> None:
    """When the file is read, not after minutes of contact: both sizes, both ways out."""
    text = (folder / "w.toml").read_text().replace("width_px = 64", "width_px = 80")
    with pytest.raises(DesignError) as caught:
        design_from_toml(text, roots=(folder,))
    assert "idle.png has 64 x 48 pixels, the camera 80 x 48" in caught.value.message
    assert caught.value.at == "optics.background" and "width_px = 64" in caught.value.hint
