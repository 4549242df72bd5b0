"""Results that ship are those of the design that a new project begins with, whole and small."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

from ui.desk.session import DEFAULT_DESIGN, Session
from workbench.core.base.errors import StoreError
from workbench.core.press.press_case import PressCase
from workbench.door.results import evaluate
from workbench.pipeline import first_results
from workbench.pipeline.first_results import (
    FILE,
    MOST_BYTES,
    STAGES,
    pack_first,
    shipped_keys,
    unpack_first,
)
from workbench.pipeline.store import Store
from workbench.planning.plan import plan
from workbench.project.named_designs import load_design
from workbench.project.project import Project


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Project:
    """A new project, into which the shipped results were put."""
    found = Project(tmp_path_factory.mktemp("first"))
    put = unpack_first(found.store, shipped_keys())
    assert set(put) == set(STAGES)
    return found


def test_what_ships_is_not_stale(project: Project) -> None:
    """Its keys are those that the program asks for today: else run `make first`.

    The body is read from what ships, so that the target of the press is that of the page.
    """
    design = load_design(DEFAULT_DESIGN)
    assert plan(design, PressCase())["build"].key == shipped_keys()["build"]
    results = evaluate(design, project=project)
    calls = plan(results.design, results.case)
    assert shipped_keys() == {stage: calls[stage].key for stage in STAGES}
    assert all(outcome.cached for outcome in results.outcomes)


def test_a_new_project_begins_with_it(tmp_path: Path) -> None:
    """The keys of a session that has not been touched are those that ship."""
    calls = Session(Project(tmp_path)).calls()
    assert {stage: calls[stage].key for stage in STAGES} == shipped_keys()


def test_the_first_page_shows_a_contact(project: Project) -> None:
    """Every result can be read; the press has a force, and the image changes where it is."""
    keys = shipped_keys()
    images = np.asarray(project.store.load("shoot", keys["shoot"]).frames.rgb)
    assert np.abs(images[-1].astype(int) - images[0]).max() > 50
    assert project.store.load("press", keys["press"]).normal_N[-1] > 0.5
    assert project.store.load("maps", keys["maps"]).maps
    assert len(project.store.load("mesh", keys["mesh"]).outer.faces) > 1000


def test_it_is_small_enough_for_every_installation() -> None:
    """10 MB at most."""
    assert FILE.stat().st_size <= MOST_BYTES


def test_only_what_is_missing_is_put_and_only_for_its_body(tmp_path: Path) -> None:
    """The same body meshed otherwise has none; the second time nothing is missing; one removed
    comes back."""
    store = Store(tmp_path / "store")
    keys = shipped_keys()
    assert unpack_first(store, keys | {"mesh": "0" * 32}) == ()
    assert not store.root.exists()
    assert set(unpack_first(store, keys)) == set(STAGES)
    assert unpack_first(store, keys) == ()
    for path in store.path("build", keys["build"]).iterdir():
        path.unlink()
    assert unpack_first(store, keys) == ("build",)
    assert store.has("build", keys["build"])


def test_the_same_results_make_the_same_archive(
    project: Project, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Body and press, byte by byte; a missing result is said."""
    again = tmp_path / "again.zip"
    monkeypatch.setattr(first_results, "STAGES", ("build", "press"))
    pack_first(project.store, shipped_keys(), again)
    with zipfile.ZipFile(FILE) as one, zipfile.ZipFile(again) as other:
        names = [name for name in one.namelist() if name.startswith(("build/", "press/"))]
        assert other.namelist() == names
        for name in names:
            assert one.read(name) == other.read(name)
    with pytest.raises(StoreError, match="no stored result press"):
        pack_first(project.store, shipped_keys() | {"press": "0" * 32}, again)


def test_a_damaged_archive_is_said_and_leaves_nothing(tmp_path: Path) -> None:
    """Cut short, or with a byte turned: a message, and no result that is half there."""
    broken = tmp_path / "broken.zip"
    data = bytearray(FILE.read_bytes())
    broken.write_bytes(data[: len(data) // 2])
    store, keys = Store(tmp_path / "store"), shipped_keys()
    with pytest.raises(StoreError, match="cannot be read"):
        unpack_first(store, keys, broken)
    with zipfile.ZipFile(FILE) as archive:
        place = archive.getinfo(next(n for n in archive.namelist() if n.startswith("shoot/")))
    data[place.header_offset + 400] ^= 0xFF
    broken.write_bytes(data)
    with pytest.raises(StoreError, match="cannot be read"):
        unpack_first(store, keys, broken)
    assert not store.has("shoot", keys["shoot"])
    assert not list(store.root.glob("*/.part-*"))
