"""Files from the browser: their names, their sizes, and what is read of them where."""

from __future__ import annotations

import tracemalloc
import zlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry.surface.primitives import rounded_box
from ui.panels.simulate.objects import ObjectFolder
from workbench.core.base.errors import DesignError
from workbench.core.design.imported import ReadBody, ReadSurface
from workbench.core.press.indenter import Indenter
from workbench.core.press.press_case import PressCase
from workbench.edit.indenter_choice import MOST_PIXELS, load_heights
from workbench.edit.indenter_edit import cad_object, cad_trial, needs_cad, pictured, uploaded
from workbench.edit.trajectories import uploaded_trajectory
from workbench.live.requests import Finished, Request
from workbench.pipeline.store import Store
from workbench.planning.plan import plan
from workbench.system.picture_size import picture_size
from workbench.system.uploads import own_name, uploaded_file

OPEN = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.mark.parametrize(
    ("name", "kept"),
    [
        ("part.stl", "part.stl"),
        ("/etc/part.stl", "part.stl"),
        ("..\\..\\part.STL", "part.STL"),
        ("../..", "upload"),
        ("a/", "upload"),
        ("", "upload"),
        ("a\0b\n.obj", "ab.obj"),
        ("x" * 500 + ".obj", "x" * 50 + ".obj"),
    ],
)
def test_a_file_keeps_its_name_and_no_folder(name: str, kept: str) -> None:
    """The last part, printable and short; "upload" where nothing is left."""
    assert own_name(name) == kept
    with uploaded_file(name, b"abc", limit_bytes=3, hint="", at="") as path:
        assert (path.name, path.read_bytes()) == (kept, b"abc")
    assert not path.parent.exists()


def test_a_file_that_is_too_large_is_refused_with_value_limit_and_remedy() -> None:
    """2.5 MB of at most 2 MB, in decimal megabytes."""
    with pytest.raises(DesignError) as caught:
        with uploaded_file("a/b.csv", bytes(2_500_000), limit_bytes=2_000_000, hint="h", at="x"):
            pass
    assert caught.value.message == "b.csv has 2.5 MB, the browser takes 2 MB"
    assert (caught.value.hint, caught.value.at) == ("h", "x")


@pytest.mark.parametrize(
    ("name", "read"),
    [
        ("my part.obj", lambda name: uploaded(name, OPEN)),
        ("my part.stl", lambda name: uploaded(name, OPEN)),
        ("my photo.png", lambda name: pictured(Indenter(), name, OPEN)),
        ("my path.csv", lambda name: uploaded_trajectory(name, OPEN)),
    ],
)
def test_messages_name_the_designers_file(name: str, read: Any) -> None:
    """The name as it was uploaded, no temporary folder."""
    with pytest.raises(DesignError, match=name) as caught:
        read(name)
    assert "/" not in caught.value.message
    assert caught.value.hint


@pytest.mark.parametrize(
    "read",
    [
        lambda big: uploaded("big.stl", big),
        lambda big: cad_trial("big.step", big),
        lambda big: pictured(Indenter(), "big.png", big),
        lambda big: uploaded_trajectory("big.csv", big),
    ],
)
def test_every_upload_has_a_limit(read: Any) -> None:
    """41 MB are too many for each."""
    with pytest.raises(DesignError, match=r"has 41\.0 MB, the browser takes"):
        read(bytes(41_000_000))


@pytest.mark.parametrize("ending", [".png", ".jpg", ".bmp", ".tiff"])
def test_the_size_of_a_picture_stands_in_its_header(ending: str) -> None:
    """37 wide, 23 high, in each of the four formats."""
    import cv2

    ok, data = cv2.imencode(ending, np.full((23, 37, 3), 90, np.uint8))
    assert ok
    assert picture_size(data.tobytes()) == (37, 23)
    assert picture_size(data.tobytes()[:9]) is None
    assert picture_size(b"") is None


def bomb(width: int, height: int) -> bytes:
    """A PNG header that promises so many pixels, and a few bytes of them."""
    head = b"IHDR" + np.array([width, height], ">u4").tobytes() + bytes([8, 0, 0, 0, 0])
    parts = (head, b"IDAT" + zlib.compress(bytes(1000)), b"IEND")
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        len(part[4:]).to_bytes(4, "big") + part + zlib.crc32(part).to_bytes(4, "big")
        for part in parts
    )


@pytest.mark.parametrize("width", [40_000, 2**31 - 1])
def test_a_picture_is_refused_before_it_unfolds(tmp_path: Path, width: int) -> None:
    """A few hundred bytes that promise 1.6e9 pixels or more cost no memory; 4e6 are the limit."""
    path = tmp_path / "bomb.png"
    path.write_bytes(bomb(width, 40_000))
    tracemalloc.start()
    with pytest.raises(DesignError, match=f"bomb.png has {width} x 40000 pixels") as caught:
        load_heights(path)
    # NumPy and what Python itself holds; a single row of the picture would be more.
    assert tracemalloc.get_traced_memory()[1] < 10_000_000
    tracemalloc.stop()
    assert f"the limit is {MOST_PIXELS:,}" in caught.value.message
    assert "reduce the picture" in caught.value.hint


def read_box() -> ReadBody:
    """A box of 6 mm off the origin, as the reader of STEP files returns it."""
    points, faces = rounded_box(3.0, 0.0)
    patch = np.zeros(len(faces), np.int32)
    outer = ReadSurface(points_mm=points + 5.0, faces=faces, patch=patch)
    return ReadBody(outer=outer, inner=None, unit="mm", notice="")


def test_a_step_file_is_left_to_the_worker(tmp_path: Path) -> None:
    """The panel asks for `intake` of a trial, reads nothing itself, and takes what was stored."""
    store, asked, taken = Store(tmp_path), [], []
    desk = SimpleNamespace(
        reports=SimpleNamespace(settle=lambda: None),
        session=SimpleNamespace(store=store),
        trial=lambda *words: asked.append(words),
    )
    folder: Any = SimpleNamespace(
        desk=desk,
        file=SimpleNamespace(value=SimpleNamespace(name="dir/box.STEP", content=b"ISO-10303-21;")),
        _read=lambda event: ObjectFolder._read(folder, event),  # pyright: ignore[reportPrivateUsage]
        _take=taken.append,
    )
    sent = ObjectFolder._sent(folder)  # pyright: ignore[reportPrivateUsage]
    ObjectFolder._load_file(folder, sent)  # pyright: ignore[reportPrivateUsage]
    ((job, trial, wanted, then),) = asked
    assert (job, wanted, taken) == ("object", "intake", [])
    assert trial.body.outer.name == "box.STEP"
    call = plan(trial, PressCase())["intake"]
    store.save("intake", call.key, read_box(), seconds=0.0, version=1)
    request = Request(design=trial, case=PressCase(), wanted=("intake",))
    then(Finished(job="object", request=request, error=None, seconds=0.0))
    (indenter,) = taken
    assert indenter.size_mm == pytest.approx(6.0)
    np.testing.assert_allclose(indenter.mesh.points_mm.max(axis=0), 3.0)
    assert cad_object(trial, store).mesh is not None

    refused = DesignError("two bodies", hint="keep one", at="body.outer")
    with pytest.raises(DesignError, match="two bodies") as caught:
        then(Finished(job="object", request=request, error=refused, seconds=0.0))
    assert caught.value.at == "indenter"
    assert [needs_cad(name) for name in ("a.stp", "a.STEP", "a.stl", "a.obj")] == [
        True,
        True,
        False,
        False,
    ]
